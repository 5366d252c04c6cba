"""Kernels of the divergences of sparse rows from those of an inverted index, and of the nearest of these."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.inverted_index_kernels import add_similarities


@kernel
def indexed_divergences(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    n_indexed: int,
    list_starts: NDArray[np.int64],
    listed_rows: NDArray[np.uint32],
    listed_values: NDArray[np.float64],
    listed_terms: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Jensen-Shannon divergence in bits of each row of a CSR matrix from each indexed row.

    Only columns that two rows share are visited. A row does not depend on the others, to the last bit.

    Parameters
    ----------
    row_starts, columns, values, value_terms
        As in `inverted_index`.
    n_indexed : int
    list_starts, listed_rows, listed_values, listed_terms
        As `inverted_index` gives them of the other rows.

    Returns
    -------
    (n, n_indexed) float64
    """
    n = len(row_starts) - 1
    divergences = np.zeros((n, n_indexed))
    list_ends = list_starts[1:].copy()
    for row in range(n):
        add_similarities(
            row, row_starts, columns, values, value_terms,
            list_starts, list_ends, listed_rows, listed_values, listed_terms, divergences[row],
        )  # fmt: skip
        for k in range(n_indexed):
            divergences[row, k] = min(max(1.0 - 0.5 * divergences[row, k], 0.0), 1.0)
    return divergences


@kernel
def nearest_rows(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    n_indexed: int,
    list_starts: NDArray[np.int64],
    listed_rows: NDArray[np.uint32],
    listed_values: NDArray[np.float64],
    listed_terms: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Nearest indexed row to each row of a CSR matrix, exactly; of equally near ones the first.

    Parameters are those of `indexed_divergences`, and a row does not depend on the others, either.

    Returns
    -------
    nearest : (n,) int64
    divergences : (n,) float64
        Bits, 0 to 1.
    """
    n = len(row_starts) - 1
    list_ends = list_starts[1:].copy()
    nearest, divergences = np.zeros(n, np.int64), np.empty(n)
    similarity = np.empty(n_indexed)
    for row in range(n):
        similarity[:] = 0.0
        add_similarities(
            row, row_starts, columns, values, value_terms,
            list_starts, list_ends, listed_rows, listed_values, listed_terms, similarity,
        )  # fmt: skip
        best = 0
        for k in range(n_indexed):
            if similarity[k] > similarity[best]:
                best = k
        nearest[row] = best
        divergences[row] = min(max(1.0 - 0.5 * similarity[best], 0.0), 1.0)
    return nearest, divergences
