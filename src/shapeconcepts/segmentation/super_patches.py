"""Super patches: atomic patches joined where the surface goes on smoothly, kept apart at creases."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbour_kernels import ends_of_runs
from shapeconcepts.geometry.neighbours import Neighbours, sorting_order
from shapeconcepts.segmentation.border_settling_kernels import settle_borders
from shapeconcepts.segmentation.crease_kernels import (
    border_pairs,
    border_voxels,
    crease_angles,
    sharpen_borders,
)
from shapeconcepts.segmentation.linkage_kernels import average_linkage, patch_borders

FLAT_ANGLE = np.radians(12.0)
CREASE_ANGLE = np.radians(35.0)
CREASE_PLACES = 16
SURFACE_RADIUS = 5.0
BORDER_SMOOTHNESS = 0.6
SHARPENING_ROUNDS = 3


def super_patches(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    adjacency: Neighbours,
    patches: NDArray[np.int32],
    voxel_size: float,
) -> NDArray[np.int32]:
    """Join patches over smooth borders.

    First, patches are joined by average linkage while the normals turn by less than 12 degrees across their
    border: this gives nearly flat regions, large enough to fit a surface to. Then the regions on both sides
    of each border are extended to it, each from its own points, and the pair that meets at the smallest angle
    is joined, again and again, until every remaining border is a crease of more than 35 degrees. Neither step
    can leak through a weak spot, as both judge a border as a whole. Then the voxels at the borders go to the
    side whose surface passes nearest, and the borders are judged again. Last, the borders that are left, all
    of them creases, are laid along the lines where the surfaces meet.

    Parameters
    ----------
    points, normals : (m, 3) float64
        Voxel-grid points and smoothed unit normals.
    adjacency : Neighbours
        Adjacent voxels. Surfaces are fitted to what lies within 5 voxels and two steps through these.
    patches : (m,) int32
        Atomic patch of each voxel, -1 for none.
    voxel_size : float
        Metres.

    Returns
    -------
    (m,) int32
        Region of each voxel, numbered without gaps, -1 for none.
    """
    radius = SURFACE_RADIUS * voxel_size
    regions = _consecutive(_join_flat(normals, adjacency, patches))
    regions = _join_smooth(points, normals, adjacency, regions, radius)
    if regions.max() <= 0:
        return _consecutive(regions)
    regions = sharpen_borders(
        points,
        normals,
        *adjacency,
        regions,
        radius,
        BORDER_SMOOTHNESS * voxel_size,
        SHARPENING_ROUNDS,
    )
    regions = _consecutive(_join_smooth(points, normals, adjacency, regions, radius))
    if regions.max() <= 0:
        return regions
    regions = settle_borders(
        points, normals, *adjacency, regions, radius, BORDER_SMOOTHNESS * voxel_size, voxel_size
    )
    return _consecutive(regions)


def _join_flat(
    normals: NDArray[np.float64], adjacency: Neighbours, patches: NDArray[np.int32]
) -> NDArray[np.int32]:
    first, second, difference, count = patch_borders(normals, *adjacency, patches)
    group = average_linkage(int(patches.max()) + 1, first, second, difference, count, 1 - np.cos(FLAT_ANGLE))
    return np.where(patches >= 0, group[patches], -1).astype(np.int32)


def _join_smooth(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    adjacency: Neighbours,
    regions: NDArray[np.int32],
    radius: float,
) -> NDArray[np.int32]:
    known: dict[tuple[int, int], float] = {}
    voxels = border_voxels(*adjacency, regions)  # merging makes no others
    while True:
        keys, first, second = border_pairs(points, *adjacency, regions, voxels)
        order = sorting_order(keys)
        first, second = first[order], second[order]
        bounds = ends_of_runs(keys[order])
        starts, ends = bounds[:-1], bounds[1:]
        borders = list(zip(regions[first[starts]].tolist(), regions[second[starts]].tolist(), strict=True))
        new = np.array([border not in known for border in borders], bool)
        angles = crease_angles(
            points,
            normals,
            *adjacency,
            regions,
            first,
            second,
            starts[new],
            ends[new],
            radius,
            CREASE_PLACES,
        )
        fresh = iter(np.abs(angles).tolist())
        known = {border: known[border] if border in known else next(fresh) for border in borders}
        merged = _mutual_best(known)
        if not merged:
            return regions
        target = np.arange(regions.max() + 1, dtype=np.int32)
        for a, b in merged:
            target[b] = a
        known = _unchanged(known, target)
        regions = np.where(regions >= 0, target[regions], np.int32(-1))


def _mutual_best(angles: dict[tuple[int, int], float]) -> list[tuple[int, int]]:
    """Pairs of regions that are each other's smoothest neighbour, with no crease between them."""
    best: dict[int, tuple[float, int]] = {}
    for (a, b), angle in angles.items():
        best[a] = min(best.get(a, (angle, b)), (angle, b))
        best[b] = min(best.get(b, (angle, a)), (angle, a))
    return [(a, b) for a, (angle, b) in best.items() if a < b and best[b][1] == a and angle < CREASE_ANGLE]


def _unchanged(
    angles: dict[tuple[int, int], float], target: NDArray[np.int32]
) -> dict[tuple[int, int], float]:
    """Angles of the borders that merging leaves as long as they were, by the new numbers of their regions.

    Only a border of both merged regions with a third grows. Measuring the others again, too, because one of
    their regions now goes on farther away, would hardly change them, and would cost more than all the rest on
    objects of many regions.
    """
    found: dict[tuple[int, int], list[float]] = {}
    for (a, b), angle in angles.items():
        first, second = int(target[a]), int(target[b])
        found.setdefault((min(first, second), max(first, second)), []).append(angle)
    return {border: values[0] for border, values in found.items() if len(values) == 1}


def _consecutive(labels: NDArray[np.int32]) -> NDArray[np.int32]:
    """Number labels 0, 1, ... in their order; -1 stays."""
    used = np.flatnonzero(np.bincount(labels[labels >= 0]))
    number = np.zeros(labels.max(initial=0) + 1, np.int32)
    number[used] = np.arange(len(used))
    return np.where(labels >= 0, number[labels], -1).astype(np.int32)
