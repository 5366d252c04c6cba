"""Kernels of the Jensen-Shannon divergence between sparse rows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def divergence_to(
    dense: NDArray[np.float64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    start: int,
    end: int,
) -> float:
    """Jensen-Shannon divergence in bits of a dense row and a sparse one, the entries from start to end.

    Rows sum to 1 or are empty. With ``f(x) = x log2 x`` a shared column adds
    ``(f(p) + f(q) - f(p + q)) / 2`` to 1, and no other column counts.
    """
    shared = 0.0
    for k in range(start, end):
        p, q = dense[columns[k]], values[k]
        if p > 0.0 and q > 0.0:
            shared += p * math.log2(p) + q * math.log2(q) - (p + q) * math.log2(p + q)
    return min(max(1.0 + 0.5 * shared, 0.0), 1.0)


@kernel
def divergences_between(
    first_starts: NDArray[np.int64],
    first_columns: NDArray[np.int32],
    first_values: NDArray[np.float64],
    second_starts: NDArray[np.int64],
    second_columns: NDArray[np.int32],
    second_values: NDArray[np.float64],
    n_columns: int,
) -> NDArray[np.float64]:
    """Jensen-Shannon divergence in bits of every two rows of two CSR matrices, see `divergence_to`."""
    n, m = len(first_starts) - 1, len(second_starts) - 1
    divergences = np.ones((n, m))
    dense = np.zeros(n_columns)
    for i in range(n):
        for k in range(first_starts[i], first_starts[i + 1]):
            dense[first_columns[k]] = first_values[k]
        for j in range(m):
            divergences[i, j] = divergence_to(
                dense, second_columns, second_values, second_starts[j], second_starts[j + 1]
            )
        for k in range(first_starts[i], first_starts[i + 1]):
            dense[first_columns[k]] = 0.0
    return divergences
