"""Kernels of the supervoxel clustering."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def closer_neighbours(
    points: NDArray[np.float64], indptr: NDArray[np.int64], indices: NDArray[np.int32], radius: float
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Shorten neighbour lists to a smaller radius; the order within a list stays."""
    m = len(indptr) - 1
    shorter_indptr = np.zeros(m + 1, np.int64)
    shorter = np.empty(len(indices), np.int32)
    count = np.uint64(0)
    for i in range(m):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            j = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
            dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            shorter[count] = j
            count += np.uint64(dx * dx + dy * dy + dz * dz <= radius * radius)
        shorter_indptr[i + 1] = count
    return shorter_indptr, shorter[:count].copy()


# Products and sums may be fused: the same result on each run of a machine.
@kernel(fastmath={"contract"})
def smooth_normals(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    width: float,
    angular_width: float,
    rounds: int,
) -> NDArray[np.float64]:
    """Bilateral filter of normals: averages over a surface, not across a crease.

    Parameters
    ----------
    indptr, indices
        Neighbours, as of `shapeconcepts.geometry.neighbours.Neighbours`.
    width : float
        Distance at which a neighbour's weight has fallen to 2/3, in the unit of the points.
    angular_width : float
        Angle from which on a neighbour has no weight, radians.
    """
    m = len(points)
    # Two neighbours have the same weight for each other, so each pair is taken once.
    starts = np.zeros(m + 1, np.int64)
    later = np.empty(len(indices) // 2, np.uint32)
    spatial = np.empty(len(later))
    count = np.uint64(0)
    for i in range(m):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        place = np.uint64(indptr[i + 1])
        while place > np.uint64(indptr[i]) and indices[place - np.uint64(1)] > i:
            place -= np.uint64(1)
            j = np.uint32(indices[place])
            dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            later[count] = j
            spatial[count] = 1 / (1 + (dx * dx + dy * dy + dz * dz) / (2 * width * width))
            count += np.uint64(1)
        starts[i + 1] = count
    sharpness = 1 / (1 - math.cos(angular_width))
    current = normals.copy()
    for _ in range(rounds):
        sums = current.copy()
        for i in range(m):
            x, y, z = current[i, 0], current[i, 1], current[i, 2]
            sx, sy, sz = 0.0, 0.0, 0.0
            for k in range(np.uint64(starts[i]), np.uint64(starts[i + 1])):
                j = later[k]
                nx, ny, nz = current[j, 0], current[j, 1], current[j, 2]
                closeness = 1 - (1 - (nx * x + ny * y + nz * z)) * sharpness
                closeness = closeness if closeness > 0.0 else 0.0
                weight = spatial[k] * closeness * closeness
                sx += weight * nx
                sy += weight * ny
                sz += weight * nz
                sums[j, 0] += weight * x
                sums[j, 1] += weight * y
                sums[j, 2] += weight * z
            sums[i, 0] += sx
            sums[i, 1] += sy
            sums[i, 2] += sz
        for i in range(m):
            x, y, z = sums[i, 0], sums[i, 1], sums[i, 2]
            length = math.sqrt(x * x + y * y + z * z)
            sums[i, 0], sums[i, 1], sums[i, 2] = x / length, y / length, z / length
        current = sums
    return current


@kernel
def grow_supervoxels(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    seeds: NDArray[np.int64],
    seed_size: float,
    normal_weight: float,
    rounds: int,
) -> NDArray[np.int32]:
    """Flow-constrained clustering: every seed grows along the surface, one layer of neighbours a round.

    A voxel goes to the neighbouring supervoxel to whose centre it is closest, by
    ``(distance / seed_size)^2 + normal_weight * (1 - cos(angle))``, the angle being that between the normals
    (VCCS, equation 1, without colour). All voxels of a round change at once, so that the result depends on no
    order.

    Returns
    -------
    (m,) int32
        Supervoxel of each voxel, -1 where no seed reached it.
    """
    m = len(points)
    owner = np.full(m, -1, np.int32)
    distance = np.full(m, np.inf)
    for s in range(len(seeds)):
        owner[seeds[s]] = s
        distance[seeds[s]] = 0.0
    changed = owner >= 0
    frontier = np.flatnonzero(changed)
    changed[:] = False
    next_owner = owner.copy()
    for _ in range(rounds):
        for i in frontier:
            s = owner[i]
            c = seeds[s]
            x, y, z = points[c, 0], points[c, 1], points[c, 2]
            nx, ny, nz = normals[c, 0], normals[c, 1], normals[c, 2]
            for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
                j = np.uint32(indices[k])
                dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
                cosine = normals[j, 0] * nx + normals[j, 1] * ny + normals[j, 2] * nz
                d = (dx * dx + dy * dy + dz * dz) / (seed_size * seed_size) + normal_weight * (1 - cosine)
                if d < distance[j]:  # which is false where s is the owner
                    distance[j] = d
                    next_owner[j] = s
                    changed[j] = True
        frontier = np.flatnonzero(changed)
        if len(frontier) == 0:
            break
        for reached in frontier:
            owner[reached] = next_owner[reached]
            changed[reached] = False
    return owner


@kernel
def central_voxels(
    points: NDArray[np.float64], owner: NDArray[np.int32], seeds: NDArray[np.int64]
) -> NDArray[np.int64]:
    """For every supervoxel the member nearest to its centroid."""
    n = len(seeds)
    centroids = np.zeros((n, 3))
    size = np.zeros(n)
    for i in range(len(owner)):
        s = owner[i]
        if s >= 0:
            centroids[s] += points[i]
            size[s] += 1
    for s in range(n):
        centroids[s] /= size[s]
    central = seeds.copy()
    nearest = np.full(n, np.inf)
    for i in range(len(owner)):
        s = owner[i]
        if s >= 0:
            dx, dy, dz = (
                points[i, 0] - centroids[s, 0],
                points[i, 1] - centroids[s, 1],
                points[i, 2] - centroids[s, 2],
            )
            d = dx * dx + dy * dy + dz * dz
            if d < nearest[s]:
                nearest[s] = d
                central[s] = i
    return central


@kernel
def inherit_patches(
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    patches: NDArray[np.int32],
    segments: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Let every patch lie in one segment: the one that holds most of it.

    A voxel that the segment border moved away from its patch joins the patch of an adjacent voxel of its
    segment. What is left, and a patch's voxels without a segment, belong to no patch.
    """
    n_patches = patches.max() + 1
    n_segments = segments.max() + 1
    votes = np.zeros((n_patches, n_segments), np.int32)
    for i in range(len(patches)):
        if patches[i] >= 0 and segments[i] >= 0:
            votes[patches[i], segments[i]] += 1
    inherited = np.full(len(patches), -1, np.int32)
    for i in range(len(patches)):
        if patches[i] >= 0 and segments[i] >= 0 and segments[i] == votes[patches[i]].argmax():
            inherited[i] = patches[i]
    changed = True
    while changed:
        changed = False
        previous = inherited.copy()
        for i in range(len(patches)):
            if previous[i] >= 0 or segments[i] < 0:
                continue
            for k in range(indptr[i], indptr[i + 1]):
                j = indices[k]
                if previous[j] >= 0 and segments[j] == segments[i]:
                    inherited[i] = previous[j]
                    changed = True
                    break
    return inherited
