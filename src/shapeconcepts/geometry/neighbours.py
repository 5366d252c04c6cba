"""Radius neighbours of points that lie about one per voxel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbour_kernels import (
    cell_candidates,
    cells_of,
    ends_of_runs,
    keys_of,
    neighbour_lists,
    renumber,
)
from shapeconcepts.geometry.points import checked_points


class Neighbours(NamedTuple):
    """Neighbour lists as in a CSR matrix.

    Attributes
    ----------
    indptr : (m + 1,) int64
        Where each point's list starts and ends.
    indices : (indptr[m],) int32
        Neighbours of point i, rising: ``indices[indptr[i]:indptr[i + 1]]``. The point itself is not among
        them.
    """

    indptr: NDArray[np.int64]
    indices: NDArray[np.int32]


class CellGrid(NamedTuple):
    """Points sorted by the cells of a regular grid.

    Attributes
    ----------
    order : (m,) int64
        The sorted points are ``points[order]``; neighbours in space stay close in memory.
    coordinates : (3, m) float64
        The sorted points.
    cells : (c + 1,) int64
        Points of each occupied cell: from ``cells[i]`` to ``cells[i + 1]`` in the sorted order.
    indptr : (c + 1,) int64
    candidates : (indptr[c],) uint32
        The points, rising, among which are all neighbours of the points of cell i:
        ``candidates[indptr[i]:indptr[i + 1]]``.
    """

    order: NDArray[np.int64]
    coordinates: NDArray[np.float64]
    cells: NDArray[np.int64]
    indptr: NDArray[np.int64]
    candidates: NDArray[np.uint32]


def radius_neighbours(points: NDArray[np.float64], radius: float) -> Neighbours:
    """Find all points within a radius of each point.

    Time and memory are linear in the number of points (at a bounded density, as on a voxel grid), however far
    the points lie apart.

    Parameters
    ----------
    points : (m, 3) float64
        Finite coordinates. Duplicates are neighbours of each other.
    radius : float
        Largest distance, inclusive, in the unit of the points.

    Returns
    -------
    Neighbours
        The neighbours of each point without the point itself, in rising order.

    Raises
    ------
    ValueError
        If `points` has another shape or is not finite, or `radius` is not a positive number.
    """
    grid = cell_grid(points, radius)
    return Neighbours(*renumber(*neighbour_lists(*grid[1:], float(radius)), grid.order))


def cell_grid(points: NDArray[np.float64], radius: float, reach: int = 1) -> CellGrid:
    """Sort points by the cells of a grid, and collect what lies around each cell.

    Neighbours are at most `reach` cells apart: the more, the smaller are the cells, and the fewer candidates
    are no neighbours. The other parameters and errors are those of `radius_neighbours`.
    """
    points = checked_points(points)
    if not (np.isfinite(radius) and radius > 0):
        raise ValueError(f"radius must be a positive number, got {radius!r}")
    coordinates = np.ascontiguousarray(points.T)
    keys, strides = _cell_keys(coordinates, radius / reach, reach)
    order = sorting_order(keys)
    coordinates, keys = np.take(coordinates, order, axis=1), keys[order]
    cells = ends_of_runs(keys)
    return CellGrid(
        order, coordinates, cells, *cell_candidates(coordinates, keys, cells, strides, reach, float(radius))
    )


def sorting_order(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """What ``np.argsort(keys, kind="stable")`` returns, several times as fast for keys of grid cells.

    Parameters
    ----------
    keys : (m,) int64
        Not negative.
    """
    bits = len(keys).bit_length()
    if len(keys) == 0 or int(keys.max()) >= 1 << (62 - bits):
        return np.argsort(keys, kind="stable")
    # Numbers sort faster than their order does, so each key carries its place along.
    return np.sort(keys << bits | np.arange(len(keys))) & ((1 << bits) - 1)


def _cell_keys(
    coordinates: NDArray[np.float64], width: float, reach: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Number the cells so that those up to `reach` apart, and no others, differ by sums of strides."""
    # A hair wider than asked for, or rounding could put two neighbours a cell too far apart.
    cells = cells_of(coordinates, width * (1 + 1e-6))
    if cells.size and cells.max() > 2**20 - 2 - reach:
        cells = np.stack([_close_gaps(axis, reach) for axis in cells])
    return keys_of(cells, reach)


def _close_gaps(cells: NDArray[np.float64], reach: int) -> NDArray[np.float64]:
    """Shrink runs of empty cells to `reach`, so that a few far points do not need huge numbers."""
    occupied, inverse = np.unique(cells, return_inverse=True)
    return np.concatenate([[0.0], np.cumsum(np.minimum(np.diff(occupied), reach + 1.0))])[inverse]
