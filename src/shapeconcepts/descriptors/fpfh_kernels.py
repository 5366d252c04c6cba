"""Kernels of Fast Point Feature Histograms, over points sorted by grid cell.

All points of a cell have the same candidates for neighbours. Once these are copied together, each point runs
over all of them, the ones beyond the radius included, in loops without branches or jumps in memory: that is
faster than lists of the neighbours alone. Such loops compile to vector instructions, which take twice as many
numbers in single as in double precision.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

N_BINS = 11
CENTRE = N_BINS // 2

_ZERO, _ONE, _TWO = np.float32(0.0), np.float32(1.0), np.float32(2.0)
# A connection this close to the normal (sine below 1e-6) spans no plane with it.
_PARALLEL = np.float32(1e-12)
_NOT_COUNTED = np.float32(-9.0)


def _inner_borders() -> NDArray[np.float32]:
    """Borders between the bins of `pair_features`, (3, 10)."""
    borders = np.arange(2 - N_BINS, N_BINS, 2) / N_BINS
    sines, cosines = np.sin(np.pi * borders), np.cos(np.pi * borders)
    turns = sines / (np.abs(sines) + np.abs(cosines))
    turns = np.where(cosines < 0.0, 2.0 * np.sign(sines) - turns, turns)
    squares = borders * np.abs(borders)
    return np.stack([turns, squares, squares]).astype(np.float32)


_BORDERS = _inner_borders()


@njit(cache=True, error_model="numpy")
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


@njit(cache=True, error_model="numpy")
def pair_features(
    n: int,
    x: np.float32,
    y: np.float32,
    z: np.float32,
    nx: np.float32,
    ny: np.float32,
    nz: np.float32,
    nearby: NDArray[np.float32],
    features: NDArray[np.float32],
) -> None:
    """Features of the pairs of one point and the points around it.

    Parameters
    ----------
    n : int
        Number of points around, the point itself among them; the arrays are buffers with at least as many
        columns.
    x, y, z, nx, ny, nz : float32
        The point and its normal.
    nearby : (6, >= n) float32
        The points around and their normals.
    features : (3, >= n) float32, output
        In place of theta, alpha and phi, numbers that rise with them and are quicker to compute: no angle is
        needed to sort one into a bin. -9 for points beyond distance 1.
    """
    for k in range(n):
        dx, dy, dz = nearby[0, k] - x, nearby[1, k] - y, nearby[2, k] - z
        mx, my, mz = nearby[3, k], nearby[4, k], nearby[5, k]
        squared_distance = dx * dx + dy * dy + dz * dz
        near = nx * dx + ny * dy + nz * dz
        far = mx * dx + my * dy + mz * dz
        cosine = nx * mx + ny * my + nz * mz
        # The source of the Darboux frame is the point whose normal is closer to the connection; where both
        # are equally close, each is its own.
        swapped = abs(near) < abs(far)
        along = -far if swapped else near
        other = -near if swapped else far
        sx, sy, sz = mx if swapped else nx, my if swapped else ny, mz if swapped else nz
        ax, ay, az = dy * sz - dz * sy, dz * sx - dx * sz, dx * sy - dy * sx
        squared_across = ax * ax + ay * ay + az * az
        triple = (dy * nz - dz * ny) * mx + (dz * nx - dx * nz) * my + (dx * ny - dy * nx) * mz
        flat = squared_across <= _PARALLEL * squared_distance
        turn = _ZERO if flat else other - cosine * along
        level = _ONE if flat else cosine * math.sqrt(squared_across)
        along = _ZERO if flat else along
        triple = _ZERO if flat else triple
        squared_across = _ONE if flat else squared_across
        bounded = _ONE if flat else squared_distance
        # Goes around from -2 to 2 like the angle from -pi to pi.
        size = abs(turn) + abs(level)
        theta = turn / (_ONE if size <= _ZERO else size)
        theta = theta if level >= _ZERO else (_TWO - theta if turn > _ZERO else -_TWO - theta)
        beyond = squared_distance > _ONE
        features[0, k] = _NOT_COUNTED if beyond else theta
        features[1, k] = _NOT_COUNTED if beyond else triple * abs(triple) / squared_across
        features[2, k] = _NOT_COUNTED if beyond else along * abs(along) / bounded


@njit(cache=True, error_model="numpy")
def point_histogram(
    n: int,
    features: NDArray[np.float32],
    angle: int,
    borders: NDArray[np.float32],
    histograms: NDArray[np.float64],
    row: int,
) -> None:
    """Write the histogram of one of the features into a row, at its columns; it sums to 100.

    The point itself, which counts as flat, is left out.
    """
    beyond = _NOT_COUNTED
    b0, b1, b2, b3, b4 = (
        borders[angle, 0],
        borders[angle, 1],
        borders[angle, 2],
        borders[angle, 3],
        borders[angle, 4],
    )
    b5, b6, b7, b8, b9 = (
        borders[angle, 5],
        borders[angle, 6],
        borders[angle, 7],
        borders[angle, 8],
        borders[angle, 9],
    )
    total = n0 = n1 = n2 = n3 = n4 = n5 = n6 = n7 = n8 = n9 = np.int32(0)
    # Counts of what lies above each border need no jumps in memory, unlike one count for each bin. Sums that
    # stay 32 bits wide, like the features, compile to vector instructions.
    for k in range(n):
        value = features[angle, k]
        total = np.int32(total + (value > beyond))
        n0, n1 = np.int32(n0 + (value > b0)), np.int32(n1 + (value > b1))
        n2, n3 = np.int32(n2 + (value > b2)), np.int32(n3 + (value > b3))
        n4, n5 = np.int32(n4 + (value > b4)), np.int32(n5 + (value > b5))
        n6, n7 = np.int32(n6 + (value > b6)), np.int32(n7 + (value > b7))
        n8, n9 = np.int32(n8 + (value > b8)), np.int32(n9 + (value > b9))
    scale = 100.0 / (total - 1) if total > 1 else 0.0
    column = N_BINS * angle
    histograms[row, column] = scale * (total - n0)
    histograms[row, column + 1] = scale * (n0 - n1)
    histograms[row, column + 2] = scale * (n1 - n2)
    histograms[row, column + 3] = scale * (n2 - n3)
    histograms[row, column + 4] = scale * (n3 - n4)
    histograms[row, column + 5] = scale * (n4 - n5 - 1)
    histograms[row, column + 6] = scale * (n5 - n6)
    histograms[row, column + 7] = scale * (n6 - n7)
    histograms[row, column + 8] = scale * (n7 - n8)
    histograms[row, column + 9] = scale * (n8 - n9)
    histograms[row, column + 10] = scale * n9


@njit(cache=True, error_model="numpy")
def pair_weights(
    n: int,
    x: np.float32,
    y: np.float32,
    z: np.float32,
    nearby: NDArray[np.float32],
    weights: NDArray[np.float32],
) -> None:
    """Write 1 / squared distance to the points around; 0 for coincident ones and beyond distance 1."""
    for k in range(n):
        dx, dy, dz = nearby[0, k] - x, nearby[1, k] - y, nearby[2, k] - z
        squared_distance = dx * dx + dy * dy + dz * dz
        ignored = (squared_distance > _ONE) | (squared_distance <= _ZERO)
        weights[k] = _ZERO if ignored else _ONE / (_ONE if ignored else squared_distance)


@njit(cache=True, error_model="numpy")
def sum_of(n: int, values: NDArray[np.float32]) -> float:
    """Sum of the first n values, n a multiple of 8, in an order that compiles to vector instructions."""
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = _ZERO
    one = np.uint64(1)
    for k in range(np.uint64(0), np.uint64(n), np.uint64(8)):
        s0 += values[k]
        s1 += values[k + one]
        s2 += values[k + np.uint64(2)]
        s3 += values[k + np.uint64(3)]
        s4 += values[k + np.uint64(4)]
        s5 += values[k + np.uint64(5)]
        s6 += values[k + np.uint64(6)]
        s7 += values[k + np.uint64(7)]
    return float(((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7)))


@njit(cache=True, error_model="numpy")
def simplified_histograms(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Simplified Point Feature Histograms (Rusu 2009, section III).

    Parameters
    ----------
    surface : (6, m) float64
        Points and normals in the order of a `shapeconcepts.neighbours.CellGrid`.
    cells, indptr, candidates
        Of the grid.
    radius : float

    Returns
    -------
    histograms : (m, 33) float64
        Histograms over a point's neighbours of theta, alpha and phi, 11 bins each, 100 for each angle.
    weight_sums : (m,) float64
        Sum of squared radius / squared distance over a point's neighbours, coincident ones left out.
    """
    m = surface.shape[1]
    histograms = np.empty((m, 3 * N_BINS))
    weight_sums = np.empty(m)
    nearby = np.empty((6, m + 8), np.float32)
    features = np.empty((3, m + 8), np.float32)
    weights = np.empty(m + 8, np.float32)
    borders = _BORDERS.copy()
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            nx, ny, nz = np.float32(surface[3, i]), np.float32(surface[4, i]), np.float32(surface[5, i])
            pair_features(n, x, y, z, nx, ny, nz, nearby, features)
            for angle in range(3):
                point_histogram(n, features, angle, borders, histograms, i)
            pair_weights(n, x, y, z, nearby, weights)
            weight_sums[i] = sum_of(n, weights)
    return histograms, weight_sums


