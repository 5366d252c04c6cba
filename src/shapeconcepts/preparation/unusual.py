"""What in a cloud is unusual for a scan of one object from one place, in metres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.preparation.voxel_grid import VoxelGrid, robust_extent

# Metres. Smaller and larger objects are mostly in other units.
USUAL_EXTENT = (0.005, 5.0)
UNITS = "its coordinates may not be in metres, which units tells (--units mm)"
ALL_SIDES = "expected is what a sensor sees from one place, and its segments may depend on its pose"
# Share of points with another one behind or in front. Of nearly all scans from one place it is below 0.4, of
# a closed box 0.75.
_SEEN_THROUGH = 0.6
# Voxels: edge of the cells in the image, and smallest distance of two surfaces.
_CELL = 2.0
_GAP = 4.0


def unusual(grid: VoxelGrid, viewpoint: NDArray[np.float64]) -> tuple[str, ...]:
    """What to say of a cloud, see `Scan.notices`.

    Parameters
    ----------
    grid : VoxelGrid
    viewpoint : (3,) float64
        Where the sensor stood, or most likely did, in the same frame.
    """
    notices = []
    extent = robust_extent(grid.points)
    if len(grid.points) > 1 and not USUAL_EXTENT[0] <= extent <= USUAL_EXTENT[1]:
        notices.append(f"is {extent:.3g} m across: {UNITS}")
    if seen_through(grid.points, grid.voxel_size, viewpoint) > _SEEN_THROUGH:
        notices.append(f"is seen from all sides: {ALL_SIDES}")
    return tuple(notices)


def seen_through(points: NDArray[np.float64], voxel_size: float, viewpoint: NDArray[np.float64]) -> float:
    """Share of points (n, 3) on whose line of sight there is another one, well behind or in front."""
    rays = points - viewpoint
    middle = rays.mean(axis=0)
    distance = float(np.linalg.norm(middle))
    if len(points) < 2 or distance == 0.0:
        return 0.0
    axis = middle / distance
    depths = rays @ axis
    if depths.min() <= 0.0:
        return 0.0
    sides = np.linalg.svd(axis[None])[2][1:]
    # Absurdly small voxels have cells beyond all numbers, and nothing to be told of.
    with np.errstate(over="ignore", invalid="ignore"):
        across, down = np.rint(rays @ sides.T / depths[:, None] * (distance / (_CELL * voxel_size))).T
        cells = (across - across.min()) * (np.ptp(down) + 1.0) + down
        # By cell, then by depth, in one sort.
        keys = cells + 0.5 * (depths - depths.min()) / max(float(np.ptp(depths)), 1e-12)
    if not np.isfinite(keys).all():
        return 0.0
    order = np.argsort(keys)
    cells, depths = cells[order], depths[order]
    is_new = np.append(True, np.diff(cells) != 0.0)
    is_behind = np.append(False, np.diff(depths) > _GAP * voxel_size) & ~is_new
    cell = np.cumsum(is_new) - 1
    is_double = np.bincount(cell, is_behind) > 0
    return float(is_double[cell].mean())
