"""From a scan to voxels with normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbour_kernels import restrict
from shapeconcepts.geometry.neighbours import Neighbours, radius_neighbours
from shapeconcepts.geometry.normal_kernels import principal_component_normals
from shapeconcepts.geometry.origin import nearest_tile, origin_amid
from shapeconcepts.geometry.point_kernels import first_of_equals
from shapeconcepts.parameters import check_length
from shapeconcepts.preparation.closedness import is_seen_from_all_sides
from shapeconcepts.preparation.hidden_points import visible_points
from shapeconcepts.preparation.prepared_object import PreparedObject
from shapeconcepts.preparation.rounded import rounding_notices
from shapeconcepts.preparation.sensor_direction import estimate_viewpoint, orient_normals
from shapeconcepts.preparation.stray_points import stray_points
from shapeconcepts.preparation.unusual import unusual
from shapeconcepts.preparation.voxel_grid import VoxelGrid, adaptive_voxel_grid, voxel_grid
from shapeconcepts.scan import ScanError, measured_rows
from shapeconcepts.sources.conversion import as_scan

# A hair more than 3: points on whole millimetres are often just 3 voxels apart, and rounding must not decide.
NEIGHBOUR_RADIUS = 3.000003
STRAY_ROUNDS = 2
# Metres.
LARGEST = 1e9


def prepare(scan: object, *, voxel_size: float | str = "auto") -> PreparedObject:
    """Average a scan over a voxel grid, drop stray points, and estimate normals.

    What was not measured (see `measured_rows`) and copies of a point count nowhere. Of a complete cloud, seen
    from all sides (see `is_seen_from_all_sides`), only what is visible from one place counts: from the
    sensor's where it is known, else from where the surface is seen best.

    Normals come from a principal component analysis over a radius of 3 voxels. They point towards the sensor;
    where its position is unknown, towards where it most likely was (see `estimate_viewpoint`), and the
    object's `viewpoint` stays None.

    Parameters
    ----------
    scan : Scan, (n, 3) array, or object with `.points`
    voxel_size : float or "auto"
        Edge length of the voxels, metres. "auto": 5 mm, more where the points are sparser (see
        `adaptive_voxel_grid`).

    Returns
    -------
    PreparedObject

    Raises
    ------
    ScanError
        If the scan is none, has no finite point, its coordinates or viewpoint are too far to compute with, or
        so far and rounded that they hold no shape.
    ValueError
        If `voxel_size` is neither "auto" nor a positive number.
    """
    if voxel_size != "auto":
        voxel_size = check_length("voxel_size", voxel_size)
    scan = as_scan(scan)
    kept = measured_rows(scan.points)
    name = scan.name or "scan"
    if not kept.any():
        raise ScanError(f"{name}: none of its {len(kept)} points is finite")
    # Published clouds of a fixed number of points repeat some of them.
    points = scan.points if kept.all() else scan.points[kept]
    is_first = first_of_equals(points)
    if not is_first.all():
        kept[kept] = is_first
        points = points[is_first]
    if np.abs(points).max() > LARGEST:
        raise ScanError(
            f"{name}: coordinates up to {np.abs(points).max():.3g}, expected metres (at most 1e9)"
        )
    if scan.viewpoint is not None and np.abs(scan.viewpoint).max() > LARGEST:
        raise ScanError(f"{name}: viewpoint {scan.viewpoint.tolist()}, expected metres (at most 1e9)")
    of_rounding = rounding_notices(points, name) if nearest_tile(points).any() else ()
    origin = origin_amid(points)
    points = origin.take_off(points)
    grid = voxel_grid(points, voxel_size) if isinstance(voxel_size, float) else adaptive_voxel_grid(points)
    neighbours = radius_neighbours(grid.points, NEIGHBOUR_RADIUS * grid.voxel_size)
    for _ in range(STRAY_ROUNDS):
        stray = stray_points(neighbours)
        if not stray.any():
            break
        stays = ~stray[grid.point_to_voxel]
        points = points[stays]
        kept[kept] = stays
        grid = _without(grid, stray, stays)
        neighbours = Neighbours(*restrict(*neighbours, ~stray))
    normals = principal_component_normals(grid.points, neighbours.indptr, neighbours.indices)
    if scan.viewpoint is None:
        viewpoint, _ = estimate_viewpoint(points, grid.points, normals)
    else:
        viewpoint = origin.take_off(scan.viewpoint)
    is_complete = is_seen_from_all_sides(grid, viewpoint)
    if is_complete:
        hidden = ~visible_points(grid.points, viewpoint)
        stays = ~hidden[grid.point_to_voxel]
        kept[kept] = stays
        grid = _without(grid, hidden, stays)
        neighbours = Neighbours(*restrict(*neighbours, ~hidden))
        normals = principal_component_normals(grid.points, neighbours.indptr, neighbours.indices)
    point_to_voxel = np.full(len(scan.points), -1, np.int32)
    point_to_voxel[kept] = grid.point_to_voxel
    return PreparedObject(
        offsets=grid.points,
        origin=origin.metres,
        normals=orient_normals(grid.points, normals, viewpoint),
        point_to_voxel=point_to_voxel,
        neighbours=neighbours,
        voxel_size=grid.voxel_size,
        viewpoint=scan.viewpoint,
        name=scan.name,
        label=scan.label,
        notices=(*scan.notices, *of_rounding, *unusual(grid, is_complete, scan.notices)),
    )


def _without(grid: VoxelGrid, dropped: NDArray[np.bool_], kept: NDArray[np.bool_]) -> VoxelGrid:
    row = np.cumsum(~dropped, dtype=np.int32) - 1
    return VoxelGrid(grid.points[~dropped], row[grid.point_to_voxel[kept]], grid.voxel_size)
