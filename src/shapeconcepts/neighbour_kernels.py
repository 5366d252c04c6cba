"""Kernels of the radius search over points sorted by grid cell."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, error_model="numpy")
def pairs_within(
    coordinates: NDArray[np.float64], keys: NDArray[np.int64], strides: NDArray[np.int64], radius: float
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Every unordered pair of points within a radius, once.

    Parameters
    ----------
    coordinates : (3, m) float64
        Points in the order of rising `keys`.
    keys : (m,) int64
        Cell of each point, `strides @ cell`; cells are at least `radius` wide.
    strides : (3,) int64
        Weights of a cell's x, y and z in its key; z has weight 1, so a line of cells along z has adjacent
        keys.
    radius : float
        Largest distance, inclusive.

    Returns
    -------
    indptr : (m + 1,) int64
    partners : (indptr[m],) int32
        The partners of point i that come after it, rising: ``partners[indptr[i]:indptr[i + 1]]``.
    """
    m = len(keys)
    xs, ys, zs = coordinates[0], coordinates[1], coordinates[2]
    # Half of the 9 lines of cells around a point's own line; the other half sees the pair from its other end.
    lines = np.array([0, strides[1], strides[0] - strides[1], strides[0], strides[0] + strides[1]])
    first = np.zeros(len(lines), np.int64)
    last = np.zeros(len(lines), np.int64)
    squared_radius = radius * radius
    indptr = np.zeros(m + 1, np.int64)
    partners = np.empty(96 * m, np.int32)
    is_near = np.empty(m, np.uint8)
    count = np.uint64(0)
    for i in range(m):
        x, y, z = xs[i], ys[i], zs[i]
        for line in range(len(lines)):
            # Keys rise with i, so both ends of the range only ever move forward.
            key = keys[i] + lines[line]
            low, high = first[line], last[line]
            while low < m and keys[low] < key - 1:
                low += 1
            while high < m and keys[high] <= key + 1:
                high += 1
            first[line], last[line] = low, high
            if line == 0:
                low = i + 1
            if count + high - low > len(partners):
                grown = np.empty(2 * len(partners) + high - low, np.int32)
                grown[:count] = partners[:count]
                partners = grown
            # Unsigned numbers need no test for counting from the end; the first loop compiles to vector
            # instructions, and the second writes always and counts what it keeps: no branch to mispredict.
            start, n = np.uint64(low), np.uint64(max(high - low, 0))
            for k in range(n):
                dx, dy, dz = xs[start + k] - x, ys[start + k] - y, zs[start + k] - z
                is_near[k] = dx * dx + dy * dy + dz * dz <= squared_radius
            for k in range(n):
                partners[count] = start + k
                count += np.uint64(is_near[k])
        indptr[i + 1] = count
    return indptr, partners[:count]


@njit(cache=True)
def mirror_pairs(
    indptr: NDArray[np.int64], partners: NDArray[np.int32], order: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Neighbour lists in both directions, in the numbering of `order`, each list sorted."""
    m = len(order)
    starts = np.zeros(m + 1, np.int64)
    for i in range(m):
        starts[order[i] + 1] += indptr[i + 1] - indptr[i]
        for k in range(indptr[i], indptr[i + 1]):
            starts[order[partners[k]] + 1] += 1
    for i in range(m):
        starts[i + 1] += starts[i]
    unsorted = np.empty(starts[m], np.int32)
    end = starts[:-1].copy()
    for i in range(m):
        a = order[i]
        for k in range(indptr[i], indptr[i + 1]):
            b = order[partners[k]]
            unsorted[end[a]] = b
            unsorted[end[b]] = a
            end[a] += 1
            end[b] += 1
    # The relation is symmetric: handing each point, in rising order, to its neighbours sorts every list.
    neighbours = np.empty_like(unsorted)
    end[:] = starts[:-1]
    for a in range(m):
        for k in range(starts[a], starts[a + 1]):
            b = unsorted[k]
            neighbours[end[b]] = a
            end[b] += 1
    return starts, neighbours
