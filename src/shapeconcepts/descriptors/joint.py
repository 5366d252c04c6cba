"""Several descriptors side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from sklearn.base import BaseEstimator

from shapeconcepts.descriptors.protocol import Description, Descriptor
from shapeconcepts.geometry.surface import normals_within
from shapeconcepts.parameters import check_parameters, positive_number
from shapeconcepts.segmentation.segmented_object import SegmentedObject

# Fewer voxels across are too few for a plane.
_FEWEST_VOXELS = 2.0


@dataclass
class Joint(BaseEstimator):
    """Descriptor that puts the histograms of several descriptors side by side, each with an equal share.

    The divergence of two such histograms is the mean of the divergences under each descriptor.

    All of them see normals that are fitted anew, over the same radius in every scan: those of the segmented
    object come from a number of voxels, which are larger where points are sparse, and the wider a normal
    looks, the rounder is an edge.

    Parameters
    ----------
    descriptors : tuple of Descriptor
        At least one.
    normal_radius : float
        Radius of the planes, metres; at least two voxels are used.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "descriptors": [tuple, list],
        "normal_radius": [positive_number()],
    }

    descriptors: tuple[Descriptor, ...]
    normal_radius: float = 0.02

    @property
    def n_bins(self) -> int:
        """Number of bins; only where each of the descriptors tells its own, as those of this package do."""
        return sum(descriptor.n_bins for descriptor in self.descriptors)  # type: ignore[attr-defined]

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of all descriptors, in their order.

        Raises
        ------
        ValueError
            If there are no descriptors, `normal_radius` is not a positive number, and as they do.
        """
        check_parameters(self)
        if not self.descriptors:
            raise ValueError("descriptors must hold at least one descriptor, got none")
        radius = max(float(self.normal_radius), _FEWEST_VOXELS * segmented.voxel_size)
        normals = normals_within(segmented.points, segmented.normals, radius)
        segmented = replace(segmented, normals=normals)
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
