"""Kernels of the radius search over points sorted by grid cell.

All points of a cell have the same candidates for neighbours. Once these are copied together, each point runs
over them without jumps in memory.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def cells_of(coordinates: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Cell of each point along each axis, (d, m), counted in whole numbers from the lowest point."""
    cells = np.empty_like(coordinates)
    for axis in range(len(coordinates)):
        lowest = np.inf
        for i in range(coordinates.shape[1]):
            lowest = min(lowest, coordinates[axis, i])
        for i in range(coordinates.shape[1]):
            cells[axis, i] = np.floor((coordinates[axis, i] - lowest) / width)
    return cells


@kernel
def keys_of(cells: NDArray[np.float64], reach: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Number of each cell, ``strides @ cell``, and the strides.

    Parameters
    ----------
    cells : (3, m) float64
        Whole numbers, not negative.
    reach : int
        Empty cells between lines, that keep the end of one from touching the start of the next.
    """
    size = np.ones(3, np.int64)
    for axis in range(3):
        for i in range(cells.shape[1]):
            size[axis] = max(size[axis], np.int64(cells[axis, i]) + 1)
    strides = np.array([(size[1] + reach) * (size[2] + reach), size[2] + reach, 1])
    keys = np.empty(cells.shape[1], np.int64)
    for i in range(cells.shape[1]):
        keys[i] = (
            np.int64(cells[0, i]) * strides[0] + np.int64(cells[1, i]) * strides[1] + np.int64(cells[2, i])
        )
    return keys, strides


@kernel
def ends_of_runs(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where runs of equal numbers start and end: run i is ``keys[ends[i]:ends[i + 1]]``, (runs + 1,)."""
    ends = np.zeros(len(keys) + 1, np.int64)
    n_runs = 0
    for i in range(len(keys)):
        if i + 1 == len(keys) or keys[i + 1] != keys[i]:
            n_runs += 1
            ends[n_runs] = i + 1
    return ends[: n_runs + 1]


@kernel
def cell_candidates(
    coordinates: NDArray[np.float64],
    keys: NDArray[np.int64],
    cells: NDArray[np.int64],
    strides: NDArray[np.int64],
    reach: int,
    radius: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint32]]:
    """For each cell, the points within a radius of the box around its points.

    Parameters
    ----------
    coordinates : (3, m) float64
        Points in the order of rising `keys`.
    keys : (m,) int64
        Cell of each point, ``strides @ cell``.
    cells : (c + 1,) int64
        Points of each cell: from ``cells[i]`` to ``cells[i + 1]``.
    strides : (3,) int64
        Weights of a cell's x, y and z in its key; z has weight 1, so a line of cells along z has adjacent
        keys.
    reach : int
        Number of cells, along each axis, that are at least `radius` wide together.
    radius : float
        Largest distance, inclusive.

    Returns
    -------
    indptr : (c + 1,) int64
    candidates : (indptr[c],) uint32
        Candidates for neighbours of a cell's points, rising: ``candidates[indptr[i] : indptr[i + 1]]``.
    """
    m = len(keys)
    n_cells = len(cells) - 1
    cell_keys = keys[cells[:-1]]
    lines = np.zeros((2 * reach + 1, 2 * reach + 1), np.int64)
    indptr = np.zeros(len(cells), np.int64)
    candidates = np.empty(64 * m, np.uint32)
    is_near = np.empty(m, np.uint8)
    squared_radius = radius * radius * (1.0 + 1e-9)  # a hair more, against rounding
    count = np.uint64(0)
    for cell in range(n_cells):
        start = cells[cell]
        x, y, z = coordinates[0, start], coordinates[1, start], coordinates[2, start]
        low_x = high_x = low_y = high_y = low_z = high_z = 0.0
        for i in range(start + 1, cells[cell + 1]):
            low_x, high_x = min(low_x, coordinates[0, i] - x), max(high_x, coordinates[0, i] - x)
            low_y, high_y = min(low_y, coordinates[1, i] - y), max(high_y, coordinates[1, i] - y)
            low_z, high_z = min(low_z, coordinates[2, i] - z), max(high_z, coordinates[2, i] - z)
        for across_x in range(2 * reach + 1):
            for across_y in range(2 * reach + 1):
                # Keys rise from cell to cell, so the start of the range only ever moves forward.
                first_key = cell_keys[cell] - reach
                first_key += (across_x - reach) * strides[0] + (across_y - reach) * strides[1]
                low_cell = lines[across_x, across_y]
                while low_cell < n_cells and cell_keys[low_cell] < first_key:
                    low_cell += 1
                lines[across_x, across_y] = low_cell
                high_cell = low_cell
                while high_cell < n_cells and cell_keys[high_cell] <= first_key + 2 * reach:
                    high_cell += 1
                low, high = cells[low_cell], cells[high_cell]
                if count + high - low > len(candidates):
                    grown = np.empty(2 * len(candidates) + high - low, np.uint32)
                    for k in range(count):
                        grown[k] = candidates[k]
                    candidates = grown
                # Unsigned numbers need no test for counting from the end. Written always and kept by the
                # count: no branch to mispredict.
                first, n = np.uint64(low), high - low
                for k in range(n):
                    dx = coordinates[0, first + np.uint64(k)] - x
                    dy = coordinates[1, first + np.uint64(k)] - y
                    dz = coordinates[2, first + np.uint64(k)] - z
                    dx = max(low_x - dx, dx - high_x, 0.0)
                    dy = max(low_y - dy, dy - high_y, 0.0)
                    dz = max(low_z - dz, dz - high_z, 0.0)
                    is_near[k] = dx * dx + dy * dy + dz * dz <= squared_radius
                for k in range(np.uint64(n)):
                    candidates[count] = first + k
                    count += np.uint64(is_near[k])
        indptr[cell + 1] = count
    return indptr, candidates[:count]