@njit(cache=True, error_model="numpy")
def neighbour_means(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
    histograms: NDArray[np.float64],
    weight_sums: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Mean histogram of each point's neighbours, weighted by 1 / squared distance; zero without any.

    The parameters are those and the results of `simplified_histograms`.
    """
    m = surface.shape[1]
    means = np.zeros_like(histograms)
    nearby = np.empty((6, m + 8), np.float32)
    weights = np.empty(m + 8, np.float32)
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            pair_weights(n, x, y, z, nearby, weights)
            for k in range(n):
                if weights[k] > _ZERO:
                    weight = weights[k] / weight_sums[i]
                    for b in range(histograms.shape[1]):
                        means[i, b] += weight * histograms[near_cell[k], b]
    return means


@njit(cache=True, error_model="numpy")
def segment_sums(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
    histograms: NDArray[np.float64],
    n_segments: int,
) -> NDArray[np.float64]:
    """Sum the FPFH of each segment's points: own histogram plus weighted mean of the neighbours' histograms.

    The sum is linear in the histograms, so it takes one number per point and segment, its share, and not one
    histogram per pair of neighbours.

    Parameters
    ----------
    surface : (5, m) float64
        Points, segment labels, and 1 / weight sum (0 without weights) in the order of the grid.
    cells, indptr, candidates, radius, histograms
        As of `simplified_histograms`.
    n_segments : int

    Returns
    -------
    (n_segments, 33) float64
    """
    m = surface.shape[1]
    n_bins = histograms.shape[1]
    sums = np.zeros((n_segments, n_bins))
    nearby = np.empty((5, m + 8), np.float32)
    weights = np.empty(m + 8, np.float32)
    members = np.empty(m + 8, np.float32)
    is_near = np.empty(n_segments, np.bool_)
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        is_near[:] = False
        for k in range(n):
            if nearby[3, k] >= _ZERO:
                is_near[np.int64(nearby[3, k])] = True
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            pair_weights(n, x, y, z, nearby, weights)
            for segment in range(n_segments):
                if is_near[segment]:
                    label = np.float32(segment)
                    for k in range(n):
                        members[k] = weights[k] * nearby[4, k] if nearby[3, k] == label else _ZERO
                    share = sum_of(n, members) + (surface[3, i] == segment)
                    for b in range(n_bins):
                        sums[segment, b] += share * histograms[i, b]
    return sums
