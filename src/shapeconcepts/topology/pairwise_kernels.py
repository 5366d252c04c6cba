"""Kernel of the divergences between all rows of a space, over an inverted index."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.inverted_index_kernels import add_similarities, inverted_index


@kernel
def pairwise_divergences(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    n_columns: int,
) -> NDArray[np.float32]:
    """Jensen-Shannon divergence in bits of every two rows of a CSR matrix.

    Parameters
    ----------
    row_starts, columns, values, value_terms, n_columns
        As in `inverted_index`, with ``value_terms`` being ``values * log2(values)``. Rows sum to 1.

    Returns
    -------
    (n, n) float32
        Symmetric, 0 on the diagonal.
    """
    n = len(row_starts) - 1
    list_starts, listed_rows, listed_values, listed_terms = inverted_index(
        row_starts, columns, values, value_terms, n_columns
    )
    list_begins, list_ends = list_starts[:-1].copy(), list_starts[1:].copy()
    divergences = np.zeros((n, n), np.float32)
    similarity = np.zeros(n)
    for row in range(n):
        # Rows rise within a list: what stands before this one has met it already.
        for k in range(row_starts[row], row_starts[row + 1]):
            list_begins[columns[k]] += 1
        add_similarities(
            row, row_starts, columns, values, value_terms,
            list_begins, list_ends, listed_rows, listed_values, listed_terms, similarity,
        )  # fmt: skip
        for other in range(row + 1, n):
            divergence = min(max(1.0 - 0.5 * similarity[other], 0.0), 1.0)
            divergences[row, other] = divergences[other, row] = divergence
            similarity[other] = 0.0
    return divergences
