"""Several descriptors side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shapeconcepts.descriptors.protocol import Description, Descriptor
from shapeconcepts.segmentation.segmented_object import SegmentedObject


@dataclass(frozen=True)
class Joint:
    """Descriptor that puts the histograms of several descriptors side by side, each with an equal share.

    The divergence of two such histograms is the mean of the divergences under each descriptor.

    Parameters
    ----------
    descriptors : tuple of Descriptor
        At least one.
    """

    descriptors: tuple[Descriptor, ...]

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of all descriptors, in their order.

        Raises
        ------
        ValueError
            If there are no descriptors, and as they do.
        """
        if not self.descriptors:
            raise ValueError("descriptors must hold at least one descriptor, got none")
        parts = [descriptor.describe(segmented) for descriptor in self.descriptors]
        widths = [part.n_bins for part in parts]
        ends = np.cumsum(widths).tolist()
        pair_histograms = []
        for part, width, end in zip(parts, widths, ends, strict=True):
            padded = np.zeros((len(part.pairs), ends[-1]))
            padded[:, end - width : end] = part.pair_histograms
            pair_histograms.append(padded)
        return Description(
            segment_histograms=np.concatenate([part.segment_histograms for part in parts], axis=1),
            pairs=np.concatenate([part.pairs for part in parts]),
            pair_histograms=np.concatenate(pair_histograms),
            blocks=tuple(width for part in parts for width in part.blocks or (part.n_bins,)),
        )
