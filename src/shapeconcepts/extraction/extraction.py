"""From a scene to the objects in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.background import is_background
from shapeconcepts.extraction.component_kernels import flying_pixels, near_pairs
from shapeconcepts.extraction.creases import have_creases
from shapeconcepts.extraction.depth_noise import depth_noises
from shapeconcepts.extraction.extracted_object import ExtractedObject
from shapeconcepts.extraction.fragments import find_fragments, joined
from shapeconcepts.extraction.gravity import upward
from shapeconcepts.extraction.heights import Heights, measure_heights
from shapeconcepts.extraction.hollow import hollow_pairs
from shapeconcepts.extraction.interlocking import interlocked_pairs
from shapeconcepts.extraction.pixel_grid import ScenePixels, scene_pixels
from shapeconcepts.extraction.planar_regions import PlanarRegion, planar_regions
from shapeconcepts.extraction.stacked import part_stacked
from shapeconcepts.extraction.supporting_planes import SupportingPlane, supporting_planes
from shapeconcepts.extraction.unsupported import unsupported_objects
from shapeconcepts.parameters import check_integer
from shapeconcepts.scan import Scan
from shapeconcepts.scene import Scene

FEWEST_POINTS = 250
# Share of an object's pixels that are above what it stands on, and that cannot be noise.
_ABOVE, _BEYOND_NOISE = 0.5, 0.3
# Metres that a level part is above a supporting plane, or it is a part of that.
_LEVEL_ABOVE = 0.015


def extract_objects(scene: Scene, *, fewest_points: int = FEWEST_POINTS) -> list[ExtractedObject]:
    """Find the objects in a scene: what stands on tables, boards or the floor.

    Planes are found among flat cells of the image; of those that are horizontal, objects stand on the ones
    that are no floor below a table and no top of an object. What is higher than the noise of such a plane is
    an object where its surface is connected, see `find_fragments`; what stands on another object and touches
    nothing but its level part is one of its own, see `part_stacked`. Points that hang in the air at edges,
    and walls, belong to none.

    Parameters
    ----------
    scene : Scene
        From one place. A cloud in the frame of a camera (z forward) that is not upright needs `Scene.up`.
    fewest_points : int
        Objects of which fewer points are seen are left out.

    Returns
    -------
    list of ExtractedObject
        From left to right. Empty where objects stand on nothing that can be seen.

    Raises
    ------
    ScanError
        If nothing was measured in the scene.
    ValueError
        If `fewest_points` is not a whole number from 1 on.
    """
    check_integer("fewest_points", fewest_points, 1)
    seen = scene_pixels(scene)
    grid = seen.grid
    found = planar_regions(grid.points, grid.viewpoint, grid.pitch)
    up = upward(found.regions, grid.is_camera_frame, scene.up)
    if up is None:
        return []
    grid = grid._replace(up=up)
    planes = supporting_planes(found.regions, up)
    if not planes:
        return []
    heights = measure_heights(grid.points, grid.viewpoint, planes, found.noise)
    noises = depth_noises(grid.distances, found.noise)
    is_part = heights.is_high | (heights.smooth > heights.low)
    is_part &= heights.height > 0.5 * heights.low
    is_free = np.isfinite(grid.distances) & (is_part | ~heights.is_above) & ~heights.is_beside
    is_free &= ~flying_pixels(grid.distances, grid.jumps)
    is_free &= ~is_background(grid, found.regions, planes, noises)
    numbers, n = find_fragments(grid, heights, is_free, noises)
    beside = near_pairs(numbers, n, grid.points, np.full(numbers.shape, np.inf, np.float32), 2)
    numbers, n = joined(numbers, n, hollow_pairs(numbers, n, beside, grid, heights))
    n_together = n
    n = part_stacked(numbers, n, grid, _level_parts(found.regions, planes), noises)
    may_join = _stand_on_surface(numbers, n, heights) & (np.arange(n) < n_together)
    numbers, n = joined(numbers, n, interlocked_pairs(numbers, n, may_join, grid, heights))
    is_object = _stand_on_surface(numbers, n, heights)
    is_large = np.bincount(numbers[numbers >= 0], minlength=n) >= fewest_points
    is_object |= unsupported_objects(numbers, n, is_large & ~is_object, grid, planes)
    return _objects(scene, seen._replace(grid=grid), numbers, n, is_object, fewest_points)


def _level_parts(regions: list[PlanarRegion], planes: list[SupportingPlane]) -> list[PlanarRegion]:
    """Regions that are no part of what objects stand on."""
    return [
        region
        for region in regions
        if all(abs(np.median((region.cells - one.point) @ one.normal)) > _LEVEL_ABOVE for one in planes)
    ]


def _stand_on_surface(numbers: NDArray[np.int32], n: int, heights: Heights) -> NDArray[np.bool_]:
    """Which parts are above a surface, and cannot be its noise, (n,) bool."""
    own = numbers >= 0
    sizes = np.bincount(numbers[own], minlength=n)
    above = np.bincount(numbers[own], heights.is_above[own], n)
    beyond_noise = np.bincount(numbers[own], heights.is_high[own], n)
    return np.asarray((above > _ABOVE * sizes) & (beyond_noise > _BEYOND_NOISE * sizes))


def _objects(
    scene: Scene,
    seen: ScenePixels,
    numbers: NDArray[np.int32],
    n: int,
    is_object: NDArray[np.bool_],
    fewest_points: int,
) -> list[ExtractedObject]:
    grid, pixels, is_image = seen
    of_point = numbers.ravel() if is_image else _numbers_of_points(scene, seen, numbers)
    members = np.flatnonzero(of_point >= 0)
    members = members[np.argsort(of_point[members], kind="stable")]
    ends = np.searchsorted(of_point[members], np.arange(n + 1))
    height, width = numbers.shape
    creased = have_creases(numbers, n, grid)
    objects = []
    for number in np.flatnonzero(is_object):
        indices = members[ends[number] : ends[number + 1]]
        if len(indices) < fewest_points:
            continue
        rows, columns = np.divmod(pixels[indices], width)
        box = int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1
        is_cut = box[0] == 0 or box[1] == 0 or box[2] == width or box[3] == height
        objects.append((indices, box, is_cut, bool(creased[number])))
    objects.sort(key=lambda one: (one[1][0] + one[1][2], one[1]))
    points, labels = scene.points.reshape(-1, 3), scene.point_labels
    return [
        ExtractedObject(
            Scan(
                points[indices],
                scene.viewpoint if scene.viewpoint is not None or not grid.is_camera_frame else np.zeros(3),
                f"{scene.name}/{number}" if scene.name else str(number),
                point_labels=None if labels is None else labels.ravel()[indices],
                notices=scene.notices,
            ),
            indices,
            box,
            is_cut,
            may_be_several,
            scene.time,
        )
        for number, (indices, box, is_cut, may_be_several) in enumerate(objects)
    ]


def _numbers_of_points(scene: Scene, seen: ScenePixels, numbers: NDArray[np.int32]) -> NDArray[np.int32]:
    """Object of each point, (n,): that of its pixel, if the point is on the surface that the pixel shows."""
    grid, pixels, _ = seen
    distances = np.linalg.norm(scene.points.reshape(-1, 3) - grid.origin - grid.viewpoint, axis=1)
    nearest, jumps = grid.distances.ravel()[pixels], grid.jumps.ravel()[pixels]
    is_shown = (pixels >= 0) & (distances - nearest < jumps)
    return np.where(is_shown, numbers.ravel()[pixels], -1)
