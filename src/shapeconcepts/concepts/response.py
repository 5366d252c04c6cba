"""Responses of concepts to an object, and the concept that it most resembles."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix, sparray, spmatrix
from scipy.spatial.distance import cdist
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.decomposition import PCA
from sklearn.utils.validation import check_is_fitted, check_non_negative, validate_data

from shapeconcepts.parallel import libraries_in_one_thread
from shapeconcepts.parameters import check_parameters, choice, share, whole_number
from shapeconcepts.topology.divergence import DivergenceIndex, normalised_rows
from shapeconcepts.topology.sample import draws, sampled
from shapeconcepts.topology.space import TopologicalSpace

DISTANCES = ("divergence", "mahalanobis")
# A mean over fewer members says little of a group.
LEAST_MEMBERS = 64
# Above so many entries the dense matrix is not formed.
_DENSE_ENTRIES = 2_000_000


class ConceptResponse(TransformerMixin, BaseEstimator):
    """Mean distance of a row to the prototypes of each concept (paper: equation 3).

    Rows are compared as shares, by what they sum to 1.

    Parameters
    ----------
    distance : {"divergence", "mahalanobis"}
        "divergence": the Jensen-Shannon divergence in bits, in which the concepts were found. "mahalanobis"
        (paper): the covariance is that of the training rows within their main principal components: outside
        of these, the hundreds of rows at hand say nothing about the thousands of columns.
    n_nearest : int
        For `predict`: nearest prototypes of each concept that a row is compared with.
    max_components : int
        For "mahalanobis": largest number of principal components.
    variance_kept : float
        For "mahalanobis": share of the variance that the components carry, if so many of them do.
    max_prototypes : int
        Of more training rows in concepts, a sample stands for all, so that responses do not become slower
        with ever more of them: as many of each concept as it has in proportion, and 64 at least.

    Attributes
    ----------
    classes_ : (k,) int64
        Numbers of the concepts, rising.
    prototypes_ : (p, c) csr_matrix of float64
        Training rows that are in a concept and not empty, with sum 1; or a sample of them.
    prototype_rows_ : (p,) int64
        Which training rows these are, rising.
    prototype_concepts_ : (p,) int64
        Position in `classes_` of each prototype's concept.
    mean_ : (c,) float64
        Mean of the training rows.
    whitening_ : (c, d) float64
        Takes centred rows to principal components of variance 1, between which the Mahalanobis distance is
        the Euclidean one. Without any component where the distance is another.
    largest_divergence_ : float
        The longest step between neighbouring prototypes that have anything in common. An object that is
        farther from every prototype is unknown.
    n_features_in_ : int
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "distance": [choice(*DISTANCES)],
        "n_nearest": [whole_number(1)],
        "max_components": [whole_number(1)],
        "variance_kept": [share()],
        "max_prototypes": [whole_number(1)],
    }

    def __init__(
        self,
        distance: str = "divergence",
        n_nearest: int = 10,
        max_components: int = 30,
        variance_kept: float = 0.95,
        max_prototypes: int = 4096,
    ) -> None:
        self.distance = distance
        self.n_nearest = n_nearest
        self.max_components = max_components
        self.variance_kept = variance_kept
        self.max_prototypes = max_prototypes

    def fit(self, X: ArrayLike | spmatrix | sparray, y: ArrayLike) -> ConceptResponse:
        """Learn what the rows of each concept are like.

        Parameters
        ----------
        X : (n, c) array-like or sparse matrix
            Non-negative, such as stimuli.
        y : (n,) array-like of int
            Concept of each row, -1 for none.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If a parameter is out of range, X is not a matrix of finite numbers of at least 0, or y does not
            fit.
        """
        check_parameters(self)
        matrix, labels = validate_data(
            self, X, y, accept_sparse="csr", dtype=np.float64, ensure_min_features=0
        )
        check_non_negative(csr_matrix(matrix), "ConceptResponse")
        is_whole = np.issubdtype(labels.dtype, np.number) and np.array_equal(labels, np.trunc(labels))
        if not is_whole or labels.min() < -1:
            raise ValueError(f"y must hold integers of at least -1, got {labels[:5].tolist()} ...")
        rows = normalised_rows(matrix, "X")
        placed = np.diff(rows.indptr) > 0
        self._set_prototypes(rows, np.where(placed, labels, -1).astype(np.int64))
        n_components = self.max_components if self.distance == "mahalanobis" else 0
        self.mean_, self.whitening_ = _whitening(rows[placed], n_components, self.variance_kept)
        self.largest_divergence_ = self._longest_step()
        return self

    def _set_prototypes(self, rows: csr_matrix, labels: NDArray[np.int64]) -> None:
        """Rows (n, c) of concepts, -1 for those of none or without an entry."""
        self.prototype_rows_ = sampled_members(rows, labels, self.max_prototypes)
        concepts = labels[self.prototype_rows_]
        self.classes_, self.prototype_concepts_ = np.unique(concepts, return_inverse=True)
        self.prototypes_ = csr_matrix(rows[self.prototype_rows_])
        self._index = DivergenceIndex(self.prototypes_)

    def transform(self, X: ArrayLike | spmatrix | sparray) -> NDArray[np.float64]:
        """Responses of the concepts; smaller is more alike.

        Parameters
        ----------
        X : (m, c) array-like or sparse matrix
            Non-negative.

        Returns
        -------
        (m, k) float64
            Mean distance to the prototypes of each concept, at least 0; NaN in a row without any entry.

        Raises
        ------
        ValueError
            If X has another number of columns, or is not finite and non-negative.
        """
        return mean_distances(self.distances(X), self.prototype_concepts_, len(self.classes_))

    def distances(self, X: ArrayLike | spmatrix | sparray) -> NDArray[np.float64]:
        """Distance of each row to each prototype, in the order of `prototypes_`.

        Parameters and errors are those of `transform`.

        Returns
        -------
        (m, p) float64
            NaN in a row without any entry.
        """
        check_is_fitted(self)
        rows = self._rows(X)
        if self.distance == "mahalanobis":
            distances = cdist(self._project(rows), self._project(self.prototypes_))
        else:
            distances = self._index.divergences(rows)
        distances[np.diff(rows.indptr) == 0] = np.nan
        return distances

    def predict(self, X: ArrayLike | spmatrix | sparray) -> NDArray[np.int64]:
        """Concept whose nearest prototypes are nearest on average, -1 where every prototype is far.

        The average is over the `n_nearest` of smallest Jensen-Shannon divergence, or all where a concept has
        fewer.

        Parameters and errors are those of `transform`.

        Returns
        -------
        (m,) int64
            One of `classes_`, or -1: unknown.
        """
        check_is_fitted(self)
        rows = self._rows(X)
        if len(self.classes_) == 0:
            return np.full(rows.shape[0], -1)
        divergences = self._index.divergences(rows)
        means = np.empty((rows.shape[0], len(self.classes_)))
        for concept in range(len(self.classes_)):
            nearest = np.sort(divergences[:, self.prototype_concepts_ == concept])[:, : self.n_nearest]
            # Column by column: summed over rows, the rounding would depend on how many there are.
            means[:, concept] = sum(nearest.T) / nearest.shape[1]
        known = (divergences.min(axis=1) <= self.largest_divergence_) & (np.diff(rows.indptr) > 0)
        return np.where(known, self.classes_[means.argmin(axis=1)], -1)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns of `transform`: "concept0", "concept1" ..."""
        check_is_fitted(self)
        return np.array([f"concept{number}" for number in self.classes_], dtype=object)

    def _rows(self, X: ArrayLike | spmatrix | sparray) -> csr_matrix:
        matrix = validate_data(
            self, X, reset=False, accept_sparse="csr", dtype=np.float64,
            ensure_min_samples=0, ensure_min_features=0,
        )  # fmt: skip
        check_non_negative(csr_matrix(matrix), "ConceptResponse")
        return normalised_rows(matrix, "X")

    def _project(self, rows: csr_matrix) -> NDArray[np.float64]:
        # Not by BLAS: its sums round differently with each number of threads.
        return rows @ self.whitening_ - np.einsum("c,cd->d", self.mean_, self.whitening_)

    def _longest_step(self) -> float:
        """Longest edge of the prototypes' spanning tree, but for those between what has nothing in common."""
        if self.prototypes_.shape[0] == 0:
            return 0.0
        steps = TopologicalSpace().fit(self.prototypes_).divergences_
        return float(steps[steps < 1].max(initial=0.0))

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = True
        tags.input_tags.positive_only = True
        tags.target_tags.required = True
        return tags


