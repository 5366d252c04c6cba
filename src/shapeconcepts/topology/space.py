"""The topological space of stimuli: their minimum spanning tree, and how central each place in it is."""

from __future__ import annotations

from itertools import pairwise
from numbers import Integral
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix, sparray, spmatrix
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_non_negative, validate_data

from shapeconcepts.heap import give_back
from shapeconcepts.parallel import map_in_order
from shapeconcepts.parameters import check_parameters, whole_number
from shapeconcepts.topology.divergence import DivergenceIndex, normalised_rows
from shapeconcepts.topology.heat_kernels import distance_sums
from shapeconcepts.topology.sample import ROWS_AT_ONCE, draws, sampled
from shapeconcepts.topology.spanning_tree_kernels import grow_spanning_tree

_BLOCK = 512


class TopologicalSpace(BaseEstimator):
    """Minimum spanning tree of the rows of a matrix under the Jensen-Shannon divergence, with its heat.

    Rows are compared as shares, by what they sum to 1. Equal rows are one vertex; a row without any entry has
    no place. The tree is exact, and the same for any order of the rows: vertices are numbered by the content
    of their rows, and among equally long edges the one between lower numbers is taken (paper: Topological
    Space Generation).

    Parameters
    ----------
    max_vertices : int or None
        Of more vertices, the tree is that of a sample which follows how frequent rows are, and every other
        vertex hangs on its nearest of the sample: the work then grows with the number of rows, and not with
        its square. None: the tree is exact, however many there are.
    n_jobs : int or None
        As in joblib, for what hangs on a sample. The result does not depend on it.

    Attributes
    ----------
    vertices_ : (n,) int32
        Vertex of each row, -1 for a row without any entry.
    multiplicities_ : (v,) int64
        Number of rows at each vertex.
    rows_ : (v, c) csr_matrix of float64
        The row of each vertex, with sum 1.
    edges_ : (v - 1, 2) int32
        Edges of the tree, the smaller vertex first, sorted.
    divergences_ : (v - 1,) float64
        Jensen-Shannon divergence along each edge, bits, 0 to 1.
    mean_distances_ : (v,) float64
        Mean geodesic distance of each vertex to all rows that have a place, where every edge has length 1
        (paper: equation 2).
    vertex_heat_ : (v,) float64
        The same, scaled to 0 (the outermost leaves) to 1 (the centre); all 0 where all are equal.
    edge_heat_ : (v - 1,) float64
        Mean heat of the two ends (equation 2).
    n_features_in_ : int
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "max_vertices": [whole_number(2), None],
        "n_jobs": [Integral, None],
    }

    def __init__(self, max_vertices: int | None = None, n_jobs: int | None = None) -> None:
        self.max_vertices = max_vertices
        self.n_jobs = n_jobs

    def fit(self, X: ArrayLike | spmatrix | sparray, y: object = None) -> TopologicalSpace:
        """Build the tree.

        Parameters
        ----------
        X : (n, c) array-like or sparse matrix
            Non-negative.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If X is not a matrix of finite numbers of at least 0, or `max_vertices` is out of range.
        """
        check_parameters(self)
        X = validate_data(self, X, accept_sparse="csr", dtype=np.float64, ensure_min_features=0)
        # Within `validate_data` this fails for dense matrices without columns.
        check_non_negative(csr_matrix(X), "TopologicalSpace")
        rows = normalised_rows(X, "X")
        first, self.vertices_ = _distinct_rows(rows)
        self.multiplicities_ = np.bincount(self.vertices_[self.vertices_ >= 0], minlength=len(first))
        self.rows_ = csr_matrix(rows[first])
        del X, rows
        give_back()
        edges, divergences = self._tree()
        edges.sort(axis=1)
        order = np.lexsort(edges.T[::-1])
        self.edges_: NDArray[np.int32] = edges[order]
        self.divergences_: NDArray[np.float64] = divergences[order]
        self._set_heat()
        return self

    def _tree(self) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Edges and their divergences."""
        n, n_columns = self.rows_.shape
        if self.max_vertices is None or n <= self.max_vertices:
            return grow_spanning_tree(*_arrays(self.rows_), n_columns)
        sample = sampled(draws(self.rows_), self.max_vertices)
        rows_of_sample = csr_matrix(self.rows_[sample])
        edges, divergences = grow_spanning_tree(*_arrays(rows_of_sample), n_columns)
        others = np.setdiff1d(np.arange(n), sample)
        blocks = (csr_matrix(self.rows_[others[at : at + _BLOCK]]) for at in range(0, len(others), _BLOCK))
        index = DivergenceIndex(rows_of_sample)
        found = list(map_in_order(index.nearest, blocks, self.n_jobs, share_memory=True))
        nearest, to_nearest = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return (
            np.concatenate([sample[edges], np.stack([others, sample[nearest]], axis=1)]).astype(np.int32),
            np.concatenate([divergences, to_nearest]),
        )

    def _set_heat(self) -> None:
        # Sums of integers: what is equally central has the same heat to the last bit.
        sums = distance_sums(self.edges_, self.multiplicities_)
        self.mean_distances_ = sums / max(self.multiplicities_.sum(), 1)
        span = np.ptp(sums) if len(sums) else 0
        self.vertex_heat_ = (sums.max(initial=0) - sums) / max(span, 1)
        self.edge_heat_ = (2 * sums.max(initial=0) - sums[self.edges_].sum(axis=1)) / max(2 * span, 1)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = True
        tags.input_tags.positive_only = True
        return tags


def _arrays(
    rows: csr_matrix,
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
    """Starts, columns and values of rows, and values times their logarithm."""
    return (
        rows.indptr.astype(np.int64),
        rows.indices.astype(np.int32),
        rows.data,
        rows.data * np.log2(rows.data),
    )


def _distinct_rows(rows: csr_matrix) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """First row of each distinct content in a canonical order, and which of these each row is, -1 if empty.

    Parameters
    ----------
    rows : (n, c) csr_matrix
        Sorted columns, positive values.
    """
    keys: list[bytes] = []
    for start in range(0, rows.shape[0], ROWS_AT_ONCE):
        ends = rows.indptr[start : start + ROWS_AT_ONCE + 1]
        block = slice(ends[0], ends[-1])
        # Big-endian bytes of positive numbers sort like the numbers.
        entries = np.empty(ends[-1] - ends[0], np.dtype([("column", ">u4"), ("value", ">f8")]))
        entries["column"], entries["value"] = rows.indices[block], rows.data[block]
        keys += [entries[a:b].tobytes() for a, b in pairwise((ends - ends[0]).tolist())]
    first: list[int] = []
    vertices = np.full(len(keys), -1, np.int32)
    for row in sorted(np.flatnonzero(np.diff(rows.indptr)).tolist(), key=keys.__getitem__):
        if not first or keys[row] != keys[first[-1]]:
            first.append(row)
        vertices[row] = len(first) - 1
    return np.array(first, np.int64), vertices
