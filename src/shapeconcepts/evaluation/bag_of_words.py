"""Bags of FPFH words and their topics: the classic of unsupervised object discovery in robotics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.cluster import MiniBatchKMeans
from sklearn.decomposition import LatentDirichletAllocation

from shapeconcepts.descriptors import FPFH, compute_fpfh
from shapeconcepts.evaluation.groupings.grouping import Grouping, without_small_groups
from shapeconcepts.parallel import libraries_in_one_thread
from shapeconcepts.parameters import check_integer
from shapeconcepts.segmentation.segmented_object import SegmentedObject

_POINTS_PER_OBJECT = 100
_HELD_OUT_SHARE = 0.2
# Numbers of topics that are tried, as shares of the most groups that are allowed.
_TOPIC_SHARES = (0.15, 0.25, 0.5, 0.75, 1.0)


def point_histograms(segmented: SegmentedObject) -> NDArray[np.float64]:
    """Square roots of the Fast Point Feature Histograms of an object's points, each of length 1.

    Returns
    -------
    (k, 33) float64
        In the order of the points; those without neighbours are left out.
    """
    histograms = compute_fpfh(segmented.points, segmented.normals, FPFH().radius)
    mass = histograms.sum(axis=1, keepdims=True)
    return np.sqrt((histograms / np.where(mass > 0, mass, 1))[mass[:, 0] > 0])


@dataclass
class TopicModel:
    """Objects as bags of visual words, mixed from topics (Endres et al., RSS 2009; Blei et al., JMLR 2003).

    The words are the centres of k-means over points of the training objects. The number of topics is chosen
    by the perplexity of a fifth of the training objects that is held out.

    Parameters
    ----------
    max_groups : int
        Most topics, at least 2.
    n_words : int
        Size of the vocabulary, at least 2.
    random_state : int
        Seed of k-means, of the objects that are held out, and of the topics.

    Attributes
    ----------
    grouping_ : Grouping
        Each training object's topic of the largest share.
    rows_ : (n, n_topics) float64
        Shares of topics in the training objects; they sum to 1.
    """

    max_groups: int
    n_words: int = 100
    random_state: int = 0
    grouping_: Grouping = field(init=False)
    rows_: NDArray[np.float64] = field(init=False)
    _words: Any = field(init=False, repr=False)
    _topics: Any = field(init=False, repr=False)

    def fit(self, objects: Sequence[NDArray[np.float64]]) -> TopicModel:
        """Learn words and topics.

        Parameters
        ----------
        objects : sequence of (k, 33) arrays
            As `point_histograms` gives them.

        Raises
        ------
        ValueError
            If there are fewer than five objects, none of their points has a histogram, or a parameter is out
            of range.
        """
        check_integer("max_groups", self.max_groups, 2)
        check_integer("n_words", self.n_words, 2)
        if len(objects) < 5:
            raise ValueError(f"objects must be at least 5, got {len(objects)}")
        sample = np.concatenate([one[:: max(1, len(one) // _POINTS_PER_OBJECT)] for one in objects])
        n_words = min(self.n_words, len(np.unique(sample, axis=0)))
        if n_words == 0:
            raise ValueError("objects must have points with histograms, got none")
        with libraries_in_one_thread():
            self._words = MiniBatchKMeans(n_words, n_init=3, random_state=self.random_state).fit(sample)
            counts = self._counts(objects)
            n_topics = self._number_of_topics(counts)
            self._topics = self._allocation(n_topics).fit(counts)
            self.rows_ = self._topics.transform(counts)
        labels = without_small_groups(self.rows_.argmax(axis=1), min_size=2)
        self.grouping_ = Grouping(labels, {"words": n_words, "topics": n_topics})
        return self

    def transform(self, objects: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Shares of topics in objects, (m, n_topics) float64; rows sum to 1."""
        with libraries_in_one_thread():
            return self._topics.transform(self._counts(objects))

    def _counts(self, objects: Sequence[NDArray[np.float64]]) -> NDArray[np.int64]:
        n_words = len(self._words.cluster_centers_)
        return np.stack(
            [
                np.bincount(self._words.predict(one), minlength=n_words)
                if len(one)
                else np.zeros(n_words, np.int64)
                for one in objects
            ]
        )

    def _number_of_topics(self, counts: NDArray[np.int64]) -> int:
        order = np.random.default_rng(self.random_state).permutation(len(counts))
        held_out, used = np.split(order, [max(1, round(_HELD_OUT_SHARE * len(counts)))])
        candidates = sorted({max(2, round(share * self.max_groups)) for share in _TOPIC_SHARES})
        perplexities = [
            self._allocation(n_topics).fit(counts[used]).perplexity(counts[held_out])
            for n_topics in candidates
        ]
        return candidates[int(np.argmin(perplexities))]

    def _allocation(self, n_topics: int) -> Any:
        return LatentDirichletAllocation(n_topics, learning_method="batch", random_state=self.random_state)
