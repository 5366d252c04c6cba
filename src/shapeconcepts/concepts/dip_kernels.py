"""Kernel of the dip: how far values are from having a single mode."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

BELOW, ABOVE = 1, -1


@kernel
def dip(values: NDArray[np.float64]) -> float:
    """Hartigan's dip: smallest distance of the empirical distribution function to a unimodal one.

    A unimodal distribution function is convex up to its mode and concave behind it; at the mode it may jump.
    The mode is known to lie in an interval, at first that of all values. Within it, the empirical
    distribution function has a greatest convex minorant and a least concave majorant. Where they are farther
    apart than twice the distance known so far, no unimodal function so near has its mode farther off than the
    next contact of the other one, so the interval shrinks to there. What it leaves is on one side of the mode
    for good, and the distance to the minorant on the left, to the majorant on the right, is a lower bound.
    Where the two are near enough, a straight line fits between them, and the bound is reached.

    Each shrinking takes time linear in the interval, and there are few. See J. A. Hartigan and P. M.
    Hartigan, The dip test of unimodality, Annals of Statistics 13, 1985.

    Parameters
    ----------
    values : (n,) float64
        Finite and rising, equal ones allowed, n at least 1; the largest difference must be finite as well.

    Returns
    -------
    float
        From 1 / (2 n), which also stands for fewer than two different values, to 1 / 4; 1 / 2 if n is 1.
    """
    n = len(values)
    places, before, after = steps(values)
    first, last = 0, len(places) - 1
    minorant, majorant = np.empty(last + 1), np.empty(last + 1)
    left_contacts, right_contacts = np.empty(last + 1, np.int64), np.empty(last + 1, np.int64)
    # Counted in values. A jump of one value outside the mode already takes half a value.
    twice_distance = 1.0
    while first < last:
        n_left = hull(places, before, BELOW, first, last, left_contacts, minorant)
        n_right = hull(places, after, ABOVE, first, last, right_contacts, majorant)
        widest, next_first, next_last = 0.0, first, last
        right = 0
        for left in range(n_left):
            k = left_contacts[left]
            while right_contacts[right] < k:
                right += 1
            if majorant[k] - minorant[k] > widest:
                widest, next_first, next_last = majorant[k] - minorant[k], k, right_contacts[right]
        left = 0
        for right in range(n_right):
            k = right_contacts[right]
            while left + 1 < n_left and left_contacts[left + 1] <= k:
                left += 1
            if majorant[k] - minorant[k] > widest:
                widest, next_first, next_last = majorant[k] - minorant[k], left_contacts[left], k
        if widest <= twice_distance:
            break
        # The interval's ends are spared: the mode may be there, with a jump.
        for k in range(first, next_first):
            twice_distance = max(twice_distance, after[k] - minorant[k])
        for k in range(next_last + 1, last + 1):
            twice_distance = max(twice_distance, majorant[k] - before[k])
        first, last = next_first, next_last
    return twice_distance / (2 * n)


@kernel
def steps(
    values: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Steps of the empirical distribution function.

    Parameters
    ----------
    values : (n,) float64
        Rising, equal ones allowed.

    Returns
    -------
    places : (m,) float64
        The different values, rising.
    before, after : (m,) int64
        Number of values less than each of them, and less or equal.
    """
    n = len(values)
    places = np.empty(n)
    before, after = np.empty(n, np.int64), np.empty(n, np.int64)
    m = 0
    for k in range(n):
        if k == 0 or values[k] > values[k - 1]:
            places[m], before[m] = values[k], k
            m += 1
        after[m - 1] = k + 1
    return places[:m], before[:m], after[:m]


@kernel
def hull(
    places: NDArray[np.float64],
    levels: NDArray[np.int64],
    side: int,
    first: int,
    last: int,
    contacts: NDArray[np.int64],
    heights: NDArray[np.float64],
) -> int:
    """Greatest convex minorant or least concave majorant of points from `first` to `last`.

    Parameters
    ----------
    places : (m,) float64
        Strictly rising.
    levels : (m,) int64
    side : int
        `BELOW` for the minorant, `ABOVE` for the majorant.
    first, last : int
        `first` is less than `last`.
    contacts : (m,) int64
        Takes the points at which the hull turns, both ends included, from its start on.
    heights : (m,) float64
        Takes the hull at each place from `first` to `last`.

    Returns
    -------
    int
        Number of contacts.
    """
    n_contacts = 0
    for k in range(first, last + 1):
        while n_contacts > 1:
            a, b = contacts[n_contacts - 2], contacts[n_contacts - 1]
            rise_here = (levels[b] - levels[a]) * (places[k] - places[b])
            rise_next = (levels[k] - levels[b]) * (places[b] - places[a])
            if side * (rise_next - rise_here) > 0:
                break
            n_contacts -= 1
        contacts[n_contacts] = k
        n_contacts += 1
    for c in range(n_contacts - 1):
        a, b = contacts[c], contacts[c + 1]
        for k in range(a, b):
            share = (places[k] - places[a]) / (places[b] - places[a])
            heights[k] = levels[a] + share * (levels[b] - levels[a])
    heights[last] = levels[last]
    return n_contacts
