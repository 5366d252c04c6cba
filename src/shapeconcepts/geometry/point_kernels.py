"""Kernels over the points of a scan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def centroid(points: NDArray[np.float64]) -> tuple[float, float, float]:
    """Mean of points, (n, 3), added up one after the other."""
    x = y = z = 0.0
    for i in range(len(points)):
        x += points[i, 0]
        y += points[i, 1]
        z += points[i, 2]
    return x / len(points), y / len(points), z / len(points)


@kernel
def centred_rows(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points, (n, 3), relative to their centroid, as (3, n)."""
    x, y, z = centroid(points)
    rows = np.empty((3, len(points)))
    for i in range(len(points)):
        rows[0, i], rows[1, i], rows[2, i] = points[i, 0] - x, points[i, 1] - y, points[i, 2] - z
    return rows


@kernel
def first_of_equals(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether no earlier point is exactly equal, (n,) bool, of finite points (n, 3)."""
    n = len(points)
    size = 16
    while size < 2 * n:
        size *= 2
    table = np.full(size, -1, np.int64)
    # 0.0 and -0.0 are equal, but for their bits.
    bits = (points + 0.0).view(np.uint64)
    first = np.ones(n, np.bool_)
    for i in range(n):
        place = bits[i, 0] * np.uint64(0x9E3779B97F4A7C15)
        place = (place ^ (place >> np.uint64(29)) ^ bits[i, 1]) * np.uint64(0xBF58476D1CE4E5B9)
        place = (place ^ (place >> np.uint64(32)) ^ bits[i, 2]) * np.uint64(0x94D049BB133111EB)
        slot = np.int64((place ^ (place >> np.uint64(31))) & np.uint64(size - 1))
        while table[slot] >= 0:
            j = table[slot]
            if bits[i, 0] == bits[j, 0] and bits[i, 1] == bits[j, 1] and bits[i, 2] == bits[j, 2]:
                first[i] = False
                break
            slot = (slot + 1) & (size - 1)
        if first[i]:
            table[slot] = i
    return first


@kernel
def sorted_by_cell(
    points: NDArray[np.float64],
    origin: tuple[float, float, float],
    keys: NDArray[np.int64],
    order: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int32]]:
    """Points, (n, 3), relative to an origin, cell after cell.

    Parameters
    ----------
    keys : (n,) int64
        Cell of each point.
    order : (n,) int64
        The points in the order of rising keys.

    Returns
    -------
    offsets : (n, 3) float64
    starts : (c,) int64
        Where the points of each cell start.
    cell_of_point : (n,) int32
    """
    n = len(points)
    x, y, z = origin
    offsets = np.empty((n, 3))
    starts = np.empty(n, np.int64)
    cell_of_point = np.empty(n, np.int32)
    n_cells = 0
    for place in range(n):
        i = order[place]
        if place == 0 or keys[i] != keys[order[place - 1]]:
            starts[n_cells] = place
            n_cells += 1
        cell_of_point[i] = n_cells - 1
        offsets[place, 0], offsets[place, 1] = points[i, 0] - x, points[i, 1] - y
        offsets[place, 2] = points[i, 2] - z
    return offsets, starts[:n_cells], cell_of_point
