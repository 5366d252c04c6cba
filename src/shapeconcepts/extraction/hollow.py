"""Vessels: the inside of a bowl or cup, behind its outside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.pixel_grid import PixelGrid

_LEAST_ADJACENT = 20
_FEWEST_POINTS = 100
# Share of the narrower one's width that both have in common, and of the wider one's, which may have a handle.
_COMMON, _COMMON_OF_WIDER = 0.85, 0.55
_SAME_TOP, _SAME_TOP_SHARE = 0.015, 0.15
# By how much of its width the middle of a surface is behind or in front of its sides.
_BOWED = 0.06


def hollow_pairs(
    numbers: NDArray[np.int32], n: int, adjacent: NDArray[np.int64], grid: PixelGrid, heights: Heights
) -> NDArray[np.bool_]:
    """Pairs of parts of which one is the inside of a vessel and the other its outside, (n, n) bool.

    The rim parts them in the image. The farther one is concave towards the sensor, the nearer one convex;
    both are equally wide and equally high.

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
    up = grid.up
    for one, other in np.argwhere(np.triu(adjacent, 1) >= _LEAST_ADJACENT):
        members = [np.flatnonzero(flat == part) for part in (one, other)]
        if min(map(len, members)) < _FEWEST_POINTS:
            continue
        if not all(np.isfinite(height[part]).any() for part in members):
            continue
        tops = [float(np.nanquantile(height[part], 0.98)) for part in members]
        if not abs(tops[0] - tops[1]) < max(_SAME_TOP, _SAME_TOP_SHARE * max(tops)):
            continue
        clouds = [points[part] for part in members]
        sight = np.concatenate(clouds).mean(axis=0) - grid.viewpoint
        sight -= up * (sight @ up)
        length = np.linalg.norm(sight)
        if length < 1e-9:
            continue
        sight /= length
        clouds.sort(key=lambda cloud: float((cloud @ sight).mean()))
        sideways = np.cross(up, sight)
        ranges = [np.quantile(cloud @ sideways, (0.02, 0.98)) for cloud in clouds]
        widths = [high - low for low, high in ranges]
        span = max(low for low, _ in ranges), min(high for _, high in ranges)
        common = span[1] - span[0]
        if common < _COMMON * min(widths) or common < _COMMON_OF_WIDER * max(widths):
            continue
        near, far = (_bow(cloud @ sideways, cloud @ sight, *span) for cloud in clouds)
        pairs[one, other] = pairs[other, one] = far > _BOWED and near < -_BOWED
    return pairs


def _bow(sideways: NDArray[np.float64], away: NDArray[np.float64], low: float, high: float) -> float:
    """How far the middle is behind the sides, in parts of the width; negative where it is in front."""
    off_middle = np.abs((sideways - low) / (high - low) - 0.5)
    middle, sides = off_middle < 0.15, (off_middle > 0.35) & (off_middle < 0.5)
    if not middle.any() or not sides.any():
        return 0.0
    return float((np.median(away[middle]) - np.median(away[sides])) / (high - low))
