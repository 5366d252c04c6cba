"""The voxel grid: one point for every occupied cell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.preparation.canonical_frame import canonical_coordinates

KINECT_VOXEL_SIZE = 0.005
POINTS_PER_VOXEL = 3.5


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
    return _fill(points, canonical_coordinates(points), voxel_size)


def adaptive_voxel_grid(points: NDArray[np.float64]) -> VoxelGrid:
    """Voxel grid with cells of 5 mm, or as large as the density and extent of the points ask for.

    A mean over few points is as noisy as the points: the cells grow until they hold about 3.5 points each. As a
    Kinect's point spacing and its depth noise both grow with distance, this also averages away the noise of far
    objects, and it needs no knowledge of the sensor's position. Clouds whose extent shows that they are not a
    hand-sized to furniture-sized object in metres (a diagonal outside 2 cm to 5 m) start from 1/60 of the extent.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1.
    """
    coordinates = canonical_coordinates(points)
    extent = float(np.linalg.norm(np.ptp(coordinates, axis=0)))
    voxel_size = KINECT_VOXEL_SIZE if 0.02 <= extent <= 5.0 or extent == 0.0 else extent / 60
    grid = _fill(points, coordinates, voxel_size)
    while len(points) < 0.9 * POINTS_PER_VOXEL * len(grid.points) and voxel_size < extent / 10:
        voxel_size *= float(np.sqrt(POINTS_PER_VOXEL * len(grid.points) / len(points)))
        grid = _fill(points, coordinates, voxel_size)
    return grid


def _fill(points: NDArray[np.float64], coordinates: NDArray[np.float64], voxel_size: float) -> VoxelGrid:
    # Rounding, not flooring: the centroid, where cells would meet, is the middle of many symmetric objects.
    cells = np.rint(coordinates / voxel_size)
    cells -= cells.min(axis=0)
    size = cells.max(axis=0) + 1
    if size.prod() < 2**53:
        keys = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
        _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
    else:
        _, inverse, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(-1)
    origin = points.mean(axis=0)
    sums = np.stack([np.bincount(inverse, points[:, k] - origin[k]) for k in range(3)], axis=1)
    return VoxelGrid(sums / counts[:, None] + origin, inverse.astype(np.int32), float(voxel_size))
