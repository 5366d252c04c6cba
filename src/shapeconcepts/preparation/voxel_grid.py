"""The voxel grid: one point for every occupied cell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.canonical_frame import canonical_coordinates
from shapeconcepts.geometry.extent import robust_extent
from shapeconcepts.geometry.neighbour_kernels import ends_of_runs, keys_of
from shapeconcepts.geometry.neighbours import sorting_order
from shapeconcepts.geometry.point_kernels import centroid, sorted_by_cell

KINECT_VOXEL_SIZE = 0.005
POINTS_PER_VOXEL = 3.5
# Metres.
_SMALLEST_EXTENT = 1e-12


class VoxelGrid(NamedTuple):
    """Mean points of the occupied voxels.

    Attributes
    ----------
    points : (m, 3) float64
        Mean of the points in each voxel, in the frame of the input, in the order of the cells.
    point_to_voxel : (n,) int32
        Voxel of each input point.
    voxel_size : float
    """

    points: NDArray[np.float64]
    point_to_voxel: NDArray[np.int32]
    voxel_size: float


def voxel_grid(points: NDArray[np.float64], voxel_size: float) -> VoxelGrid:
    """Replace the points in every cell of a regular grid by their mean.

    The grid lies in the points' canonical frame, so that its cells do not depend on the object's pose.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1.
    voxel_size : float
        Edge length of a cell, in the unit of the points.
    """
    return _fill(points, cell_keys(canonical_coordinates(points), voxel_size), voxel_size)


def adaptive_voxel_grid(points: NDArray[np.float64]) -> VoxelGrid:
    """Voxel grid with cells of 5 mm, or as large as the density and extent of the points ask for.

    A mean over few points is as noisy as the points: the cells grow until they hold about 3.5 points each. As
    a Kinect's point spacing and its depth noise both grow with distance, this also averages away the noise of
    far objects, and it needs no knowledge of the sensor's position. Clouds whose extent shows that they are
    no objects in metres (a diagonal outside 2 cm to 5 m) start from 1/60 of the extent; below a picometre it
    is rounding, and they are one voxel.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1.
    """
    coordinates = canonical_coordinates(points)
    extent = robust_extent(coordinates)
    voxel_size = KINECT_VOXEL_SIZE if 0.02 <= extent <= 5.0 or extent < _SMALLEST_EXTENT else extent / 60
    keys = cell_keys(coordinates, voxel_size)
    occupied = _count(keys)
    while len(points) < 0.9 * POINTS_PER_VOXEL * occupied and voxel_size < extent / 10:
        voxel_size *= float(np.sqrt(POINTS_PER_VOXEL * occupied / len(points)))
        keys = cell_keys(coordinates, voxel_size)
        occupied = _count(keys)
    return _fill(points, keys, voxel_size)


def cell_keys(coordinates: NDArray[np.float64], voxel_size: float) -> NDArray[np.int64]:
    """Number the cell of a regular grid that each point, (n, 3), lies in."""
    # Rounding, not flooring: the centroid, where cells would meet, is the middle of many symmetric objects.
    axes = np.ascontiguousarray(coordinates.T)
    with np.errstate(over="ignore"):
        cells = np.rint(axes / voxel_size)
    if not np.isfinite(cells).all():
        raise ValueError(f"voxel_size {voxel_size!r} is too small for an object of {np.ptp(axes):.3g} m")
    cells -= cells.min(axis=1, keepdims=True)
    if np.log2(cells.max(axis=1) + 1).sum() >= 62:
        return np.unique(cells, axis=1, return_inverse=True)[1].reshape(-1).astype(np.int64)
    keys, _ = keys_of(cells, 0)
    return keys


def _count(keys: NDArray[np.int64]) -> int:
    return len(ends_of_runs(np.sort(keys))) - 1


def _fill(points: NDArray[np.float64], keys: NDArray[np.int64], voxel_size: float) -> VoxelGrid:
    origin = centroid(points)  # sums relative to it round less
    offsets, starts, point_to_voxel = sorted_by_cell(points, origin, keys, sorting_order(keys))
    counts = np.diff(starts, append=len(points))
    means = np.add.reduceat(offsets, starts, axis=0) / counts[:, None] + origin
    return VoxelGrid(means, point_to_voxel, float(voxel_size))
