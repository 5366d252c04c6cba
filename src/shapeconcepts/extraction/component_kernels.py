"""Kernels that connect pixels where the surface is connected."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.depth_noise import depth_noise
from shapeconcepts.kernels import kernel

# A surface is seen up to about 83 degrees from facing: from one pixel to the next, its distance changes by up
# to so many times the step across.
_STEEPEST = 8.0
_TIMES_NOISE = 3.0
_FEWEST_NEIGHBOURS = 3


@kernel
def distances_and_jumps(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64], pitch: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Distance of each point from the sensor, NaN where there is none, and the change that parts surfaces.

    Both (h, w) float32, metres; `pitch` is the angle between neighbouring pixels.
    """
    height, width = points.shape[:2]
    distances = np.full((height, width), np.nan, np.float32)
    jumps = np.zeros((height, width), np.float32)
    for i in range(height):
        for j in range(width):
            squares = 0.0
            for axis in range(3):
                squares += (points[i, j, axis] - viewpoint[axis]) ** 2
            if math.isnan(squares):
                continue
            distance = math.sqrt(squares)
            distances[i, j] = distance
            jumps[i, j] = _STEEPEST * pitch * distance + _TIMES_NOISE * depth_noise(distance)
    return distances, jumps


@kernel
def flying_pixels(distances: NDArray[np.float32], jumps: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Points between surfaces: fewer than three of the eight around are on the same one, (h, w) bool."""
    height, width = distances.shape
    flying = np.zeros((height, width), np.bool_)
    for i in range(height):
        for j in range(width):
            distance = distances[i, j]
            if math.isnan(distance):
                continue
            count = 0
            for row in range(max(i - 1, 0), min(i + 2, height)):
                for column in range(max(j - 1, 0), min(j + 2, width)):
                    if abs(distances[row, column] - distance) < jumps[i, j]:
                        count += 1
            # The point itself is one.
            flying[i, j] = count - 1 < _FEWEST_NEIGHBOURS
    return flying


@kernel
def connected_components(
    belongs: NDArray[np.bool_], distances: NDArray[np.float32], jumps: NDArray[np.float32]
) -> tuple[NDArray[np.int32], int]:
    """Number of the connected component of each pixel (h, w), -1 for none, and how many there are.

    Pixels that belong are connected to the four beside them where no jump in distance parts them.
    """
    height, width = belongs.shape
    numbers = np.full((height, width), -1, np.int32)
    waiting = np.empty(height * width, np.int64)
    n_components = 0
    for start in range(height * width):
        i, j = start // width, start % width
        if not belongs[i, j] or numbers[i, j] >= 0:
            continue
        numbers[i, j] = n_components
        waiting[0] = start
        first, last = 0, 1
        while first < last:
            i, j = waiting[first] // width, waiting[first] % width
            first += 1
            for step in range(4):
                row, column = i + (step == 0) - (step == 1), j + (step == 2) - (step == 3)
                if not (0 <= row < height and 0 <= column < width):
                    continue
                if not belongs[row, column] or numbers[row, column] >= 0:
                    continue
                if abs(distances[row, column] - distances[i, j]) < jumps[i, j]:
                    numbers[row, column] = n_components
                    waiting[last] = row * width + column
                    last += 1
        n_components += 1
    return numbers, n_components


@kernel
def near_pairs(
    numbers: NDArray[np.int32], n: int, points: NDArray[np.float64], reaches: NDArray[np.float32], radius: int
) -> NDArray[np.int64]:
    """How many pixels of two components are near each other in space, (n, n) int64, symmetric.

    Parameters
    ----------
    numbers : (h, w) int32
        Of components, -1 for none.
    n : int
        How many there are.
    points : (h, w, 3) float64
    reaches : (h, w) float32
        Metres within which is near.
    radius : int
        Pixels that are looked at around each.
    """
    height, width = numbers.shape
    counts = np.zeros((n, n), np.int64)
    for i in range(height):
        for j in range(width):
            own = numbers[i, j]
            if own < 0:
                continue
            for row in range(i, min(i + radius + 1, height)):
                for column in range(max(j - radius, 0), min(j + radius + 1, width)):
                    other = numbers[row, column]
                    if other < 0 or other == own or (row == i and column <= j):
                        continue
                    squares = 0.0
                    for axis in range(3):
                        squares += (points[i, j, axis] - points[row, column, axis]) ** 2
                    if squares < reaches[i, j] ** 2:
                        counts[own, other] += 1
                        counts[other, own] += 1
    return counts


@kernel
def contacts(
    low: NDArray[np.int32],
    n_low: int,
    high: NDArray[np.int32],
    n_high: int,
    distances: NDArray[np.float32],
    jumps: NDArray[np.float32],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pixels beside each other of low components and high ones, and the length of the border of low ones.

    Returns
    -------
    counts : (n_low, n_high) int64
    borders : (n_low,) int64
        Sides of its pixels that are next to others, but for the border of the image.
    """
    height, width = low.shape
    counts = np.zeros((n_low, n_high), np.int64)
    borders = np.zeros(n_low, np.int64)
    for i in range(height):
        for j in range(width):
            own = low[i, j]
            if own < 0:
                continue
            for step in range(4):
                row, column = i + (step == 0) - (step == 1), j + (step == 2) - (step == 3)
                if not (0 <= row < height and 0 <= column < width):
                    continue
                if low[row, column] == own:
                    continue
                borders[own] += 1
                other = high[row, column]
                if other >= 0 and abs(distances[row, column] - distances[i, j]) < jumps[i, j]:
                    counts[own, other] += 1
    return counts, borders


@kernel
def grow_downwards(
    numbers: NDArray[np.int32],
    may_grow: NDArray[np.bool_],
    points: NDArray[np.float64],
    up: NDArray[np.float64],
    reaches: NDArray[np.float32],
) -> None:
    """Let components grow, in place, into what is straight above or below a part of theirs; first come.

    Parameters
    ----------
    numbers : (h, w) int32
        Of components, -1 for none.
    may_grow : (h, w) bool
        Pixels that may belong to them.
    points : (h, w, 3) float64
    up : (3,) float64
    reaches : (h, w) float32
        Metres sideways from the point of the component as it was that growth has come from.
    """
    height, width = numbers.shape
    waiting = np.empty(height * width, np.int64)
    origins = np.empty(height * width, np.int64)
    last = 0
    for start in range(height * width):
        if numbers[start // width, start % width] >= 0:
            waiting[last], origins[last] = start, start
            last += 1
    first = 0
    while first < last:
        i, j = waiting[first] // width, waiting[first] % width
        origin = origins[first]
        first += 1
        for step in range(4):
            row, column = i + (step == 0) - (step == 1), j + (step == 2) - (step == 3)
            if not (0 <= row < height and 0 <= column < width):
                continue
            if numbers[row, column] >= 0 or not may_grow[row, column]:
                continue
            along, squares = 0.0, 0.0
            for axis in range(3):
                difference = points[row, column, axis] - points[origin // width, origin % width, axis]
                along += difference * up[axis]
                squares += difference * difference
            if squares - along * along < reaches[row, column] ** 2:
                numbers[row, column] = numbers[i, j]
                waiting[last], origins[last] = row * width + column, origin
                last += 1


@kernel
def grow_components(
    numbers: NDArray[np.int32],
    may_grow: NDArray[np.bool_],
    distances: NDArray[np.float32],
    jumps: NDArray[np.float32],
    n_steps: int,
) -> None:
    """Let components grow, in place, by so many pixels into those that may belong to them; first come."""
    height, width = numbers.shape
    edge = np.empty(height * width, np.int64)
    last = 0
    for start in range(height * width):
        i, j = start // width, start % width
        if numbers[i, j] < 0:
            continue
        for step in range(4):
            row, column = i + (step == 0) - (step == 1), j + (step == 2) - (step == 3)
            if 0 <= row < height and 0 <= column < width and numbers[row, column] < 0:
                edge[last] = start
                last += 1
                break
    first = 0
    for _ in range(n_steps):
        stop = last
        while first < stop:
            i, j = edge[first] // width, edge[first] % width
            first += 1
            for step in range(4):
                row, column = i + (step == 0) - (step == 1), j + (step == 2) - (step == 3)
                if not (0 <= row < height and 0 <= column < width):
                    continue
                if numbers[row, column] >= 0 or not may_grow[row, column]:
                    continue
                if abs(distances[row, column] - distances[i, j]) < jumps[i, j]:
                    numbers[row, column] = numbers[i, j]
                    edge[last] = row * width + column
                    last += 1


@kernel
def hidden_sides(
    numbers: NDArray[np.int32],
    n: int,
    distances: NDArray[np.float32],
    jumps: NDArray[np.float32],
    down: int,
    right: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of the border of each component, the sides where something nearer hides what comes, and all of them.

    Only sides in one direction count: so many pixels down and to the right, one of them 0, the other 1 or -1.
    A pixel where nothing was measured is passed over, up to three of them. Both (n,) int64.
    """
    height, width = numbers.shape
    hidden, sides = np.zeros(n, np.int64), np.zeros(n, np.int64)
    for i in range(height):
        for j in range(width):
            own = numbers[i, j]
            if own < 0:
                continue
            row, column = i + down, j + right
            if 0 <= row < height and 0 <= column < width and numbers[row, column] == own:
                continue
            sides[own] += 1
            for _ in range(4):
                if not (0 <= row < height and 0 <= column < width):
                    # Of what is beyond the image nobody knows.
                    hidden[own] += 1
                    break
                if not math.isnan(distances[row, column]):
                    hidden[own] += distances[row, column] < distances[i, j] - jumps[i, j]
                    break
                row, column = row + down, column + right
    return hidden, sides


@kernel
def silhouettes(
    numbers: NDArray[np.int32], n: int, distances: NDArray[np.float32], jumps: NDArray[np.float32]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Of the border of each component, the sides before something farther, those where its surface goes on.

    Pixels where nothing was measured are passed over, up to eight of them; behind more of them, and beyond
    the image, it is as if all were farther. The third are all sides. All (n,) int64.
    """
    height, width = numbers.shape
    in_front, goes_on, sides = np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64)
    for i in range(height):
        for j in range(width):
            own = numbers[i, j]
            if own < 0:
                continue
            for step in range(4):
                down, right = (step == 0) - (step == 1), (step == 2) - (step == 3)
                beyond = np.inf
                other = -1
                for k in range(1, 9):
                    row, column = i + k * down, j + k * right
                    if not (0 <= row < height and 0 <= column < width):
                        break
                    if not math.isnan(distances[row, column]):
                        beyond = distances[row, column] - distances[i, j]
                        other = numbers[row, column]
                        break
                if other == own:
                    continue
                sides[own] += 1
                in_front[own] += beyond > jumps[i, j]
                goes_on[own] += abs(beyond) <= jumps[i, j]
    return in_front, goes_on, sides
