"""Kernels that measure creases along the borders of regions, and sharpen the borders."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.segmentation.surface_fit_kernels import fit_surface, gather_surroundings


@kernel
def border_voxels(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], labels: NDArray[np.int32]
) -> NDArray[np.int64]:
    """Voxels of a region with a voxel of another region, or of none, next to them."""
    voxels = np.empty(len(labels), np.int64)
    count = 0
    for i in range(len(labels)):
        if labels[i] < 0:
            continue
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            if labels[np.uint32(indices[k])] != labels[i]:
                voxels[count] = i
                count += 1
                break
    return voxels[:count]


@kernel
def border_pairs(
    points: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    labels: NDArray[np.int32],
    voxels: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]]:
    """Pair every border voxel of a region with the nearest adjacent voxel of each neighbouring region.

    Only the side of the smaller region number is listed.

    Parameters
    ----------
    voxels : (v,) int64
        The voxels to look at, all border voxels among them, rising.

    Returns
    -------
    key : (p,) int64
        ``a * 2**31 + b`` for a pair of regions a < b, in the order of the voxels of a.
    first, second : (p,) int32
        The voxel in a, and its partner in b.
    """
    key = np.empty(len(indices), np.int64)
    first = np.empty(len(indices), np.int32)
    second = np.empty(len(indices), np.int32)
    count = 0
    for i in voxels:
        a = labels[i]
        if a < 0:
            continue
        start = count
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            j = indices[k]
            b = labels[np.uint32(j)]  # an unsigned index needs no test for counting from the end
            if b <= a:
                continue
            place = start
            while place < count and labels[second[place]] != b:
                place += 1
            if place == count:
                key[count] = a * 2**31 + b
                first[count] = i
                second[count] = j
                count += 1
            elif _squared_distance(points, i, j) < _squared_distance(points, i, second[place]):
                second[place] = j
    return key[:count], first[:count], second[:count]


@kernel
def _squared_distance(points: NDArray[np.float64], i: int, j: int) -> float:
    dx, dy, dz = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1], points[i, 2] - points[j, 2]
    return dx * dx + dy * dy + dz * dz


@kernel
def crease_angles(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    labels: NDArray[np.int32],
    first: NDArray[np.int32],
    second: NDArray[np.int32],
    starts: NDArray[np.int64],
    ends: NDArray[np.int64],
    scale: float,
    max_places: int,
) -> NDArray[np.float64]:
    """Mean angle by which the surface turns at each border of two regions, convex positive, in radians.

    At up to `max_places` places along a border both regions' surfaces are extended to it, each from its own
    points; the angle between them is signed, so that noise cancels along a border where the surface is
    smooth. Infinite where no place has enough points on both sides.

    Parameters
    ----------
    first, second : (p,) int32
        Pairs of voxels across the borders, as of `border_pairs`.
    starts, ends : (b,) int64
        Where the pairs of each border start and end.
    """
    angles = np.full(len(starts), np.inf)
    workspace = np.empty((7, 7))
    stamps = np.zeros(len(points), np.int32)
    surroundings = np.empty(len(points), np.int32)
    stamp = 0
    for border in range(len(starts)):
        n = ends[border] - starts[border]
        step = max(1.0, n / max_places)
        total = 0.0
        weight = 0.0
        for place in range(min(n, max_places)):
            i = first[starts[border] + int(place * step)]
            j = second[starts[border] + int(place * step)]
            stamp += 1
            around = gather_surroundings(points, indptr, indices, i, scale, stamps, stamp, surroundings)
            x = (points[i, 0] + points[j, 0]) / 2
            y = (points[i, 1] + points[j, 1]) / 2
            z = (points[i, 2] + points[j, 2]) / 2
            count_a, _, ax, ay, az = fit_surface(
                points, normals, labels, labels[i], surroundings[:around], x, y, z, scale, workspace
            )
            count_b, _, bx, by, bz = fit_surface(
                points, normals, labels, labels[j], surroundings[:around], x, y, z, scale, workspace
            )
            if count_a == 0 or count_b == 0:
                continue
            angle = math.acos(min(1.0, max(-1.0, ax * bx + ay * by + az * bz)))
            opening = (
                (ax - bx) * (points[i, 0] - points[j, 0])
                + (ay - by) * (points[i, 1] - points[j, 1])
                + (az - bz) * (points[i, 2] - points[j, 2])
            )
            # The side with fewer points limits how well the angle is known.
            total += min(count_a, count_b) * (angle if opening >= 0 else -angle)
            weight += min(count_a, count_b)
        if weight > 0:
            angles[border] = total / weight
    return angles


@kernel
def sharpen_borders(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    labels: NDArray[np.int32],
    scale: float,
    smoothness: float,
    rounds: int,
) -> NDArray[np.int32]:
    """Give every border voxel to the adjacent region whose surface, extended to it, passes nearest.

    Parameters
    ----------
    scale : float
        Radius of the surroundings that surfaces are fitted to.
    smoothness : float
        Distance that a voxel is worth all of whose adjacent voxels are in another region; keeps borders
        straight.
    """
    workspace = np.empty((7, 7))
    m = len(labels)
    stamps = np.zeros(m, np.int32)
    surroundings = np.empty(m, np.int32)
    stamp = 0
    # Regions around a voxel, its own first, and how many of the adjacent voxels each holds.
    regions = np.empty(m + 1, np.int32)
    members = np.empty(m + 1, np.int64)
    current = labels.copy()
    active = np.ones(m, np.bool_)
    for _ in range(rounds):
        updated = current.copy()
        for i in range(m):
            own = current[i]
            if own < 0 or not active[i]:
                continue
            degree = indptr[i + 1] - indptr[i]
            same = 0
            for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
                same += current[np.uint32(indices[k])] == own
            if same == degree:
                continue
            stamp += 1
            n_around = gather_surroundings(points, indptr, indices, i, scale, stamps, stamp, surroundings)
            regions[0], members[0] = own, same
            n_regions = 1
            for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
                region = current[np.uint32(indices[k])]
                if region < 0 or region == own:
                    continue
                place = 1
                while place < n_regions and regions[place] != region:
                    place += 1
                if place == n_regions:
                    regions[place], members[place] = region, 0
                    n_regions += 1
                members[place] += 1
            lowest = np.inf
            best = own
            for place in range(n_regions):
                # What smoothness alone makes too costly needs no fit.
                roughness = smoothness * (1 - members[place] / degree)
                if roughness >= lowest:
                    continue
                count, height, _, _, _ = fit_surface(
                    points,
                    normals,
                    current,
                    regions[place],
                    surroundings[:n_around],
                    points[i, 0],
                    points[i, 1],
                    points[i, 2],
                    scale,
                    workspace,
                )
                if count > 0 and abs(height) + roughness < lowest:
                    lowest = abs(height) + roughness
                    best = regions[place]
            updated[i] = best
        active[:] = False
        for i in range(m):
            if updated[i] != current[i]:
                active[i] = True
                for k in range(indptr[i], indptr[i + 1]):
                    active[indices[k]] = True
        current = updated
        if not active.any():
            break
    return current
