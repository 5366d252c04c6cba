"""Coordinates near the origin, where numbers hold the most digits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Metres. A power of two: multiples of it are taken off without rounding.
TILE = 1024.0
# So many whole numbers are told from each other after two roundings.
_MOST_STEPS = 2.0**51
_PROBED = 50


class Origin(NamedTuple):
    """What to take off coordinates before computing, and how to do it without rounding.

    Attributes
    ----------
    steps : (3,) float64
        Whole numbers.
    per_metre : float
        Steps in a metre: a power of ten for decimal coordinates, else 1.
    """

    steps: NDArray[np.float64]
    per_metre: float

    @property
    def metres(self) -> NDArray[np.float64]:
        """The origin in the frame of the coordinates, (3,) float64."""
        return self.steps / self.per_metre

    def take_off(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points, (..., 3), relative to the origin; of decimal ones, the nearest numbers to the true ones."""
        if self.per_metre == 1.0:
            return points - self.steps
        steps = points * self.per_metre
        whole = np.rint(steps)
        return (np.where(whole / self.per_metre == points, whole, steps) - self.steps) / self.per_metre


def origin_amid(points: NDArray[np.float64]) -> Origin:
    """An origin amid points.

    Decimal coordinates, as files of text have them, are no binary numbers: 447,123.457 m is rounded by
    30 picometres, 0.457 m by a millionth of that. Distances that are equal would differ, each time in another
    way, and what hangs on them. But rounded decimals tell which ones they were: differences are taken between
    these, and are the same wherever the points are.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1, at most 1e9.
    """
    largest = max(float(np.abs(points).max()), 1.0)
    per_metre = float(10.0 ** np.floor(np.log10(_MOST_STEPS / largest)))
    some = points[:: len(points) // _PROBED + 1]
    if not (_are_decimal(some, per_metre) and _are_decimal(points, per_metre)):
        return Origin(nearest_tile(points), 1.0)
    # In the midst of them, and the same point wherever they are.
    middle = np.sort(some, axis=0)[len(some) // 2]
    return Origin(np.rint(middle * per_metre), per_metre)


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


def _are_decimal(points: NDArray[np.float64], per_metre: float) -> bool:
    return bool((np.rint(points * per_metre) / per_metre == points).all())
