"""Parts that reach into one another, seen from above: the body and the legs of a teddy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from shapeconcepts.extraction.component_kernels import near_pairs
from shapeconcepts.extraction.fragments import APART
from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.pixel_grid import PixelGrid

# Every second pixel is looked at; so many of them around each, and so many that are beside each other.
_STEP, _BESIDE, _LEAST_ADJACENT = 2, 3, 4
# Pixels of a part, share of the size of the larger one, and metres above the surface of the top of both.
_FEWEST_PIXELS, SMALLER, _LEAST_TOP = 100, 0.4, 0.025
# Points of a part that stand for it.
_MOST_POINTS = 400
# Metres that a part reaches into the outline of another one.
INTO = 0.01
# Metres beside an outline that are near, of what ends so high above the surface that it does not stand on it.
BESIDE, HANGS = 0.03, 0.02
# What stands on another one: metres outside of its outline, share within it, metres below its top, and above
# the surface.
_WITHIN, _SHARE_WITHIN, _BELOW_TOP, _ON_TOP = 0.005, 0.5, 0.012, 0.04


class _Part(NamedTuple):
    points: NDArray[np.float64]
    plan: NDArray[np.float64]
    bottom: float
    top: float

    def is_joined_to(self, larger: _Part) -> bool:
        """Whether this one reaches into a larger one, or hangs beside it."""
        if min(self.top, larger.top) < _LEAST_TOP:
            return False
        try:
            sides = ConvexHull(larger.plan).equations
        except QhullError:  # on one line
            return False
        outside = (self.plan @ sides[:, :2].T + sides[:, 2]).max(axis=1)
        is_on_top = (
            (outside < _WITHIN).mean() > _SHARE_WITHIN
            and self.bottom > larger.top - _BELOW_TOP
            and self.bottom > _ON_TOP
        )
        least = outside.min()
        reaches = least < -INTO or (least < BESIDE and self.bottom > HANGS)
        if is_on_top or not reaches:
            return False
        return bool(cKDTree(larger.points).query(self.points)[0].min() < APART)


def interlocked_pairs(
    numbers: NDArray[np.int32], n: int, may_join: NDArray[np.bool_], grid: PixelGrid, heights: Heights
) -> NDArray[np.bool_]:
    """Pairs of parts that are one object although a jump in distance parts them in the image, (n, n) bool.

    Of two objects that stand apart, none reaches into the convex outline of what is seen of the other, and
    none ends in the air beside it. So a small part that does is a limb of the larger one beside it, unless it
    stands on its top.

    Parameters
    ----------
    numbers : (h, w) int32
        Part of each pixel, -1 for none.
    n : int
    may_join : (n,) bool
        Parts that are looked at: no furniture, and nothing that is known to be an object of its own.
    grid : PixelGrid
    heights : Heights
    """
    pairs = np.zeros((n, n), bool)
    step = (slice(None, None, _STEP), slice(None, None, _STEP))
    some = np.where(np.append(may_join, False)[numbers[step]], numbers[step], -1).astype(np.int32)
    everywhere = np.full(some.shape, np.inf, np.float32)
    adjacent = near_pairs(some, n, np.ascontiguousarray(grid.points[step]), everywhere, _BESIDE)
    flat, points, height = numbers.ravel(), grid.points.reshape(-1, 3), heights.height.ravel()
    sizes = np.bincount(flat[flat >= 0], minlength=n)
    axes = np.linalg.svd(grid.up[None])[2][1:]
    parts: dict[int, _Part] = {}

    def part(number: int) -> _Part:
        if number not in parts:
            members = np.flatnonzero(flat == number)
            members = members[:: -(-len(members) // _MOST_POINTS)]
            cloud = points[members]
            # Where no surface is below, it is far below.
            own = np.nan_to_num(height[members], nan=np.inf)
            bottom, top = np.quantile(own, (0.02, 0.98), method="nearest")
            parts[number] = _Part(cloud, cloud @ axes.T, float(bottom), float(top))
        return parts[number]

    for pair in np.argwhere(np.triu(adjacent, 1) >= _LEAST_ADJACENT):
        small, large = pair[np.argsort(sizes[pair], kind="stable")]
        if _FEWEST_PIXELS <= sizes[small] <= SMALLER * sizes[large]:
            pairs[small, large] = pairs[large, small] = part(small).is_joined_to(part(large))
    return pairs
