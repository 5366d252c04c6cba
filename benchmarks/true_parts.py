"""How the segments of an object compare with the true parts of its surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts import Scan, SegmentedObject

MIN_SHARE = 0.05
MIN_VOXELS = 30
EITHER_WAY = (0.035, 0.065)


class Parts(NamedTuple):
    """True parts and segments of what was kept of a scan, that is of the voxels that belong to a segment."""

    points: NDArray[np.float64]  # (k, 3)
    point_parts: NDArray[np.int64]  # (k,)
    point_segments: NDArray[np.int32]  # (k,)
    voxel_parts: NDArray[np.int64]  # (v,): the part of most points of a voxel
    voxel_segments: NDArray[np.int32]  # (v,)


def compare(scan: Scan, segmented: SegmentedObject) -> Parts:
    """The true parts of a scan with `point_labels` beside its segments."""
    voxel = segmented.point_to_voxel
    segment = np.where(voxel >= 0, segmented.segment_labels[voxel], -1)
    kept = segment >= 0
    _, part = np.unique(scan.point_labels[kept], return_inverse=True)
    votes = np.zeros((len(segmented.points), part.max() + 1), int)
    np.add.at(votes, (voxel[kept], part), 1)
    in_segment = segmented.segment_labels >= 0
    return Parts(
        points=scan.points[kept],
        point_parts=part,
        point_segments=segment[kept],
        voxel_parts=votes[in_segment].argmax(axis=1),
        voxel_segments=segmented.segment_labels[in_segment],
    )


def acceptable_counts(parts: Parts, min_voxels: int = MIN_VOXELS) -> tuple[int, int]:
    """Least and largest number of segments that agrees with the true parts.

    A part counts from 5 % of the kept points and `min_voxels` voxels on in which it has the most points;
    one with 3.5 to 6.5 % of the points may count or not. An object is always one segment at least.
    """
    share = np.bincount(parts.point_parts) / len(parts.point_parts)
    large = np.bincount(parts.voxel_parts, minlength=len(share)) >= min_voxels
    least, most = (int((large & (share >= limit)).sum()) for limit in reversed(EITHER_WAY))
    return max(least, 1), max(most, 1)


def index_without_slivers(parts: Parts) -> float:
    """Adjusted Rand index over the points of the parts that count.

    Where one face is all that counts, a few points of another make the index over all points 0 for the one
    segment that is expected. A part of 3.5 to 6.5 % of the points counts or not, whichever gives the larger
    index.
    """
    share = np.bincount(parts.point_parts) / len(parts.point_parts)
    large = np.bincount(parts.voxel_parts, minlength=len(share)) >= MIN_VOXELS
    indices = []
    for limit in EITHER_WAY:
        chosen = (large & (share >= limit))[parts.point_parts]
        if chosen.any():
            indices.append(adjusted_rand_index(parts.point_parts[chosen], parts.point_segments[chosen]))
    return max(indices) if indices else adjusted_rand_index(parts.point_parts, parts.point_segments)


def adjusted_rand_index(first: NDArray[np.integer], second: NDArray[np.integer]) -> float:
    """Agreement of two partitions (Hubert and Arabie 1985): 1 where they are the same, about 0 for chance."""
    table = np.zeros((first.max() + 1, second.max() + 1))
    np.add.at(table, (first, second), 1)

    def pairs(counts: NDArray[np.float64]) -> float:
        return float((counts * (counts - 1)).sum() / 2)

    together, rows, columns = pairs(table), pairs(table.sum(axis=1)), pairs(table.sum(axis=0))
    expected = rows * columns / max(pairs(np.array([len(first)])), 1)
    largest = (rows + columns) / 2
    return 1.0 if largest == expected else (together - expected) / (largest - expected)


def shortest_edge(parts: Parts) -> float:
    """Shortest edge of a box, or the lesser of a can's diameter and height, metres, as the scan shows it.

    The shorter side of the smallest rectangle around any part of at least 3.5 % of the points, in the part's
    least-squares plane and without the outermost 1 % of the points on each side, which is noise.
    """
    share = np.bincount(parts.point_parts) / len(parts.point_parts)
    sides = []
    for part in np.flatnonzero(share >= EITHER_WAY[0]):
        points = parts.points[parts.point_parts == part]
        points = points - points.mean(axis=0)
        _, axes = np.linalg.eigh(points.T @ points)
        turn = np.radians(np.arange(90))
        directions = axes[:, 2:] * np.cos(turn) + axes[:, 1:2] * np.sin(turn)
        across = axes[:, 1:2] * np.cos(turn) - axes[:, 2:] * np.sin(turn)
        low, high = np.percentile(points @ np.hstack([directions, across]), [1, 99], axis=0)
        lengths = (high - low).reshape(2, -1)
        sides.append(lengths[:, lengths.prod(axis=0).argmin()].min())
    return float(min(sides))
