"""Kernel of the minimum spanning tree of sparse rows under the Jensen-Shannon divergence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.inverted_index_kernels import add_similarities, inverted_index


@kernel
def is_earlier_edge(a: int, b: int, c: int, d: int) -> bool:
    """Whether edge a-b comes before edge c-d by the smaller, then by the larger end."""
    if min(a, b) != min(c, d):
        return min(a, b) < min(c, d)
    return max(a, b) < max(c, d)


@kernel
def grow_spanning_tree(
    row_starts: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    n_columns: int,
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Grow the tree vertex by vertex (Prim), over an inverted index of the rows outside of it.

    Only columns that two rows share bring their divergence under 1, so a vertex that joins visits the lists
    of its own columns, and no pair is computed twice. Among edges of equal divergence the one between the
    earlier rows wins, which makes the tree unique.

    Parameters
    ----------
    row_starts : (n + 1,) int64
    columns : (k,) int32
    values : (k,) float64
        Rows of a CSR matrix, positive, each with sum 1.
    value_terms : (k,) float64
        ``values * log2(values)``
    n_columns : int

    Returns
    -------
    edges : (n - 1, 2) int32
        In the order in which the second end joined.
    divergences : (n - 1,) float64
        Bits, 0 to 1.
    """
    n = len(row_starts) - 1
    list_starts, listed_rows, listed_values, listed_terms = inverted_index(
        row_starts, columns, values, value_terms, n_columns
    )
    list_ends = list_starts[1:].copy()

    similarity = np.zeros(n)
    largest = np.full(n, -1.0)
    nearest = np.zeros(n, np.int32)
    is_inside = np.zeros(n, np.bool_)
    outside = np.arange(n).astype(np.uint32)
    n_outside, n_stale = n, 0
    edges = np.empty((max(n - 1, 0), 2), np.int32)
    divergences = np.empty(max(n - 1, 0))
    joined = 0
    for step in range(n - 1):
        is_inside[joined] = True
        n_stale += 1
        if 8 * n_stale > n_outside:
            kept = 0
            for k in range(n_outside):
                if not is_inside[outside[k]]:
                    outside[kept] = outside[k]
                    kept += 1
            n_outside, n_stale = kept, 0
            for column in range(n_columns):
                end = list_starts[column]
                for k in range(list_starts[column], list_ends[column]):
                    if not is_inside[listed_rows[k]]:
                        listed_rows[end] = listed_rows[k]
                        listed_values[end] = listed_values[k]
                        listed_terms[end] = listed_terms[k]
                        end += 1
                list_ends[column] = end
        add_similarities(
            joined, row_starts, columns, values, value_terms,
            list_starts, list_ends, listed_rows, listed_values, listed_terms, similarity,
        )  # fmt: skip
        best = -1
        for k in range(n_outside):
            row = outside[k]
            shared = 0.5 * similarity[row]
            similarity[row] = 0.0
            if is_inside[row]:
                continue
            if shared > largest[row] or (
                shared == largest[row] and is_earlier_edge(joined, row, nearest[row], row)
            ):
                largest[row], nearest[row] = shared, joined
            if (
                best < 0
                or largest[row] > largest[best]
                or (largest[row] == largest[best] and is_earlier_edge(nearest[row], row, nearest[best], best))
            ):
                best = row
        edges[step, 0], edges[step, 1] = nearest[best], best
        divergences[step] = min(max(1.0 - largest[best], 0.0), 1.0)
        joined = best
    return edges, divergences
