"""Radius neighbours of points that lie about one per voxel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.neighbour_kernels import mirror_pairs, pairs_within


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


class NeighbourPairs(NamedTuple):
    """Every unordered pair of neighbours once, over points sorted by grid cell.

    Attributes
    ----------
    order : (m,) int64
        The sorted points are ``points[order]``; neighbours in space stay close in memory.
    indptr : (m + 1,) int64
    partners : (indptr[m],) int32
        Positions in the sorted order, rising and all larger than i: ``partners[indptr[i]:indptr[i + 1]]`` for
        the point at position i.
    """

    order: NDArray[np.int64]
    indptr: NDArray[np.int64]
    partners: NDArray[np.int32]


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
    pairs = neighbour_pairs(points, radius)
    return Neighbours(*mirror_pairs(pairs.indptr, pairs.partners, pairs.order))


def neighbour_pairs(points: NDArray[np.float64], radius: float) -> NeighbourPairs:
    """Find every unordered pair of points within a radius once, for symmetric computations.

    Parameters and errors are those of `radius_neighbours`.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have shape (m, 3), got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError("points must be finite, got NaN or infinity")
    if not (np.isfinite(radius) and radius > 0):
        raise ValueError(f"radius must be a positive number, got {radius!r}")
    coordinates = np.ascontiguousarray(points.T)
    keys, strides = _cell_keys(coordinates, radius)
    order = np.argsort(keys, kind="stable")
    return NeighbourPairs(
        order, *pairs_within(np.take(coordinates, order, axis=1), keys[order], strides, float(radius))
    )


def _cell_keys(
    coordinates: NDArray[np.float64], radius: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Number the cells of a grid so that neighbouring cells differ by sums of strides, and no others do."""
    if coordinates.shape[1] == 0:
        return np.empty(0, np.int64), np.ones(3, np.int64)
    # A hair wider than the radius, or rounding could put two neighbours two cells apart.
    width = radius * (1 + 1e-6)
    cells = np.floor((coordinates - coordinates.min(axis=1, keepdims=True)) / width)
    if cells.max() > 2**20 - 3:
        cells = np.stack([_close_gaps(axis) for axis in cells])
    # One empty cell between lines keeps the end of one from touching the start of the next.
    size = cells.max(axis=1).astype(np.int64) + 2
    strides = np.array([size[1] * size[2], size[2], 1])
    x, y, z = cells.astype(np.int64)
    return x * strides[0] + y * strides[1] + z, strides


def _close_gaps(cells: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shrink runs of empty cells to a single one, so that a few far points do not need huge numbers."""
    occupied, inverse = np.unique(cells, return_inverse=True)
    return np.concatenate([[0.0], np.cumsum(np.minimum(np.diff(occupied), 2.0))])[inverse]