def sampled_members(rows: csr_matrix, labels: NDArray[np.integer], n_most: int) -> NDArray[np.int64]:
    """Rows that stand for the members of each group, rising: all of them unless there are too many.

    Parameters
    ----------
    rows : (n, c) csr_matrix of float64
        With sum 1.
    labels : (n,) int
        Group of each row, -1 for none.
    n_most : int
        In all; but each group keeps `LEAST_MEMBERS`, if it has so many.
    """
    members = np.flatnonzero(labels >= 0)
    if len(members) <= n_most:
        return members
    drawn = draws(rows)[members]
    kept = []
    for group in np.unique(labels[members]):
        own = np.flatnonzero(labels[members] == group)
        n_kept = max(-(-n_most * len(own) // len(members)), LEAST_MEMBERS)
        kept.append(members[own[sampled(drawn[own], n_kept)]])
    return np.sort(np.concatenate(kept))


def mean_distances(
    distances: NDArray[np.float64], concepts: NDArray[np.integer], n_concepts: int
) -> NDArray[np.float64]:
    """Mean distance to the prototypes of each concept (paper: equation 3).

    Parameters
    ----------
    distances : (m, p) float64
    concepts : (p,) int
        Concept of each prototype, from 0; each has one at least.
    n_concepts : int

    Returns
    -------
    (m, n_concepts) float64
    """
    counts = np.bincount(concepts, minlength=n_concepts)
    # Row by row: summed over a whole matrix, the rounding of a row would depend on how many there are.
    sums = [np.bincount(concepts, row, n_concepts) for row in distances]
    return np.array(sums).reshape(len(distances), n_concepts) / counts


def _whitening(
    rows: csr_matrix, n_components: int, variance_kept: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean of rows, and the projection to their main principal components scaled to variance 1."""
    n, n_columns = rows.shape
    largest = min(n_components, n - 1, n_columns)
    mean = np.asarray(rows.mean(axis=0)).ravel() if n else np.zeros(n_columns)
    if largest < 1:
        return mean, np.empty((n_columns, 0))
    # Among equal rows a component's share of the variance is 0 / 0.
    with np.errstate(invalid="ignore"), libraries_in_one_thread():
        if n * n_columns <= _DENSE_ENTRIES or largest >= min(n, n_columns):
            components = PCA(largest, svd_solver="full").fit(rows.toarray())
        else:
            components = PCA(largest, svd_solver="arpack", random_state=0).fit(rows)
    variance, carried = components.explained_variance_, np.cumsum(components.explained_variance_ratio_)
    # Components without variance carry nothing but rounding.
    kept = min(int(np.searchsorted(carried, variance_kept)) + 1, int((variance > 1e-12 * variance[:1]).sum()))
    if not variance.size or variance[0] < 1e-24:
        kept = 0
    # In one order of memory, on which the rounding of products depends, whatever solver was at work.
    return mean, np.ascontiguousarray(components.components_[:kept].T / np.sqrt(variance[:kept]))
