"""Kernels that measure how high points are above the planes that objects stand on."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.depth_noise import depth_noise
from shapeconcepts.kernels import kernel


@kernel
def heights_above(
    points: NDArray[np.float64],
    viewpoint: NDArray[np.float64],
    planes: NDArray[np.float64],
    outlines: NDArray[np.float64],
    starts: NDArray[np.int64],
    bends: NDArray[np.float64],
    margin: float,
    beyond: float,
    noise: float,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int8]]:
    """Height of each point above the highest plane that it is over.

    Parameters
    ----------
    points : (h, w, 3) float64
        NaN where nothing was measured.
    viewpoint : (3,) float64
    planes : (k, 12) float64
        Point, normal and two axes of each plane, the highest first.
    outlines : (s, 3) float64
        Sides of the outlines of all planes, see `SupportingPlane`.
    starts : (k + 1,) int64
        Where those of each plane begin.
    bends : (k, 6) float64
        Height of each surface above its plane: coefficients of 1, u, v, uu, uv, vv along the axes.
    margin : float
        Metres by which a point may be outside of an outline.
    beyond : float
        Metres outside of an outline up to which a plane may go on.
    noise : float
        In parts of `depth_noise`.

    Returns
    -------
    heights : (h, w) float32
        Metres; NaN where nothing was measured or no plane is below.
    noises : (h, w) float32
        Standard deviation of a height, metres; of the depth where no plane is below.
    numbers : (h, w) int8
        Of the plane, -1 for none, -2 for what may be a plane beyond its outline.
    """
    height, width = points.shape[:2]
    heights = np.full((height, width), np.nan, np.float32)
    noises = np.zeros((height, width), np.float32)
    numbers = np.full((height, width), -1, np.int8)
    for i in range(height):
        for j in range(width):
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            if math.isnan(x):
                continue
            sx, sy, sz = x - viewpoint[0], y - viewpoint[1], z - viewpoint[2]
            distance = math.sqrt(sx * sx + sy * sy + sz * sz)
            sigma = noise * depth_noise(distance)
            noises[i, j] = sigma
            for k in range(len(planes)):
                p = planes[k]
                dx, dy, dz = x - p[0], y - p[1], z - p[2]
                above = dx * p[3] + dy * p[4] + dz * p[5]
                across = abs(sx * p[3] + sy * p[4] + sz * p[5]) / distance
                if above < -(4.0 * sigma * across + 0.005):
                    continue
                u = dx * p[6] + dy * p[7] + dz * p[8]
                v = dx * p[9] + dy * p[10] + dz * p[11]
                outside = -math.inf
                for side in range(starts[k], starts[k + 1]):
                    outside = max(outside, outlines[side, 0] * u + outlines[side, 1] * v + outlines[side, 2])
                    if outside > beyond:
                        break
                if outside > margin:
                    if outside <= beyond and above < 3.0 * sigma * across + 0.005:
                        numbers[i, j] = -2
                    continue
                b = bends[k]
                bend = b[0] + b[1] * u + b[2] * v + b[3] * u * u + b[4] * u * v + b[5] * v * v
                heights[i, j] = above - bend
                noises[i, j] = sigma * max(across, 0.2)
                numbers[i, j] = k
                break
    return heights, noises, numbers


@kernel
def window_means(
    values: NDArray[np.float32], limits: NDArray[np.float32], radius: int
) -> NDArray[np.float32]:
    """Means over square windows, of values that are cut to +-limits.

    Parameters
    ----------
    values : (h, w) float32
        NaN does not count.
    limits : (h, w) float32
    radius : int
        Pixels; a window is 2 radius + 1 wide.

    Returns
    -------
    (h, w) float32
        NaN where the value is.
    """
    height, width = values.shape
    sums = np.zeros((height, width), np.float32)
    counts = np.zeros((height, width), np.float32)
    cut = np.zeros(width, np.float32)
    there = np.zeros(width, np.float32)
    for i in range(height):
        for j in range(width):
            value = values[i, j]
            is_there = not math.isnan(value)
            there[j] = 1.0 if is_there else 0.0
            limit = limits[i, j]
            cut[j] = min(max(value, -limit), limit) if is_there else 0.0
        for j in range(width):
            total, count = np.float32(0.0), np.float32(0.0)
            for k in range(max(j - radius, 0), min(j + radius + 1, width)):
                total += cut[k]
                count += there[k]
            for row in range(max(i - radius, 0), min(i + radius + 1, height)):
                sums[row, j] += total
                counts[row, j] += count
    means = np.full((height, width), np.nan, np.float32)
    for i in range(height):
        for j in range(width):
            if not math.isnan(values[i, j]):
                means[i, j] = sums[i, j] / counts[i, j]
    return means


@kernel
def in_lines(
    smooth: NDArray[np.float32],
    low: NDArray[np.float32],
    offsets: NDArray[np.int64],
    least: float,
    least_mean: float,
    most: float,
    tall: float,
) -> NDArray[np.bool_]:
    """Points from which a line of low ones goes on, (h, w) bool.

    Parameters
    ----------
    smooth : (h, w) float32
        Mean heights, metres.
    low : (h, w) float32
        Unit in which they are measured here, metres.
    offsets : (d, k, 2) int64
        Rows and columns to the places of a line in each direction, the first of them (0, 0).
    least : float
        Height of the point.
    least_mean : float
        Mean height along the line.
    most : float
        Height that is taken for all that is higher.
    tall : float
        Metres; what is higher is not on a line.
    """
    height, width = smooth.shape
    n_directions, n_places = offsets.shape[:2]
    found = np.zeros((height, width), np.bool_)
    needed = least_mean * n_places
    for i in range(height):
        for j in range(width):
            if not (smooth[i, j] > least * low[i, j]):
                continue
            for direction in range(n_directions):
                total = 0.0
                for place in range(n_places):
                    row, column = i + offsets[direction, place, 0], j + offsets[direction, place, 1]
                    if 0 <= row < height and 0 <= column < width and smooth[row, column] < tall:
                        total += min(smooth[row, column] / low[row, column], most)
                    if total + most * (n_places - 1 - place) < needed:
                        break
                if total >= needed:
                    found[i, j] = True
                    break
    return found


@kernel
def block_sums(
    values: NDArray[np.float32], counts: NDArray[np.bool_], size: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums of the values that count in square blocks of so many pixels, and how many they are."""
    height, width = values.shape
    rows, columns = -(-height // size), -(-width // size)
    sums, numbers = np.zeros((rows, columns)), np.zeros((rows, columns))
    for i in range(height):
        for j in range(width):
            if counts[i, j]:
                sums[i // size, j // size] += values[i, j]
                numbers[i // size, j // size] += 1.0
    return sums, numbers
