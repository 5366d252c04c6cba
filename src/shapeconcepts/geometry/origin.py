"""Coordinates near the origin, where numbers hold the most digits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Metres. A power of two: multiples of it are taken off without rounding.
TILE = 1024.0


def nearest_tile(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The multiple of 1,024 m next to where most points are: what to take off before computing.

    Georeferenced scans are thousands of kilometres away from their origin, where products and sums of
    coordinates keep nine digits fewer. What is taken off the points around is exact. It is nothing for a scan
    in a sensor's own frame.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates.

    Returns
    -------
    (3,) float64
    """
    if np.abs(points).max(initial=0.0) < TILE / 2:
        return np.zeros(3)
    return np.rint(np.median(points, axis=0) / TILE) * TILE
