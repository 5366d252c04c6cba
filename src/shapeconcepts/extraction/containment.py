"""Parts that stand within the outline of another: the foot below a belly, the inside of a mouth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from shapeconcepts.extraction.pixel_grid import PixelGrid

_LEAST_ADJACENT = 8
_FEWEST_POINTS = 30
# Points of a part that its outline is made of.
_MOST_POINTS = 400
# Metres, and share of the points within the outline seen from above.
_MARGIN = 0.005
WITHIN = 0.8


def contained_pairs(
    numbers: NDArray[np.int32], n: int, adjacent: NDArray[np.int64], grid: PixelGrid
) -> NDArray[np.bool_]:
    """Pairs of parts beside each other of which one is, seen from above, within the other, (n, n) bool.

    Of two objects that stand apart, none is within the convex outline of what is seen of the other.

    Parameters
    ----------
    numbers : (h, w) int32
        Part of each pixel, -1 for none.
    n : int
    adjacent : (n, n) int64
        Pixels of two parts that are beside each other in the image.
    grid : PixelGrid
    """
    pairs = np.zeros((n, n), bool)
    axes = np.linalg.svd(grid.up[None])[2][1:]
    flat, points = numbers.ravel(), grid.points.reshape(-1, 3)
    plans: dict[int, NDArray[np.float64]] = {}

    def plan(part: int) -> NDArray[np.float64]:
        if part not in plans:
            members = np.flatnonzero(flat == part)
            plans[part] = points[members[:: -(-len(members) // _MOST_POINTS)]] @ axes.T
        return plans[part]

    for one, other in np.argwhere(np.triu(adjacent, 1) >= _LEAST_ADJACENT):
        small, large = sorted(
            (plan(one), plan(other)), key=lambda points: float(np.ptp(points, axis=0).prod())
        )
        if len(small) < _FEWEST_POINTS or len(large) < _FEWEST_POINTS:
            continue
        try:
            sides = ConvexHull(large).equations
        except QhullError:  # on one line
            continue
        is_within = (small @ sides[:, :2].T + sides[:, 2] < _MARGIN).all(axis=1)
        pairs[one, other] = pairs[other, one] = is_within.mean() > WITHIN
    return pairs