@kernel
def neighbour_lists(
    coordinates: NDArray[np.float64],
    cells: NDArray[np.int64],
    cell_indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """All other points within a radius of each point, in rising order.

    Parameters
    ----------
    coordinates, radius
        As of `cell_candidates`.
    cells, cell_indptr, candidates
        What it returns.

    Returns
    -------
    indptr : (m + 1,) int64
    indices : (indptr[m],) int32
    """
    m = coordinates.shape[1]
    nearby = np.empty((3, m))
    is_near = np.empty(m, np.uint8)
    indptr = np.zeros(m + 1, np.int64)
    indices = np.empty(48 * m + 1, np.int32)
    count = np.uint64(0)
    for cell in range(len(cells) - 1):
        first = np.uint64(cell_indptr[cell])
        n = cell_indptr[cell + 1] - cell_indptr[cell]
        for k in range(np.uint64(n)):
            j = candidates[first + k]
            nearby[0, k], nearby[1, k], nearby[2, k] = coordinates[0, j], coordinates[1, j], coordinates[2, j]
        most = n * (cells[cell + 1] - cells[cell])
        if count + most >= len(indices):
            grown = np.empty(2 * len(indices) + most, np.int32)
            for k in range(count):
                grown[k] = indices[k]
            indices = grown
        for i in range(cells[cell], cells[cell + 1]):
            x, y, z = coordinates[0, i], coordinates[1, i], coordinates[2, i]
            for k in range(n):  # compiles to vector instructions
                dx, dy, dz = nearby[0, k] - x, nearby[1, k] - y, nearby[2, k] - z
                is_near[k] = dx * dx + dy * dy + dz * dz <= radius * radius
            for k in range(np.uint64(n)):
                j = candidates[first + k]
                indices[count] = j
                count += np.uint64(is_near[k] & (j != i))
            indptr[i + 1] = count
    return indptr, indices[:count]


@kernel
def renumber(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], order: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Neighbour lists in the numbering of `order`, each list sorted.

    Lists that are not mutual are turned around: whoever names a point is in its list.
    """
    m = len(order)
    number = order.astype(np.uint32)  # unsigned: no test for counting from the end
    place = np.empty(m, np.int64)
    lengths = np.empty(m, np.int64)
    for i in range(m):
        place[order[i]] = i
        lengths[order[i]] = indptr[i + 1] - indptr[i]
    starts, renumbered, is_mutual = _handed_out(indptr, indices, number, place, lengths)
    if not is_mutual:
        lengths[:] = 0
        for k in range(len(indices)):
            lengths[number[indices[k]]] += 1
        starts, renumbered, _ = _handed_out(indptr, indices, number, place, lengths)
    return starts, renumbered


@kernel
def _handed_out(
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    number: NDArray[np.uint32],
    place: NDArray[np.int64],
    lengths: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.int32], bool]:
    """Each point, in rising order, handed to its neighbours, which sorts every list; and if all lists fit."""
    m = len(place)
    starts = np.zeros(m + 1, np.int64)
    for a in range(m):
        starts[a + 1] = starts[a] + lengths[a]
    end = starts[:-1].astype(np.uint64)
    limit = starts[1:].astype(np.uint64)
    renumbered = np.empty_like(indices)
    for a in range(m):
        for k in range(np.uint64(indptr[place[a]]), np.uint64(indptr[place[a] + 1])):
            b = number[np.uint32(indices[k])]
            if end[b] == limit[b]:
                return starts, renumbered, False
            renumbered[end[b]] = a
            end[b] += np.uint64(1)
    return starts, renumbered, True


@kernel
def restrict(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], kept: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Neighbour lists of the kept points among each other, numbered without gaps."""
    number = np.cumsum(kept) - 1
    restricted_indptr = np.zeros(number[-1] + 2, np.int64)
    restricted = np.empty(len(indices) + 1, np.int32)
    count = np.uint64(0)
    for i in range(len(kept)):
        if kept[i]:
            for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
                j = np.uint32(indices[k])
                restricted[count] = number[j]
                count += np.uint64(kept[j])
            restricted_indptr[number[i] + 1] = count
    return restricted_indptr, restricted[:count]


@kernel
def copy_nearby(
    surface: NDArray[np.float64],
    candidates: NDArray[np.uint32],
    origin: int,
    radius: float,
    nearby: NDArray[np.float32],
) -> int:
    """Copy the points around a cell together.

    Parameters
    ----------
    surface : (d, m) float64
        Coordinates of all points, and what else belongs to them.
    candidates : (k,) uint32
    origin : int
        The point that coordinates are relative to.
    nearby : (d, >= k + 7) float32, output
        Columns of `surface`, with coordinates in radii.

    Returns
    -------
    int
        Number of columns, a multiple of 8: the last ones are points far away, so that no loop over them has a
        rest besides vectors.
    """
    n = len(candidates)
    full = n + -n % 8
    for row in range(len(surface)):
        offset = surface[row, origin] if row < 3 else 0.0
        scale = 1.0 / radius if row < 3 else 1.0
        for k in range(np.uint64(n)):
            nearby[row, k] = (surface[row, candidates[k]] - offset) * scale
        nearby[row, n:full] = 1e9 if row < 3 else 0.0
    return full
