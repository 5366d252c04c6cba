"""What would be left of a segmented object if something stood in front of it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.canonical_frame import canonical_axes
from shapeconcepts.segmentation.segmented_object import SegmentedObject

HIDDEN_SHARES = (1 / 3, 1 / 2, 2 / 3)
# What is left of a segment is one if the segmenter would, by default, let it be one.
MIN_VOXELS = 25
MIN_SHARE = 0.04


class ImaginedOcclusion(NamedTuple):
    """The visible rest of an object.

    Attributes
    ----------
    segmented : SegmentedObject
        Without points of the scan: it was never measured.
    segments : (s,) int32
        The segment of the whole object that each segment is left of.
    """

    segmented: SegmentedObject
    segments: NDArray[np.int32]


def imagine_occlusion(segmented: SegmentedObject, number: int) -> ImaginedOcclusion | None:
    """Hide a third, a half or two thirds of an object as a scene does, seen from where the sensor stood.

    What is hidden lies beyond a straight border, such as the rim of the image or of a shelf, where `number`
    is even, and behind something round that reaches in from the side where it is odd. From which side, and
    how much, follows from the object itself, and neither from its pose nor from other objects.

    Parameters
    ----------
    segmented : SegmentedObject
    number : int
        From 0: each is another occlusion.

    Returns
    -------
    ImaginedOcclusion or None
        None where nothing of the size of a segment would be left.
    """
    labelled = segmented.segment_labels >= 0
    counts = np.bincount(segmented.segment_labels[labelled], minlength=segmented.n_segments)
    if counts.sum() < 2 * MIN_VOXELS:
        return None
    content = crc32(counts.astype("<i4").tobytes())
    rng = np.random.default_rng((content, number))
    kind = (content // len(HIDDEN_SHARES) + number) % 3
    if kind == 2 and segmented.n_segments > 1:
        hidden_segments = rng.permutation(segmented.n_segments)[: (segmented.n_segments + 1) // 2]
        hidden = np.isin(segmented.segment_labels, hidden_segments)
    else:
        share = HIDDEN_SHARES[(content + number) % len(HIDDEN_SHARES)]
        hidden = _hidden(segmented, rng.normal(size=3), share, is_round=kind == 1)
    labels = np.where(hidden, -1, segmented.segment_labels)
    left = np.bincount(labels[labels >= 0], minlength=segmented.n_segments)
    kept = np.flatnonzero(left >= max(MIN_VOXELS, MIN_SHARE * left.sum()))
    if not len(kept):
        return None
    number_of = np.full(segmented.n_segments + 1, -1, np.int32)
    number_of[kept] = np.arange(len(kept))
    labels = number_of[labels]
    edges = number_of[segmented.segment_edges].reshape(-1, 2)
    visible = labels >= 0
    rest = replace(
        segmented,
        points=segmented.points[visible],
        normals=segmented.normals[visible],
        patch_labels=segmented.patch_labels[visible],
        segment_labels=labels[visible],
        segment_edges=edges[(edges >= 0).all(axis=1)],
        n_segments=len(kept),
        point_to_voxel=np.empty(0, np.int32),
    )
    return ImaginedOcclusion(rest, kept.astype(np.int32))


def _hidden(
    segmented: SegmentedObject, side: NDArray[np.float64], share: float, is_round: bool
) -> NDArray[np.bool_]:
    """Which points are hidden from a side, given in the object's own frame, (m,) bool."""
    points = segmented.points - segmented.points.mean(axis=0)
    # Normals point to the sensor.
    sight = _unit(segmented.normals.mean(axis=0))
    direction = canonical_axes(points) @ side
    direction = _unit(direction - (direction @ sight) * sight)
    across = points @ direction
    if not is_round:
        return across > np.quantile(across, 1 - share)
    along = points @ np.cross(sight, direction)
    distance = (across - across.max()) ** 2 + along**2
    return distance < np.quantile(distance, share)


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else vector
