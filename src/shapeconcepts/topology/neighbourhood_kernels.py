"""Kernel of the most similar rows of sparse rows under the Jensen-Shannon divergence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.inverted_index_kernels import add_similarities


@kernel
def most_similar_rows(
    first: int,
    last: int,
    n_kept: int,
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    list_starts: NDArray[np.int64],
    listed_rows: NDArray[np.uint32],
    listed_values: NDArray[np.float64],
    listed_terms: NDArray[np.float64],
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The other rows that share most with each of the rows from first to last.

    Parameters
    ----------
    first, last : int
    n_kept : int
        At least 1. Of equally similar rows the first are kept.
    row_starts : (n + 1,) int64
    columns : (k,) int32
    values : (k,) float64
        Rows of a CSR matrix, positive, each with sum 1.
    value_terms : (k,) float64
        ``values * log2(values)``
    list_starts, listed_rows, listed_values, listed_terms
        Their `inverted_index`.

    Returns
    -------
    rows : (last - first, n_kept) int32
        In any order; n where fewer share any column.
    divergences : (last - first, n_kept) float64
        Bits, below 1; infinite where there is no row.
    """
    n = len(row_starts) - 1
    similarity = np.zeros(n)
    rows = np.full((last - first, n_kept), n, np.int32)
    divergences = np.full((last - first, n_kept), np.inf)
    kept_similarities = np.empty(n_kept)
    for row in range(first, last):
        add_similarities(
            row, row_starts, columns, values, value_terms,
            list_starts, list_starts[1:], listed_rows, listed_values, listed_terms, similarity,
        )  # fmt: skip
        similarity[row] = 0.0
        kept = rows[row - first]
        n_found = 0
        for other in range(n):
            if similarity[other] > 0.0:
                if n_found < n_kept:
                    kept[n_found], kept_similarities[n_found] = other, similarity[other]
                    n_found += 1
                    if n_found == n_kept:
                        for place in range(n_kept // 2 - 1, -1, -1):
                            _sift(kept, kept_similarities, place, kept[place], kept_similarities[place])
                elif similarity[other] > kept_similarities[0]:
                    _sift(kept, kept_similarities, 0, other, similarity[other])
                similarity[other] = 0.0
        for k in range(n_found):
            divergences[row - first, k] = max(1.0 - 0.5 * kept_similarities[k], 0.0)
    return rows, divergences


@kernel
def _sift(
    rows: NDArray[np.int32], similarities: NDArray[np.float64], place: int, row: int, similarity: float
) -> None:
    """Put a row into a heap at a place or below: the least similar is on top, of equals the last."""
    n = len(rows)
    while True:
        child = 2 * place + 1
        if child >= n:
            break
        other = child + 1
        if other < n and _is_less(similarities[other], rows[other], similarities[child], rows[child]):
            child = other
        if not _is_less(similarities[child], rows[child], similarity, row):
            break
        rows[place], similarities[place] = rows[child], similarities[child]
        place = child
    rows[place], similarities[place] = row, similarity


@kernel
def _is_less(similarity: float, row: int, other_similarity: float, other_row: int) -> bool:
    return similarity < other_similarity or (similarity == other_similarity and row > other_row)
