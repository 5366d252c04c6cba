"""Kernels of the inverted index of sparse rows: for each column, the rows that have an entry there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.logarithm_kernels import BLOCK, shared_terms


@kernel
def inverted_index(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    n_columns: int,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64], NDArray[np.float64]]:
    """List the entries of a CSR matrix by column, rows rising.

    Parameters
    ----------
    row_starts : (n + 1,) int64
    columns : (k,) int32
    values, value_terms : (k,) float64
        Two numbers for each entry.
    n_columns : int

    Returns
    -------
    list_starts : (n_columns + 1,) int64
    listed_rows : (k,) uint32
    listed_values, listed_terms : (k,) float64
    """
    list_starts = np.zeros(n_columns + 1, np.int64)
    for column in columns:
        list_starts[column + 1] += 1
    for column in range(n_columns):
        list_starts[column + 1] += list_starts[column]
    list_ends = list_starts[:-1].copy()
    listed_rows = np.empty(len(columns), np.uint32)
    listed_values = np.empty(len(columns))
    listed_terms = np.empty(len(columns))
    for row in range(len(row_starts) - 1):
        for k in range(row_starts[row], row_starts[row + 1]):
            end = list_ends[columns[k]]
            listed_rows[end], listed_values[end], listed_terms[end] = row, values[k], value_terms[k]
            list_ends[columns[k]] = end + 1
    return list_starts, listed_rows, listed_values, listed_terms


@kernel
def add_similarities(
    row: int,
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    list_starts: NDArray[np.int64],
    list_ends: NDArray[np.int64],
    listed_rows: NDArray[np.uint32],
    listed_values: NDArray[np.float64],
    listed_terms: NDArray[np.float64],
    similarity: NDArray[np.float64],
) -> None:
    """Add to each listed row what it shares with one row: twice 1 minus their Jensen-Shannon divergence.

    Parameters
    ----------
    row : int
    row_starts, columns, values, value_terms
        As in `inverted_index`, with ``value_terms`` being ``values * log2(values)``.
    list_starts, list_ends : (n_columns,) int64
        Where the list of each column begins and ends in the following.
    listed_rows, listed_values, listed_terms
        As `inverted_index` gives them.
    similarity : (n,) float64, output
    """
    sums, terms = np.empty(BLOCK), np.empty(BLOCK)
    mantissas, intervals = np.empty(BLOCK, np.int64), np.empty(BLOCK, np.int64)
    for k in range(row_starts[row], row_starts[row + 1]):
        start, end = list_starts[columns[k]], list_ends[columns[k]]
        while start < end:
            count = min(BLOCK, end - start)
            shared_terms(
                count, listed_values, listed_terms, start, values[k], value_terms[k],
                sums, mantissas, intervals, terms,
            )  # fmt: skip
            for b in range(count):
                similarity[listed_rows[np.uint64(start + b)]] += terms[b]
            start += count
