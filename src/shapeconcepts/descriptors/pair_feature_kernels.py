"""Kernels of the features of pairs of points under FPFH, in loops that compile to vector instructions."""

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


BORDERS = _inner_borders()


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
