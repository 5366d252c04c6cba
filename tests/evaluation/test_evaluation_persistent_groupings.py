"""Groupings that choose by themselves what persists: PLSCAN and our filtration."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from scipy.sparse import csr_matrix
from scipy.spatial.distance import cdist
from sklearn.cluster import HDBSCAN
from sklearn.metrics import adjusted_rand_score

from shapeconcepts import Filtration
from shapeconcepts.evaluation import our_filtration, our_filtration_by_silhouette, plscan
from shapeconcepts.topology import jensen_shannon_divergences

TRUTH = np.repeat(np.arange(4), 20)


def blobs(spread: float = 0.5) -> np.ndarray:
    rng = np.random.default_rng(0)
    return np.array([[0, 0], [6, 0], [0, 6], [6, 6]])[TRUTH] + rng.normal(0, spread, (80, 2))


def histograms(seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    raw = rng.dirichlet(np.ones(8), 80) * 0.03 + (np.eye(4, 8) + 0.05)[TRUTH]
    return raw / raw.sum(axis=1, keepdims=True)


def test_plscan_finds_separate_kinds() -> None:
    grouping = plscan(cdist(blobs(), blobs()), 10)
    assert adjusted_rand_score(TRUTH, grouping.labels) == 1
    assert grouping.n_groups == 4


def test_plscan_is_hdbscan_at_one_of_its_scales() -> None:
    of = blobs(spread=1.4)
    grouping = plscan(cdist(of, of), 10)
    scores = []
    for size in range(5, 40):
        clusterer = HDBSCAN(size, min_samples=6, cluster_selection_method="leaf", copy=True)
        scores.append(adjusted_rand_score(clusterer.fit_predict(of), grouping.labels))
    assert max(scores) > 0.95


def test_plscan_takes_another_scale_where_the_groups_are_too_many() -> None:
    centres = np.repeat(np.arange(12), 10)[:, None] * [10.0, 0]
    of = centres + np.random.default_rng(0).normal(0, 0.1, (120, 2))
    assert plscan(cdist(of, of), 12).n_groups == 12
    assert plscan(cdist(of, of), 4).n_groups <= 4


@settings(deadline=None, max_examples=30)
@given(
    st_numpy.arrays(float, st.tuples(st.integers(2, 25), st.just(2)), elements=st.integers(0, 4)),
    st.integers(2, 5),
)
def test_any_distances_are_grouped_within_the_limit(points, max_groups) -> None:
    between = cdist(points, points)
    grouping = plscan(between, max_groups)
    sizes = np.bincount(grouping.labels[grouping.labels >= 0])
    assert grouping.labels.shape == (len(points),)
    assert len(sizes) == grouping.n_groups <= max_groups
    assert (sizes >= 2).all()
    assert np.array_equal(grouping.labels, plscan(between, max_groups).labels)


def test_equal_rows_are_one_group() -> None:
    places = np.repeat([[0.0, 0], [1, 0]], 15, axis=0)
    assert plscan(cdist(places, places), 5).n_groups == 2


def test_unsuitable_distances_are_refused() -> None:
    good = cdist(blobs(), blobs())
    with pytest.raises(ValueError, match="max_groups must be an integer of at least 2, got 1"):
        plscan(good, 1)
    with pytest.raises(ValueError, match="finite, at least 0 and symmetric"):
        plscan(good - 1, 5)


def test_our_filtration_is_that_of_the_default_preset() -> None:
    rows = histograms()
    grouping = our_filtration(rows)
    assert grouping.labels.tolist() == Filtration().fit(rows).labels_.tolist()
    assert grouping.labels.tolist() == our_filtration(csr_matrix(rows)).labels.tolist()


def test_the_silhouette_says_where_our_filtration_is_cut() -> None:
    rows = histograms()
    distances = np.sqrt(jensen_shannon_divergences(rows))
    distances = (distances + distances.T) / 2
    grouping = our_filtration_by_silhouette(rows, distances, 9)
    assert adjusted_rand_score(TRUTH, grouping.labels) == 1
    cut = Filtration().fit(rows).at_granularity(grouping.parameters["granularity"])
    assert grouping.labels.tolist() == cut.labels_.tolist()
    assert our_filtration_by_silhouette(rows, distances, 2).n_groups <= 2
    with pytest.raises(ValueError, match="max_groups must be an integer of at least 2"):
        our_filtration_by_silhouette(rows, distances, 1)


def test_a_row_of_zeros_is_in_no_group() -> None:
    grouping = our_filtration(np.vstack([histograms(), np.zeros(8)]))
    assert grouping.labels[-1] == -1
    assert grouping.n_groups >= 1


def test_no_group_is_a_result_too() -> None:
    grouping = our_filtration(histograms()[[0, 20]])
    assert grouping.labels.tolist() == [-1, -1]
    assert grouping.n_groups == 0
