"""The dip test: do values have a single mode?

After J. A. Hartigan and P. M. Hartigan, The dip test of unimodality, Annals of Statistics 13, 1985.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import ArrayLike

from shapeconcepts.concepts import dip_kernels

SIZES = (4, 5, 6, 7, 8, 9, 10, 12, 14, 17, 20, 25, 32, 40, 55, 75, 100, 150, 250, 500, 1000, 2500, 6000)
PROBABILITIES = (
    *(0.99, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2),
    *(0.15, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0003, 0.0001),
)
# A row for each size: the dip of that many uniform values times 10,000 times the root of the size, which is
# exceeded with each of the probabilities. Printed by benchmarks/dip_table.py.
QUANTILES_TEXT = """
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 
"""
QUANTILES = np.array([row.split() for row in QUANTILES_TEXT.split("\n")[1:-1]], np.float64) / 10_000
# The last tenth part of the probabilities is what the tail beyond them continues.
TAIL_START = PROBABILITIES.index(0.001)


def dip_statistic(values: ArrayLike) -> float:
    """Hartigan's dip: smallest distance of the empirical distribution function to a unimodal one.

    Parameters
    ----------
    values : (n,) array_like
        At least one, all finite, in any order.

    Returns
    -------
    float
        From 1 / (2 n), which also stands for fewer than two different values, to 1 / 4, or to 1 / 2 if n is 1.
        The more it is, the less the values have a single mode.
    """
    numbers = np.asarray(values, np.float64)
    if numbers.ndim != 1 or not len(numbers) or not np.isfinite(numbers).all():
        raise ValueError(f"values must be a sequence of finite numbers, at least one, got {values!r}")
    # No difference overflows then, and nothing is rounded.
    _, exponent = np.frexp(np.abs(numbers).max())
    return float(dip_kernels.dip(np.sort(np.ldexp(numbers, -exponent))))


def dip_p_value(dip: float, n: int) -> float:
    """Probability that uniform values, the worst case of a single mode, have at least this dip.

    Interpolated from simulated quantiles of dip * sqrt(n), linear in 1 / sqrt(n). The logarithm of the probability
    is nearly linear in the square of the dip, as in the tail of a normal distribution, and continued so beyond
    the table. From its last size on, dip * sqrt(n) is taken to have its limiting distribution.

    Parameters
    ----------
    dip : float
    n : int
        Number of values that have this dip.

    Returns
    -------
    float
        In (0, 1], falling with the dip; 1 for fewer than four values, whose dip is always the smallest.
    """
    smallest = 1 / (2 * n)
    if n < SIZES[0] or dip <= smallest * (1 + 1e-9):
        return 1.0
    squares = np.maximum(quantiles(n), smallest * math.sqrt(n)) ** 2
    logarithms = np.log(PROBABILITIES)
    square = n * dip**2
    if square > squares[-1]:
        slope = (logarithms[-1] - logarithms[TAIL_START]) / (squares[-1] - squares[TAIL_START])
        logarithm = logarithms[-1] + slope * (square - squares[-1])
    else:
        logarithm = np.interp(square, [n * smallest**2, *squares], [0, *logarithms])
    return max(math.exp(logarithm), sys.float_info.min)


def quantiles(n: int) -> np.ndarray:
    """Values of dip * sqrt(n) that are exceeded with each of the probabilities, rising.

    Parameters
    ----------
    n : int
        At least 4.

    Returns
    -------
    (p,) float64
    """
    places = -1 / np.sqrt(SIZES)
    place = min(-1 / math.sqrt(n), places[-1])
    k = int(np.clip(np.searchsorted(places, place), 1, len(places) - 1))
    share = (place - places[k - 1]) / (places[k] - places[k - 1])
    return (1 - share) * QUANTILES[k - 1] + share * QUANTILES[k]
