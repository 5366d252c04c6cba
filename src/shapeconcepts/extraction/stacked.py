"""Objects that stand on others: they rise from a level part of what is below, with a crease around."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.component_kernels import connected_components, contacts
from shapeconcepts.extraction.pixel_grid import PixelGrid
from shapeconcepts.extraction.planar_regions import PlanarRegion
from shapeconcepts.extraction.supporting_planes import HORIZONTAL, level_plane, signed_sides

# Metres above a level part, beside noise, from which on something stands on it.
ABOVE = 0.012
# Share of its border along which it goes on as what is below, beyond the level part: then it is that.
GOES_ON = 0.1
_FEWEST_PIXELS, _FEWEST_LEVEL = 250, 125
_LEAST_AREA = 0.002
# Metres within the outline of the cells' means.
_WITHIN = 0.004


def part_stacked(
    numbers: NDArray[np.int32],
    n: int,
    grid: PixelGrid,
    regions: list[PlanarRegion],
    noises: NDArray[np.float32],
) -> int:
    """Give objects that stand on others numbers of their own, in place; how many there are then.

    Where an object has a level part, what is above it is another object if it touches nothing but that part:
    it ends at a crease all along its base, and elsewhere at its silhouette. What goes on beyond the level
    part, such as the wall around the floor of a bowl, is the same object.

    Parameters
    ----------
    numbers : (h, w) int32
        Object of each pixel, -1 for none.
    n : int
    grid : PixelGrid
    regions : list of PlanarRegion
    noises : (h, w) float32
        Of the depth, metres.
    """
    own_pixels = np.flatnonzero(numbers.ravel() >= 0)
    points = grid.points.reshape(-1, 3)[own_pixels]
    allowed = ABOVE + 2.0 * noises.ravel()[own_pixels]
    for region in regions:
        if region.normal @ grid.up < HORIZONTAL or region.area < _LEAST_AREA:
            continue
        plane = level_plane(region)
        if plane is None:
            continue
        height = (points - plane.point) @ plane.normal
        level = np.flatnonzero(np.abs(height) < allowed)
        level = level[signed_sides(plane, points[level]) < -_WITHIN]
        if len(level) < _FEWEST_LEVEL:
            continue
        base = int(np.bincount(numbers.ravel()[own_pixels[level]]).argmax())
        of_base = np.flatnonzero(numbers.ravel()[own_pixels] == base)
        is_above = height[of_base] > allowed[of_base]
        if is_above.sum() < _FEWEST_PIXELS:
            continue
        is_inside = signed_sides(plane, points[of_base]) < -_WITHIN
        is_over = np.zeros(numbers.size, bool)
        is_over[own_pixels[of_base[is_inside & is_above]]] = True
        beyond = np.full(numbers.size, -1, np.int32)
        beyond[own_pixels[of_base[~is_inside | (height[of_base] < -allowed[of_base])]]] = 0
        parts, n_parts = connected_components(is_over.reshape(numbers.shape), grid.distances, grid.jumps)
        if not n_parts:
            continue
        counts, borders = contacts(
            parts, n_parts, beyond.reshape(numbers.shape), 1, grid.distances, grid.jumps
        )
        sizes = np.bincount(parts[parts >= 0], minlength=n_parts)
        for part in np.flatnonzero((sizes >= _FEWEST_PIXELS) & (counts[:, 0] <= GOES_ON * borders)):
            numbers[parts == part] = n
            n += 1
    return n
