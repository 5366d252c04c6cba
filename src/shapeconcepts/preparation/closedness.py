"""Whether a cloud was seen from all sides, or from one place as a scan is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.preparation.voxel_grid import VoxelGrid

# Shares of the image in which something lies behind something else. Steep walls and a wrong position can make
# the first anything, but not the second as well: no single view has both, of 1,256 of five data sets, 2,292
# simulated ones, and 1,920 with a wrong position.
_FROM_SENSOR = 0.5
_FROM_ANYWHERE = 0.16
_N_DIRECTIONS = 30
_DISTANCE_IN_RADII = 10.0
# Voxels: edge of the cells in the image, and smallest distance of two surfaces.
_CELL = 2.0
_GAP = 3.0
# With fewer cells inside the silhouette, a few of them decide nothing.
_FEWEST_CELLS = 8


def is_seen_from_all_sides(grid: VoxelGrid, viewpoint: NDArray[np.float64]) -> bool:
    """Whether from everywhere around there are surfaces behind other ones.

    What a sensor saw from one place has a direction, that to the sensor, from which nothing is hidden. As its
    position may be unknown or wrong, all directions are tried until there is one. Flat and hollow things
    have one too, such as plates, bowls and cutlery: they are not recognised when they are complete.

    Parameters
    ----------
    grid : VoxelGrid
    viewpoint : (3,) float64
        Where the sensor stood, or most likely did, in the same frame.
    """
    points, size = grid.points, grid.voxel_size
    if len(points) < 2 or share_seen_through(points, size, viewpoint) <= _FROM_SENSOR:
        return False
    centre = points.mean(axis=0)
    distance = _DISTANCE_IN_RADII * float(np.linalg.norm(points - centre, axis=1).mean())
    return all(
        share_seen_through(points, size, centre + distance * direction) > _FROM_ANYWHERE
        for direction in _directions()
    )


def share_seen_through(
    points: NDArray[np.float64], voxel_size: float, viewpoint: NDArray[np.float64]
) -> float:
    """Share of the image of points (n, 3), without its outline, in which one lies well behind another."""
    rays = points - viewpoint
    middle = rays.mean(axis=0)
    distance = float(np.linalg.norm(middle))
    if distance == 0.0:
        return 0.0
    axis = middle / distance
    depths = rays @ axis
    if depths.min() <= 0.0:
        return 0.0
    sides = np.linalg.svd(axis[None])[2][1:]
    # Absurdly small voxels have cells beyond all numbers, and nothing to be told of.
    with np.errstate(over="ignore", invalid="ignore"):
        cells = np.rint(rays @ sides.T / depths[:, None] * (distance / (_CELL * voxel_size)))
        cells -= cells.min(axis=0) - 1.0
        # A row and a column of nothing all around, so that neighbours in the image are neighbours in it.
        width = cells[:, 1].max() + 2.0
        places = cells[:, 0] * width + cells[:, 1]
    if not places.max() < 2**53:
        return 0.0
    order = np.lexsort((depths, places))
    places, depths = places[order].astype(np.int64), depths[order]
    is_new = np.append(True, np.diff(places) > 0)
    is_behind = np.append(False, np.diff(depths) > _GAP * voxel_size) & ~is_new
    is_double = np.bincount(np.cumsum(is_new) - 1, is_behind) > 0
    filled = places[is_new]
    is_inside = np.ones(len(filled), np.bool_)
    for step in (1, -1, int(width), -int(width)):
        neighbour = np.minimum(np.searchsorted(filled, filled + step), len(filled) - 1)
        is_inside &= filled[neighbour] == filled + step
    return float(is_double[is_inside].sum() / max(is_inside.sum(), _FEWEST_CELLS))


def _directions() -> NDArray[np.float64]:
    """Unit vectors spread evenly over the sphere."""
    index = np.arange(_N_DIRECTIONS) + 0.5
    z = 2.0 * index / _N_DIRECTIONS - 1.0
    turn = index * np.pi * (3.0 - np.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z])
