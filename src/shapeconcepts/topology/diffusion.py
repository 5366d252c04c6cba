"""Diffusion of rows among their nearest neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix, sparray, spmatrix, vstack
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_is_fitted, check_non_negative, validate_data

from shapeconcepts.parameter_checks import check_integer
from shapeconcepts.topology.divergence import jensen_shannon_divergences, normalised_rows
from shapeconcepts.topology.space import distinct_rows

# Rows closer than this are the same but for rounding.
_SAME = 1e-9
_MOST_NEIGHBOURS = 10
# Rows compared with all others in one go.
_BLOCK = 256


class Diffusion(TransformerMixin, BaseEstimator):
    """Replaces a row by a mean of itself and its nearest neighbours among the training rows.

    What a single view shows or hides by chance is averaged out, what it has in common with its like remains:
    one step of the diffusion processes by which retrieval follows the manifold of shapes (Donoser and
    Bischof, CVPR 2013).

    Rows are compared as shares, by what they sum to 1. A neighbour at divergence d counts ``exp(-2 d / r)``,
    where r is the divergence of the farthest one; the row itself counts 1. Rows of the same content are one
    place and no neighbours of each other.

    Parameters
    ----------
    n_neighbours : int or None
        Number of neighbours, at least 1. None: half the root of the number of training rows that are not
        empty, at most 10: more would fill the rows up.

    Attributes
    ----------
    rows_ : (v, c) csr_matrix of float64
        Distinct training rows that are not empty, with sum 1.
    n_neighbours_ : int
    n_features_in_ : int
    """

    def __init__(self, n_neighbours: int | None = None) -> None:
        self.n_neighbours = n_neighbours

    def fit(self, X: ArrayLike | spmatrix | sparray, y: object = None) -> Diffusion:
        """Remember the rows of a matrix.

        Parameters
        ----------
        X : (n, c) array-like or sparse matrix
            Non-negative, such as stimuli.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If `n_neighbours` is out of range, or X is not a matrix of finite numbers of at least 0.
        """
        if self.n_neighbours is not None:
            check_integer("n_neighbours", self.n_neighbours, 1)
        rows = self._checked(X, reset=True)
        first, _ = distinct_rows(rows)
        self.rows_ = csr_matrix(rows[first])
        self._set_number(int((np.diff(rows.indptr) > 0).sum()))
        return self

    def transform(self, X: ArrayLike | spmatrix | sparray) -> csr_matrix:
        """Mean of each row and its neighbours.

        Parameters
        ----------
        X : (m, c) array-like or sparse matrix
            Non-negative. A training row has the same result as in training.

        Returns
        -------
        (m, c) csr_matrix of float64
            Rows of sum 1; empty ones stay empty.

        Raises
        ------
        ValueError
            If X has another number of columns, or is not finite and non-negative.
        """
        check_is_fitted(self)
        rows = self._checked(X, reset=False)
        starts = range(0, rows.shape[0], _BLOCK)
        return csr_matrix(vstack([rows[:0], *(self._means(rows[i : i + _BLOCK]) for i in starts)]))

    def _set_number(self, n_rows: int) -> None:
        half_root = min(max(1, round(np.sqrt(n_rows) / 2)), _MOST_NEIGHBOURS)
        self.n_neighbours_ = half_root if self.n_neighbours is None else self.n_neighbours

    def _means(self, rows: csr_matrix) -> csr_matrix:
        divergences = jensen_shannon_divergences(rows, self.rows_)
        divergences[divergences < _SAME] = np.inf
        found = [_nearest(others, self.n_neighbours_) for others in divergences]
        # What has nothing in common is no neighbour.
        found = [near[others[near] < 1.0] for near, others in zip(found, divergences, strict=True)]
        weights = []
        for near, others in zip(found, divergences, strict=True):
            weights.append(np.exp(-2 * others[near] / others[near[-1:]]))
        indptr = np.concatenate([[0], np.cumsum([len(near) for near in found])])
        steps = csr_matrix(
            (np.concatenate(weights), np.concatenate(found), indptr),
            shape=(rows.shape[0], self.rows_.shape[0]),
        )
        means = normalised_rows(rows + steps @ self.rows_, "X")
        means.sort_indices()
        return means

    def _checked(self, X: ArrayLike | spmatrix | sparray, reset: bool) -> csr_matrix:
        matrix = validate_data(
            self, X, reset=reset, accept_sparse="csr", dtype=np.float64,
            ensure_min_samples=int(reset), ensure_min_features=0,
        )  # fmt: skip
        # Within `validate_data` this fails for dense matrices without columns.
        check_non_negative(csr_matrix(matrix), "Diffusion")
        return normalised_rows(matrix, "X")

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = True
        tags.input_tags.positive_only = True
        return tags


def _nearest(divergences: NDArray[np.float64], n: int) -> NDArray[np.int64]:
    """Places of the n smallest numbers, rising; of equal ones the first."""
    if n < len(divergences):
        candidates = np.flatnonzero(divergences <= np.partition(divergences, n - 1)[n - 1])
    else:
        candidates = np.arange(len(divergences))
    return candidates[np.argsort(divergences[candidates], kind="stable")[:n]]
