"""Kernel of the medoids of many groups of sparse rows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.divergence_kernels import divergence_to

# All pairs of a group of a hundred thousand would take hours.
MAX_WHOLE = 256
N_SAMPLED = 50


@kernel
def medoids_of_groups(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    n_columns: int,
    weights: NDArray[np.int64],
    rows: NDArray[np.int64],
    group_starts: NDArray[np.int64],
    groups: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Row of each group of the smallest mean Jensen-Shannon divergence to the group.

    Parameters
    ----------
    row_starts, columns, values
        CSR matrix whose rows sum to 1.
    n_columns : int
    weights : (n,) int64
        How often each row counts.
    rows : (n,) int64
    group_starts : (g + 1,) int64
        Rows by group, and where each group starts in them.
    groups : (k,) int64
        Groups of interest.

    Returns
    -------
    (k,) int64
        The first of equally central ones. In a group of more than `MAX_WHOLE` rows the mean is over
        `N_SAMPLED` of them, evenly taken.
    """
    medoids = np.empty(len(groups), np.int64)
    dense = np.zeros(n_columns)
    for g in range(len(groups)):
        first, last = group_starts[groups[g]], group_starts[groups[g] + 1]
        n_compared = last - first if last - first <= MAX_WHOLE else N_SAMPLED
        smallest = math.inf
        for i in rows[first:last]:
            for k in range(row_starts[i], row_starts[i + 1]):
                dense[columns[k]] = values[k]
            total = 0.0
            for compared in range(n_compared):
                j = rows[first + compared * (last - first) // n_compared]
                total += weights[j] * divergence_to(dense, columns, values, row_starts[j], row_starts[j + 1])
            for k in range(row_starts[i], row_starts[i + 1]):
                dense[columns[k]] = 0.0
            if total < smallest:
                smallest, medoids[g] = total, i
    return medoids
