"""Kernels of the features of pairs of points under FPFH, in loops that compile to vector instructions."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

N_BINS = 11
CENTRE = N_BINS // 2

_ZERO, _ONE = np.float32(0.0), np.float32(1.0)
# A connection this close to the normal (sine below 1e-3) spans no plane with it in single precision.
_PARALLEL = np.float32(1e-6)
# Squared radii: closer than this, distances are the rounding of coordinates.
_COINCIDENT = np.float32(1e-14)
_HALF_BINS, _LAST_BIN = np.float32(N_BINS / 2), np.float32(N_BINS - 1)
_NOT_COUNTED = np.int32(N_BINS)
# Cotangents of the borders of theta's bins on the side of positive angles.
_COT_1, _COT_3, _COT_5, _COT_7, _COT_9 = (
    np.float32(1 / math.tan(odd * math.pi / N_BINS)) for odd in range(1, N_BINS, 2)
)
_MOST_AT_ONCE = 224  # fewer than 8 bits can count, and whole vectors


@kernel(fastmath={"contract"})
def pair_bins(
    n: int,
    x: np.float32,
    y: np.float32,
    z: np.float32,
    nx: np.float32,
    ny: np.float32,
    nz: np.float32,
    nearby: NDArray[np.float32],
    bins: NDArray[np.uint8],
    weights: NDArray[np.float32],
) -> None:
    """Bins of the features of the pairs of one point and the points around it, and the weights of the pairs.

    Parameters
    ----------
    n : int
        Number of points around, the point itself among them; the arrays are buffers with at least as many
        columns.
    x, y, z, nx, ny, nz : float32
        The point and its normal.
    nearby : (6, >= n) float32
        The points around and their normals.
    bins : (3, >= n) uint8, output
        Bins of theta, alpha and phi; 11 for points beyond distance 1.
    weights : (>= n,) float32, output
        As of `pair_weights`.
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
        triple = (dy * nz - dz * ny) * mx + (dz * nx - dx * nz) * my + (dx * ny - dy * nx) * mz
        squared_across = squared_distance - along * along
        coincident = squared_distance <= _COINCIDENT
        flat = coincident | (squared_across <= _PARALLEL * squared_distance)
        across = math.sqrt(squared_across)
        inverse = _ONE / max(squared_distance, _COINCIDENT)
        alpha = _ZERO if flat else triple / across
        phi = _ZERO if flat else along * math.sqrt(inverse)
        turn = _ZERO if flat else other - cosine * along
        level = _ZERO if flat else cosine * across
        # Theta is the angle whose cotangent is level / turn; borders passed on the way from 0 to it are
        # quicker to count than the angle is to compute.
        turned = abs(turn)
        passed = np.int32(turned * _COT_1 > level) + np.int32(turned * _COT_3 > level)
        passed += np.int32(turned * _COT_5 > level) + np.int32(turned * _COT_7 > level)
        passed += np.int32(turned * _COT_9 > level)
        beyond = squared_distance > _ONE
        theta_bin = CENTRE + passed if turn > _ZERO else CENTRE - passed
        alpha_bin = np.int32(min(_LAST_BIN, max(_ZERO, _HALF_BINS + _HALF_BINS * alpha)))
        phi_bin = np.int32(min(_LAST_BIN, max(_ZERO, _HALF_BINS + _HALF_BINS * phi)))
        bins[0, k] = np.uint8(_NOT_COUNTED if beyond else np.int32(theta_bin))
        bins[1, k] = np.uint8(_NOT_COUNTED if beyond else alpha_bin)
        bins[2, k] = np.uint8(_NOT_COUNTED if beyond else phi_bin)
        weights[k] = _ZERO if beyond | coincident else inverse


@kernel
def point_histogram(
    n: int,
    bins: NDArray[np.uint8],
    angle: int,
    histograms: NDArray[np.float64],
    row: int,
) -> None:
    """Write the histogram of one of the angles into a row, at its columns; it sums to 100.

    The point itself, which counts as flat, is left out.
    """
    column = N_BINS * angle
    for b in range(N_BINS):
        histograms[row, column + b] = 0.0
    for start in range(0, n, _MOST_AT_ONCE):
        # A count for each bin needs no jumps in memory, unlike one increment for each point. Sums that stay
        # 8 bits wide compile to vector instructions of as many numbers.
        c0 = c1 = c2 = c3 = c4 = c5 = c6 = c7 = c8 = c9 = c10 = np.uint8(0)
        for k in range(np.uint64(start), np.uint64(min(n, start + _MOST_AT_ONCE))):
            b = bins[angle, k]
            c0, c1, c2 = np.uint8(c0 + (b == 0)), np.uint8(c1 + (b == 1)), np.uint8(c2 + (b == 2))
            c3, c4, c5 = np.uint8(c3 + (b == 3)), np.uint8(c4 + (b == 4)), np.uint8(c5 + (b == 5))
            c6, c7, c8 = np.uint8(c6 + (b == 6)), np.uint8(c7 + (b == 7)), np.uint8(c8 + (b == 8))
            c9, c10 = np.uint8(c9 + (b == 9)), np.uint8(c10 + (b == 10))
        counts = (c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10)
        for b in range(N_BINS):
            histograms[row, column + b] += counts[b]
    histograms[row, column + CENTRE] -= 1.0
    total = 0.0
    for b in range(N_BINS):
        total += histograms[row, column + b]
    scale = 100.0 / total if total > 0.0 else 0.0
    for b in range(N_BINS):
        histograms[row, column + b] *= scale


@kernel(fastmath={"contract"})
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
        ignored = (squared_distance > _ONE) | (squared_distance <= _COINCIDENT)
        weights[k] = _ZERO if ignored else _ONE / (_ONE if ignored else squared_distance)


# The sums may be reordered, for vector instructions: the same order on each run of a machine.
@kernel(fastmath={"reassoc"})
def sum_of(n: int, values: NDArray[np.float32]) -> np.float32:
    """Sum of the first n values."""
    total = _ZERO
    for k in range(n):
        total += values[k]
    return total


@kernel(fastmath={"reassoc"})
def share_of(
    n: int,
    weights: NDArray[np.float32],
    scales: NDArray[np.float32],
    labels: NDArray[np.float32],
    label: np.float32,
) -> np.float32:
    """Sum of the first n weights, each times its scale, where the labels are equal to one."""
    total = _ZERO
    for k in range(n):
        total += weights[k] * scales[k] if labels[k] == label else _ZERO
    return total
