"""A segmented object reduced to what the motif hierarchies take: its segment graph and its description."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.protocol import Description, Descriptor
from shapeconcepts.descriptors.registry import DEFAULT, get_descriptor
from shapeconcepts.geometry.origin import nearest_tile
from shapeconcepts.segmentation.imagined_occlusion import imagine_occlusion
from shapeconcepts.segmentation.segmented_object import SegmentedObject


class DescribedOcclusion(NamedTuple):
    """What would be left of an object behind another one, described.

    Attributes
    ----------
    described : DescribedObject
    segments : (s,) int32
        The segment of the whole object that each segment is left of.
    """

    described: DescribedObject
    segments: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class DescribedObject:
    """The graph of an object's segments with their histograms.

    Attributes
    ----------
    description : Description
        Histograms of the segments and of any constellation of them.
    segment_edges : (e, 2) int32
        Pairs of neighbouring segments.
    name, label
        As in the scan.
    occlusions : tuple of DescribedOcclusion
        Imagined ones, for motifs to learn from.
    """

    description: Description
    segment_edges: NDArray[np.int32] = field(default_factory=lambda: np.empty((0, 2), np.int32))
    name: str = ""
    label: str | None = None
    occlusions: tuple[DescribedOcclusion, ...] = ()

    @property
    def n_segments(self) -> int:
        """Number of segments."""
        return self.description.n_segments

    def segment(self, number: int) -> DescribedObject:
        """One segment by itself."""
        description = Description(
            self.description.segment_histograms[[number]], blocks=self.description.blocks
        )
        return DescribedObject(description, name=self.name, label=self.label)


def describe(
    segmented: SegmentedObject, descriptor: str | Descriptor = DEFAULT, n_occlusions: int = 0
) -> DescribedObject:
    """Describe the segments of an object.

    Parameters
    ----------
    segmented : SegmentedObject
    descriptor : str or Descriptor
        A name as of `get_descriptor`.
    n_occlusions : int
        How many times the object is described again as if a part of it were hidden, see `imagine_occlusion`,
        for an ensemble to learn from.

    Raises
    ------
    ValueError
        If the descriptor is unknown, returns something else than a `Description`, or describes another number
        of segments than there are, or by histograms that are negative or not finite.
    """
    points = segmented.points - nearest_tile(segmented.points)
    description = get_descriptor(descriptor).describe(replace(segmented, points=points))
    if not isinstance(description, Description):
        raise ValueError(f"descriptor must return a Description, got {type(description).__name__}")
    if description.n_segments != segmented.n_segments:
        raise ValueError(
            f"descriptor must describe {segmented.n_segments} segments, got {description.n_segments}"
        )
    for histograms in (description.segment_histograms, description.pair_histograms):
        if histograms is not None and not (np.isfinite(histograms).all() and (histograms >= 0).all()):
            raise ValueError("descriptor must give finite histograms of at least 0, got others")
    occlusions = []
    for number in range(n_occlusions):
        imagined = imagine_occlusion(segmented, number)
        if imagined is not None:
            rest = describe(imagined.segmented, descriptor)
            # What was never seen is remembered roughly, and half of what takes memory in learning are these.
            rest = replace(rest, description=rest.description.in_single_precision())
            occlusions.append(DescribedOcclusion(rest, imagined.segments))
    return DescribedObject(
        description, segmented.segment_edges, segmented.name, segmented.label, tuple(occlusions)
    )
