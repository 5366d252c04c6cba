"""Kernel of the average-linkage merging of neighbouring regions."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def average_linkage(
    n_regions: int,
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    difference: NDArray[np.float64],
    stop: float,
) -> NDArray[np.int64]:
    """Merge neighbouring regions while the mean difference over their common border is below `stop`.

    Every round merges all pairs of regions that are each other's best neighbour; as average linkage is reducible, this
    gives the same regions as merging the best pair of all, again and again.

    Parameters
    ----------
    first, second : (p,) int64
        Regions on both sides of each pair of adjacent voxels, first < second.
    difference : (p,) float64
        Difference across each pair.

    Returns
    -------
    (n_regions,) int64
        The smallest region of the group that each region ends in.
    """
    a, b, total = first.copy(), second.copy(), difference.copy()
    count = np.ones(len(a))
    group = np.arange(n_regions)
    while True:
        order = np.argsort(a * n_regions + b, kind="mergesort")
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
