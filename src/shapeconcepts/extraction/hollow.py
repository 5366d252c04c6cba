"""Vessels: the inside of a bowl, cup or plate, behind its outside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.depth_noise import depth_noise
from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.pixel_grid import PixelGrid

_LEAST_ADJACENT = 10
_FEWEST_POINTS, _FEWEST_ON_RIM = 80, 12
# The top of both: metres that they may differ, and metres below it, or share of its height, that are the rim.
_SAME_TOP, _RIM, _SHARE_OF_RIM = 0.01, 0.01, 0.12
# Metres of its radius, and of points off the circle on average, beside their noise; as a share of the radius,
# which a wall that leans takes.
_SMALLEST, _LARGEST, _OFF, _LEANS = 0.02, 0.2, 0.002, 0.05
# In parts of the radius: how far the halves are before and behind the middle, and how wide one and both are.
_AWAY, _WIDE, _WIDER = 0.25, 0.35, 0.7


def hollow_pairs(
    numbers: NDArray[np.int32], n: int, adjacent: NDArray[np.int64], grid: PixelGrid, heights: Heights
) -> NDArray[np.bool_]:
    """Pairs of parts of which one is the inside of a vessel and the other its outside, (n, n) bool.

    The rim parts them in the image, the nearer half of which is the top of the outside, the farther one that
    of the inside: both are on one circle, seen from above. That holds, too, where something hides a part of
    them; of parts of two objects it hardly ever does.

    Parameters
    ----------
    numbers : (h, w) int32
        Part of each pixel, -1 for none.
    n : int
    adjacent : (n, n) int64
        Pixels of two parts that are beside each other in the image.
    grid : PixelGrid
    heights : Heights
    """
    pairs = np.zeros((n, n), bool)
    flat, points, height = numbers.ravel(), grid.points.reshape(-1, 3), heights.height.ravel()
    beside = np.argwhere(np.triu(adjacent, 1) >= _LEAST_ADJACENT)
    is_measured = np.isfinite(height)
    members = {part: np.flatnonzero((flat == part) & is_measured) for part in np.unique(beside).tolist()}
    for one, other in beside.tolist():
        parts = [members[one], members[other]]
        if min(map(len, parts)) < _FEWEST_POINTS:
            continue
        tops = [float(np.quantile(height[part], 0.98)) for part in parts]
        if abs(tops[0] - tops[1]) > _SAME_TOP:
            continue
        rims = [
            points[part[height[part] > top - max(_RIM, _SHARE_OF_RIM * top)]]
            for part, top in zip(parts, tops, strict=True)
        ]
        if min(map(len, rims)) >= _FEWEST_ON_RIM:
            pairs[one, other] = pairs[other, one] = _are_one_rim(rims, grid)
    return pairs


def _are_one_rim(parts: list[NDArray[np.float64]], grid: PixelGrid) -> bool:
    """Whether points (k, 3) and (m, 3) are the nearer and the farther half of a circle, seen from above."""
    middle = np.concatenate(parts).mean(axis=0)
    sight = middle - grid.viewpoint
    noise = depth_noise(float(np.linalg.norm(sight)))
    sight -= grid.up * (sight @ grid.up)
    length = float(np.linalg.norm(sight))
    if length < noise:
        return False
    sight /= length
    # Sideways, and away from the sensor.
    axes = np.stack([np.cross(grid.up, sight), sight], axis=1)
    halves = sorted(((part - middle) @ axes for part in parts), key=lambda half: float(half[:, 1].mean()))
    centre, radius = _circle(halves)
    if not _SMALLEST < radius < _LARGEST:
        return False
    away = [float((half[:, 1] - centre[1]).mean()) / radius for half in halves]
    widths = sorted(float(np.ptp(half[:, 0])) / radius for half in halves)
    off = max(
        float(np.sqrt(np.mean((np.linalg.norm(half - centre, axis=1) - radius) ** 2))) for half in halves
    )
    return (
        away[0] < -_AWAY
        and away[1] > _AWAY
        and widths[0] > _WIDE
        and widths[1] > _WIDER
        and off < _OFF + _LEANS * radius + noise
    )


def _circle(halves: list[NDArray[np.float64]]) -> tuple[NDArray[np.float64], float]:
    """Centre (2,) and radius of the circle through points (Kåsa 1976), of which each half counts as much."""
    points = np.concatenate(halves)
    weights = np.concatenate([np.full(len(half), len(half) ** -0.5) for half in halves])
    terms = np.column_stack([2.0 * points, np.ones(len(points))]) * weights[:, None]
    solution = np.linalg.lstsq(terms, (points**2).sum(axis=1) * weights, rcond=None)[0]
    centre = solution[:2]
    return centre, float(np.sqrt(max(solution[2] + centre @ centre, 0.0)))
