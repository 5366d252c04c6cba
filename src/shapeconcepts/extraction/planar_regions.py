"""Planar regions of an organised cloud, of any direction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.planar_cells_kernels import (
    N_MOMENTS,
    cell_moments,
    cell_noise,
    fit_planes,
    grow_regions,
)

# Pixels.
CELL = 8
_LEAST_FULL = 0.3
# Times the noise of a single depth: of a cell, and between its mean and the plane of a region.
_FLAT = 2.0
_ON_PLANE = 2.5
_ROUNDING = 0.001
_SAME_DIRECTION = np.cos(np.radians(15.0))
# Between the normal and the line of sight: what is steeper is the jump at the edge of an object.
_LEAST_FACING = np.cos(np.radians(84.0))
_FEWEST_CELLS = 4
_PARALLEL = np.cos(np.radians(6.0))
# Of what most scenes have, their noise is never thought to be less.
_LEAST_NOISE = 0.3


class PlanarRegion(NamedTuple):
    """A part of the scene that lies on a plane.

    Attributes
    ----------
    point : (3,) float64
        Mean of its points.
    normal : (3,) float64
        Unit normal, towards the sensor.
    cells : (k, 3) float64
        Mean points of its cells.
    area : float
        Square metres, about.
    """

    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    cells: NDArray[np.float64]
    area: float


class PlanarScene(NamedTuple):
    """Planar regions of a scene, the largest first, and its noise in parts of `depth_noise`."""

    regions: list[PlanarRegion]
    noise: float


def planar_regions(points: NDArray[np.float64], viewpoint: NDArray[np.float64], pitch: float) -> PlanarScene:
    """Find planar regions.

    Square cells of pixels are flat where they are no thicker than the noise of the sensor at their distance.
    Flat neighbours on one plane are a region; regions on one plane that something parts, such as the object
    on a table, are one.

    Parameters
    ----------
    points : (h, w, 3) float64
        NaN where nothing was measured.
    viewpoint : (3,) float64
    pitch : float
        Angle between neighbouring pixels, radians.
    """
    grid = cell_moments(points, CELL)
    n_columns = grid.shape[1]
    moments = grid.reshape(-1, N_MOMENTS)
    is_full = moments[:, 0] >= _LEAST_FULL * CELL**2
    if not is_full.any():
        return PlanarScene([], 1.0)
    planes, flatness = np.zeros((len(moments), 6)), np.full(len(moments), np.inf)
    planes[is_full], thickness = fit_planes(moments[is_full])
    depth_noise = cell_noise(planes[is_full], viewpoint)
    sights = planes[is_full, :3] - viewpoint
    distances = np.linalg.norm(sights, axis=1)
    facing = np.abs((sights * planes[is_full, 3:]).sum(axis=1)) / np.maximum(distances, 1e-9)
    noise = max(float(np.median(thickness / depth_noise)), _LEAST_NOISE)
    is_facing = facing > _LEAST_FACING
    flatness[is_full] = np.where(is_facing, thickness / (_FLAT * noise * depth_noise), np.inf)
    allowed = np.zeros(len(moments))
    allowed[is_full] = _ON_PLANE * noise * depth_noise + _ROUNDING
    order = np.flatnonzero(flatness <= 1.0)
    order = order[np.argsort(flatness[order], kind="stable")]
    numbers = grow_regions(moments, planes, flatness, allowed, order, n_columns, _SAME_DIRECTION)
    groups = _on_one_plane(moments, planes, numbers, allowed)
    areas = np.zeros(len(moments))
    areas[is_full] = (CELL * pitch * distances) ** 2 / np.maximum(facing, _LEAST_FACING)
    regions = []
    for cells in groups:
        [plane], _ = fit_planes(moments[cells].sum(axis=0)[None])
        normal = plane[3:] if plane[3:] @ (viewpoint - plane[:3]) > 0 else -plane[3:]
        regions.append(PlanarRegion(plane[:3], normal, planes[cells, :3], float(areas[cells].sum())))
    regions.sort(key=lambda region: -region.area)
    return PlanarScene(regions, noise)


def _on_one_plane(
    moments: NDArray[np.float64],
    planes: NDArray[np.float64],
    numbers: NDArray[np.int32],
    allowed: NDArray[np.float64],
) -> list[NDArray[np.int64]]:
    """Cells of each plane: regions on one plane are put together, smaller ones to larger ones."""
    sizes = np.bincount(numbers[numbers >= 0])
    groups: list[NDArray[np.int64]] = []
    fitted: list[NDArray[np.float64]] = []
    for number in np.argsort(-sizes, kind="stable"):
        if sizes[number] < _FEWEST_CELLS:
            break
        cells = np.flatnonzero(numbers == number)
        total = moments[cells].sum(axis=0)
        [plane], _ = fit_planes(total[None])
        for position, larger in enumerate(fitted):
            apart = np.abs((planes[cells, :3] - larger[:3]) @ larger[3:])
            if abs(plane[3:] @ larger[3:]) > _PARALLEL and (apart < 2.0 * allowed[cells]).mean() > 0.8:
                groups[position] = np.concatenate([groups[position], cells])
                [fitted[position]], _ = fit_planes(moments[groups[position]].sum(axis=0)[None])
                break
        else:
            groups.append(cells)
            fitted.append(plane)
    return groups
