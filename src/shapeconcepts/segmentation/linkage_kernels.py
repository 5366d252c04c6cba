"""Kernel of the average-linkage merging of neighbouring regions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def _stable_order(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Stable order of small keys, not negative, by counting: linear, and faster than numba's sort."""
    start = np.zeros(keys.max() + 2, np.int64)
    for key in keys:
        start[key + 1] += 1
    for key in range(1, len(start)):
        start[key] += start[key - 1]
    order = np.empty(len(keys), np.int64)
    for i in range(len(keys)):
        order[start[keys[i]]] = i
        start[keys[i]] += 1
    return order


@kernel
def patch_borders(
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    patches: NDArray[np.int32],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Sum ``1 - cos(angle between normals)`` over the adjacent voxel pairs on each border of two patches.

    Returns
    -------
    first, second : (e,) int64
        Neighbouring patches, first < second, every pair once.
    total : (e,) float64
    count : (e,) int64
        Sum, and number of voxel pairs.
    """
    n_patches = patches.max() + 1
    members = _stable_order(patches + np.int64(1))
    first = np.empty(len(indices), np.int64)
    second = np.empty(len(indices), np.int64)
    total = np.empty(len(indices))
    count = np.empty(len(indices), np.int64)
    edge_to = np.full(n_patches, -1)
    edges = 0
    for place in range(len(members)):
        i = members[place]
        a = patches[i]
        if a < 0:
            continue
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            j = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
            b = patches[j]
            if b <= a:
                continue
            e = edge_to[b]
            if e < 0 or first[e] != a:
                e = edges
                edges += 1
                edge_to[b] = e
                first[e], second[e], total[e], count[e] = a, b, 0.0, 0
            total[e] += 1 - (
                normals[i, 0] * normals[j, 0] + normals[i, 1] * normals[j, 1] + normals[i, 2] * normals[j, 2]
            )
            count[e] += 1
    return first[:edges], second[:edges], total[:edges], count[:edges]


@kernel
def border_keys(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], labels: NDArray[np.int32]
) -> NDArray[np.int64]:
    """Adjacent voxel pairs of two segments, (b,): the smaller label times their number, plus the other."""
    n = np.int64(labels.max()) + 1
    keys = np.empty(len(indices), np.int64)
    count = 0
    for i in range(len(labels)):
        a = labels[i]
        if a < 0:
            continue
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            b = labels[np.uint32(indices[k])]
            if b > a:
                keys[count] = a * n + b
                count += 1
    return keys[:count]


@kernel
def average_linkage(
    n_regions: int,
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    difference: NDArray[np.float64],
    pairs: NDArray[np.int64],
    stop: float,
) -> NDArray[np.int64]:
    """Merge neighbouring regions while the mean difference over their common border is below `stop`.

    Every round merges all pairs of regions that are each other's best neighbour; as average linkage is
    reducible, this gives the same regions as merging the best pair of all, again and again.

    Parameters
    ----------
    first, second : (e,) int64
        Neighbouring regions, first < second.
    difference : (e,) float64
        Sum of the differences across the border.
    pairs : (e,) int64
        Number of differences in the sum.

    Returns
    -------
    (n_regions,) int64
        The smallest region of the group that each region ends in.
    """
    a, b, total, count = first.copy(), second.copy(), difference.copy(), pairs.copy()
    group = np.arange(n_regions)
    while True:
        if len(a) == 0:
            return group
        order = _stable_order(b)
        order = order[_stable_order(a[order])]
        kept = -1
        sorted_a, sorted_b, sorted_total, sorted_count = a[order], b[order], total[order], count[order]
        for e in range(len(order)):
            if kept >= 0 and a[kept] == sorted_a[e] and b[kept] == sorted_b[e]:
                total[kept] += sorted_total[e]
                count[kept] += sorted_count[e]
            else:
                kept += 1
                a[kept], b[kept] = sorted_a[e], sorted_b[e]
                total[kept], count[kept] = sorted_total[e], sorted_count[e]
        a, b, total, count = a[: kept + 1], b[: kept + 1], total[: kept + 1], count[: kept + 1]

        lowest = np.full(n_regions, stop)
        best = np.full(n_regions, -1)
        for e in range(len(a)):
            mean = total[e] / count[e]
            if mean < lowest[a[e]]:
                lowest[a[e]] = mean
                best[a[e]] = b[e]
            if mean < lowest[b[e]]:
                lowest[b[e]] = mean
                best[b[e]] = a[e]
        target = np.arange(n_regions)
        merged = False
        for r in range(n_regions):
            if best[r] > r and best[best[r]] == r:
                target[best[r]] = r
                merged = True
        if not merged:
            return group
        for r in range(n_regions):
            group[r] = target[group[r]]
        kept = 0
        for e in range(len(a)):
            low, high = target[a[e]], target[b[e]]
            if low != high:
                a[kept], b[kept] = min(low, high), max(low, high)
                total[kept], count[kept] = total[e], count[e]
                kept += 1
        a, b, total, count = a[:kept], b[:kept], total[:kept], count[:kept]
