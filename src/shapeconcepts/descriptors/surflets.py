"""Points of segments with normals, averaged in the cells of a coarse grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.segment_kernels import size_of_segments
from shapeconcepts.geometry.canonical_frame import canonical_coordinates
from shapeconcepts.geometry.neighbour_kernels import ends_of_runs
from shapeconcepts.geometry.neighbours import sorting_order

# Edge of the cells in which points are averaged, in root mean square distances from the centroid: 150 to 250
# cells for a typical view, whatever the size and density of the object.
_CELL_FRACTION = 1 / 4.5


class Surflets(NamedTuple):
    """Averaged points in the order of their segments: points and normals (3, k), weights and labels (k,)."""

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    weights: NDArray[np.float64]
    segment_labels: NDArray[np.int64]


def average_surflets(
    points: NDArray[np.float64], normals: NDArray[np.float64], segment_labels: NDArray[np.int32]
) -> Surflets:
    """Average the points of each segment in each cell of a grid around the centroid."""
    cell_size = _CELL_FRACTION * size_of_segments(points, segment_labels)
    kept = segment_labels >= 0
    points, normals, labels = points[kept], normals[kept], segment_labels[kept].astype(np.int64)
    if len(points) == 0:
        return Surflets(np.empty((3, 0)), np.empty((3, 0)), np.empty(0), labels)
    offsets = points - points.mean(axis=0)
    # The grid lies along the object's own axes: a turned object is cut into the same cells. The centroid lies
    # within a cell: on a border, rounding would decide on the points of symmetric objects.
    along_axes = canonical_coordinates(points)
    cells = np.floor(along_axes / cell_size + 0.5) if cell_size > 0.0 else np.zeros_like(offsets)
    cells = (cells - cells.min(axis=0)).astype(np.int64)
    size = cells.max(axis=0) + 1
    keys = ((labels * size[0] + cells[:, 0]) * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
    order = sorting_order(keys)
    ends = ends_of_runs(keys[order])
    starts, counts = ends[:-1], np.diff(ends)
    means, normal_sums = (
        np.add.reduceat(vectors.T[:, order], starts, axis=1) / counts for vectors in (offsets, normals)
    )
    lengths = np.sqrt((normal_sums**2).sum(axis=0))
    mean_normals = np.divide(normal_sums, lengths, out=np.zeros_like(normal_sums), where=lengths > 0.0)
    segments = labels[order[starts]]
    return Surflets(means, mean_normals, counts.astype(np.float64), segments)
