"""The hierarchical dictionary of visual words."""

from __future__ import annotations

import warnings
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from shapeconcepts.motifs.divisive_clustering import divide
from shapeconcepts.motifs.word_kernels import nearest_words
from shapeconcepts.parallel import libraries_in_one_thread
from shapeconcepts.parameters import check_parameters, choice, whole_number

METRICS = ("hellinger", "euclidean")
MAX_LEVELS = 16


class SegmentDictionary(TransformerMixin, BaseEstimator):
    """Visual words for segments at several levels of detail, learned by divisive clustering.

    Every cluster of segment descriptions is split in two by 2-means, again and again, so that level f has
    2^f words (paper: Object Segment Extraction). A word is the centre of its cluster. A new segment gets, at
    each level, the nearest word of that whole level. Nothing depends on a random number or on the order of
    the segments.

    Parameters
    ----------
    n_levels : int
        Number of levels, 1 to 16. The first has two words.
    metric : {"hellinger", "euclidean"}
        What distance words are near under. "euclidean" compares histograms bin by bin (the paper's L2), which
        the few large bins decide; "hellinger" compares their square roots, as befits shares.

    Attributes
    ----------
    words_ : list of (w_f, b) float64
        The words of each level as histograms, w_f of at most 2^f. Where a cluster holds equal descriptions
        only, it stays whole and its level has fewer words.
    parents_ : list of (w_f,) int32
        For each word, the word of the level above whose cluster it was split from; 0 at the first level.
    clusters_ : (s, n_levels) int32
        The word behind which each training segment lies, at each level.
    n_features_in_ : int
        Number of bins, b.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "n_levels": [whole_number(1, MAX_LEVELS)],
        "metric": [choice(*METRICS)],
    }

    def __init__(self, n_levels: int = 2, metric: str = "hellinger") -> None:
        self.n_levels = n_levels
        self.metric = metric

    def fit(self, X: ArrayLike, y: object = None) -> SegmentDictionary:
        """Learn the words.

        Parameters
        ----------
        X : (s, b) array-like
            Descriptions of segments: non-negative histograms.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If a parameter is out of range, or X is no matrix of finite non-negative numbers.

        Warns
        -----
        UserWarning
            If there are fewer different descriptions than words at the last level.
        """
        check_parameters(self)
        n_levels = self.n_levels
        rows = self._embed(X, reset=True)
        # In an order that only their content decides, sums round alike however the segments come in.
        order = np.lexsort(rows.T[::-1])
        rows = rows[order]
        with libraries_in_one_thread():
            clusters = divide(rows, n_levels)
        self.clusters_: NDArray[np.int32] = np.empty_like(clusters)
        self.clusters_[order] = clusters
        self._set_words([_means(rows, clusters[:, level]) for level in range(n_levels)])
        self.parents_: list[NDArray[np.int32]] = [
            clusters[np.unique(clusters[:, level], return_index=True)[1], level - 1]
            if level
            else np.zeros(clusters[:, 0].max() + 1, np.int32)
            for level in range(n_levels)
        ]
        n_different = 1 + int((rows[1:] != rows[:-1]).any(axis=1).sum())
        if n_different < 2**n_levels:
            warnings.warn(
                f"{n_different} different segment descriptions give {len(self.words_[-1])} of "
                f"{2**n_levels} words at dictionary level {n_levels}",
                stacklevel=2,
            )
        return self

    def transform(self, X: ArrayLike) -> NDArray[np.int32]:
        """Nearest word of each segment at each level.

        Parameters
        ----------
        X : (s, b) array-like
            Descriptions of segments.

        Returns
        -------
        (s, n_levels) int32
            Numbers of words within their levels.

        Raises
        ------
        ValueError
            If X has another number of bins than the words, or is not finite and non-negative.
        """
        check_is_fitted(self)
        return nearest_words(self._embed(X, reset=False), self._embedded_words, self._level_starts)

    def members(self, level: int, word: int) -> NDArray[np.int64]:
        """Training segments behind a word: rows of the X that the dictionary was learned from.

        Parameters
        ----------
        level : int
            Dictionary level, from 1.
        word : int
            Number of the word within the level, from 0.

        Raises
        ------
        ValueError
            If there is no such level or word.
        """
        check_is_fitted(self)
        if not 1 <= level <= len(self.words_):
            raise ValueError(f"level must be between 1 and {len(self.words_)}, got {level!r}")
        if not 0 <= word < len(self.words_[level - 1]):
            raise ValueError(
                f"word must be between 0 and {len(self.words_[level - 1]) - 1} at level {level}, got {word!r}"
            )
        return np.flatnonzero(self.clusters_[:, level - 1] == word)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns of `transform`: "d1", "d2" ..."""
        check_is_fitted(self)
        return np.array([f"d{level}" for level in range(1, len(self.words_) + 1)], dtype=object)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.positive_only = True
        tags.transformer_tags.preserves_dtype = []
        return tags

    def _embed(self, X: ArrayLike, *, reset: bool) -> NDArray[np.float64]:
        """Points between which the metric is L2."""
        rows = validate_data(self, X, reset=reset, dtype=np.float64, ensure_non_negative=True, order="C")
        metric = self.metric if reset else self._learned_metric
        return np.sqrt(rows) if metric == "hellinger" else rows

    def _set_words(self, embedded: list[NDArray[np.float64]]) -> None:
        # What new segments are compared under, whatever the parameter is set to later.
        self._learned_metric = self.metric
        self.words_: list[NDArray[np.float64]] = [
            level**2 if self.metric == "hellinger" else level for level in embedded
        ]
        self._embedded_words = np.concatenate(embedded)
        self._level_starts = np.concatenate([[0], np.cumsum([len(level) for level in embedded])])


def _means(rows: NDArray[np.float64], clusters: NDArray[np.int32]) -> NDArray[np.float64]:
    return np.stack([rows[clusters == cluster].mean(axis=0) for cluster in range(clusters.max() + 1)])
