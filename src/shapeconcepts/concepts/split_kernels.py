"""Kernel of the split between two classes: how many modes objects have on the axis from one to the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.dip_kernels import dip
from shapeconcepts.kernels import kernel

# Of the larger class, at least so many are compared with the smaller one.
_LEAST_COMPARED = 5


@kernel
def split_dips(
    divergences: NDArray[np.float32],
    members: NDArray[np.int32],
    stretches: NDArray[np.int64],
    tested: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Dip statistic of each pair of classes, on the axis between them.

    An object's place on the axis is its mean divergence to the second class less that to the first, in which
    it does not count itself. Of the larger class there are as many objects as the smaller one has, the
    nearest to it: what is far behind them says nothing about the border.

    Parameters
    ----------
    divergences : (v, v) float32
        Symmetric.
    members : (v,) int32
    stretches : (e, 3) int64
        Classes, see `mean_divergence_order`.
    tested : (e,) bool
        Which pairs are wanted.

    Returns
    -------
    dips : (e,) float64
        0 where it is not wanted.
    counts : (e,) int64
        Number of objects that it is of.
    """
    n = len(stretches)
    dips, counts = np.zeros(n), np.zeros(n, np.int64)
    for k in range(n):
        if not tested[k]:
            continue
        begin, middle, end = stretches[k, 0], stretches[k, 1], stretches[k, 2]
        larger, smaller = members[begin:middle], members[middle:end]
        if len(larger) < len(smaller):
            larger, smaller = smaller, larger
        near = _nearest(divergences, larger, smaller, max(len(smaller), _LEAST_COMPARED))
        both = np.concatenate((near, smaller))
        places = np.empty(len(both))
        for i in range(len(both)):
            to_first, to_second = 0.0, 0.0
            for j in range(len(near)):
                to_first += divergences[both[i], near[j]]
            for j in range(len(smaller)):
                to_second += divergences[both[i], smaller[j]]
            n_first, n_second = len(near), len(smaller)
            if i < len(near):
                n_first -= 1
            else:
                n_second -= 1
            places[i] = to_second / max(n_second, 1) - to_first / max(n_first, 1)
        places.sort()
        dips[k], counts[k] = dip(places), len(places)
    return dips, counts


@kernel
def _nearest(
    divergences: NDArray[np.float32],
    candidates: NDArray[np.int32],
    others: NDArray[np.int32],
    n_wanted: int,
) -> NDArray[np.int32]:
    """The candidates of smallest mean divergence to others; of equal ones the first."""
    means = np.zeros(len(candidates))
    for i in range(len(candidates)):
        for j in range(len(others)):
            means[i] += divergences[candidates[i], others[j]]
    return candidates[np.argsort(means, kind="mergesort")[:n_wanted]]
