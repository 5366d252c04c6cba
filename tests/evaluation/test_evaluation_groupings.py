"""The usual ways to group, against scikit-learn, SciPy and GUDHI on their own."""

import numpy as np
import pytest
from gudhi.clustering.tomato import Tomato
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from scipy.spatial.distance import cdist
from sklearn.cluster import HDBSCAN, AgglomerativeClustering, KMeans
from sklearn.metrics import adjusted_rand_score, silhouette_score

from shapeconcepts.evaluation import average_linkage, hdbscan, k_means, leiden, most_groups, tomato
from shapeconcepts.evaluation.groupings.grouping import mean_silhouette, without_small_groups

ON_DISTANCES = (average_linkage, hdbscan, tomato, leiden)
CHOICES = ("silhouette", "most groups")
every_method = pytest.mark.parametrize("method", ON_DISTANCES)
every_choice = pytest.mark.parametrize("choice", CHOICES)
TRUTH = np.repeat(np.arange(5), 12)


def blobs(seed: int = 0, spread: float = 0.03) -> np.ndarray:
    """Histograms of five kinds."""
    rng = np.random.default_rng(seed)
    centres = np.eye(5, 8) + 0.05
    return rng.dirichlet(np.ones(8), 60) * spread + (centres / centres.sum(1, keepdims=True))[TRUTH]


def rows(seed: int = 0, spread: float = 0.03) -> np.ndarray:
    raw = blobs(seed, spread)
    return raw / raw.sum(axis=1, keepdims=True)


def distances(of: np.ndarray) -> np.ndarray:
    return cdist(np.sqrt(of), np.sqrt(of))


@every_method
def test_separate_kinds_are_found(method) -> None:
    grouping = method(distances(rows()), 10)
    assert adjusted_rand_score(TRUTH, grouping.labels) == 1
    assert grouping.n_groups == 5


def test_separate_kinds_are_found_by_k_means() -> None:
    grouping = k_means(rows(), 10)
    assert adjusted_rand_score(TRUTH, grouping.labels) == 1
    assert grouping.parameters == {"clusters": 5}


@settings(deadline=None, max_examples=30)
@given(
    st_numpy.arrays(float, st.tuples(st.integers(2, 25), st.just(2)), elements=st.integers(0, 4)),
    st.integers(2, 5),
    st.sampled_from(CHOICES),
)
def test_any_distances_are_grouped_within_the_limit(points, max_groups, choice) -> None:
    between = cdist(points, points)
    for method in ON_DISTANCES:
        grouping = method(between, max_groups, choice)
        sizes = np.bincount(grouping.labels[grouping.labels >= 0])
        assert len(grouping.labels) == len(points)
        assert grouping.labels.min() >= -1
        assert len(sizes) == grouping.n_groups <= max_groups
        assert (sizes >= 2).all()
        assert np.array_equal(grouping.labels, method(between, max_groups, choice).labels)


@settings(deadline=None, max_examples=15)
@given(
    st_numpy.arrays(float, st.tuples(st.integers(2, 12), st.just(3)), elements=st.integers(0, 3)),
    st.integers(2, 4),
    st.sampled_from(CHOICES),
)
def test_k_means_groups_any_rows_within_the_limit(points, max_groups, choice) -> None:
    grouping = k_means(points, max_groups, choice)
    sizes = np.bincount(grouping.labels[grouping.labels >= 0])
    assert len(sizes) <= max_groups and (sizes >= 2).all()
    assert np.array_equal(grouping.labels, k_means(points, max_groups, choice).labels)


@pytest.mark.parametrize("seed", [0, 1, 2])
@every_choice
def test_average_linkage_is_scikit_learns_best_cut(seed, choice) -> None:
    between = distances(rows(seed, spread=1.0))
    grouping = average_linkage(between, 7, choice)
    clusterings = {}
    for n in range(1, len(between) + 1):
        clusterer = AgglomerativeClustering(n, metric="precomputed", linkage="average")
        labels = without_small_groups(clusterer.fit_predict(between), 2)
        if labels.max() < 7:
            clusterings[n] = labels
    if choice == "silhouette":
        value = max(mean_silhouette(between, labels) for labels in clusterings.values())
        assert mean_silhouette(between, grouping.labels) == pytest.approx(value)
    else:
        best = max((labels.max() + 1, (labels >= 0).sum()) for labels in clusterings.values())
        assert (grouping.n_groups, (grouping.labels >= 0).sum()) == best
    assert adjusted_rand_score(grouping.labels, clusterings[grouping.parameters["clusters"]]) == 1


@every_choice
def test_hdbscan_is_scikit_learns(choice) -> None:
    between = distances(rows(3, spread=0.6))
    grouping = hdbscan(between, 9, choice)
    results = {
        size: HDBSCAN(min_cluster_size=size, metric="precomputed", copy=True).fit_predict(between)
        for size in range(3, 9)
    }
    chosen = results[grouping.parameters["min_cluster_size"]]
    assert grouping.labels.tolist() == chosen.tolist()
    others = [labels for labels in results.values() if labels.max() < 9]
    score = (lambda labels: mean_silhouette(between, labels)) if choice == "silhouette" else np.max
    assert score(chosen) == max(map(score, others))


def test_hdbscan_raises_its_size_until_the_groups_fit() -> None:
    centres = np.repeat(np.arange(12), 10)[:, None] * 10.0
    points = centres + np.random.default_rng(0).normal(0, 0.1, (120, 1))
    grouping = hdbscan(cdist(points, points), 4)
    assert grouping.parameters["min_cluster_size"] > 8
    assert grouping.n_groups <= 4


def test_tomato_is_gudhis() -> None:
    between = distances(rows(4, spread=0.8))
    grouping = tomato(between, 6, "most groups")
    k = grouping.parameters["neighbours"]
    order = np.argsort(between, axis=1)[:, 1 : k + 1]
    density = -np.log((np.take_along_axis(between, order, 1) ** 2).mean(1))
    edges = {(i, int(j)) for i, row in enumerate(order) for j in row}
    graph = [[j for j in range(60) if (i, j) in edges or (j, i) in edges] for i in range(60)]
    clusterer = Tomato(graph_type="manual", density_type="manual", n_clusters=6).fit(graph, weights=density)
    assert adjusted_rand_score(clusterer.labels_, grouping.labels) == 1
    assert grouping.n_groups >= 2


def test_tomato_joins_more_neighbours_until_the_groups_fit() -> None:
    centres = np.repeat(np.arange(9), 18)[:, None] * 10.0
    points = centres + np.random.default_rng(0).normal(0, 0.1, (162, 1))
    grouping = tomato(cdist(points, points), 4)
    assert grouping.parameters["neighbours"] > 16
    assert grouping.n_groups <= 4


@every_choice
def test_k_means_is_scikit_learns_on_square_roots(choice) -> None:
    of = rows(5, spread=0.8)
    grouping = k_means(of, 6, choice)
    points = np.sqrt(of)
    results = {n: KMeans(n, n_init=10, random_state=0).fit_predict(points) for n in range(2, 7)}
    best = max(results, key=lambda n: silhouette_score(points, results[n])) if choice == "silhouette" else 6
    assert grouping.parameters == {"clusters": best}
    assert adjusted_rand_score(grouping.labels, without_small_groups(results[best], 2)) == 1


def test_the_silhouette_counts_objects_in_no_group_as_0() -> None:
    between = distances(rows())
    labels = TRUTH.copy()
    assert mean_silhouette(between, labels) == pytest.approx(
        silhouette_score(between, labels, metric="precomputed")
    )
    labels[:12] = -1
    of_others = silhouette_score(between[12:, 12:], labels[12:], metric="precomputed")
    assert mean_silhouette(between, labels) == pytest.approx(of_others * 48 / 60)
    assert mean_silhouette(between, np.zeros(60, int)) == -1


def test_the_limit_on_groups() -> None:
    assert [most_groups(n) for n in (3, 16, 57, 360, 5000)] == [2, 2, 7, 36, 36]


def test_small_groups_are_dropped_and_the_others_numbered() -> None:
    assert without_small_groups([4, 4, 9, -1, -1, 6, 6, 6], 2).tolist() == [0, 0, -1, -1, -1, 1, 1, 1]
    assert without_small_groups([4, 4, 9, -1, -1, 6, 6, 6], 4).tolist() == [-1] * 8


@every_method
def test_unsuitable_input_is_refused(method) -> None:
    good = distances(rows())
    with pytest.raises(ValueError, match="max_groups must be an integer of at least 2, got 1"):
        method(good, 1)
    with pytest.raises(ValueError, match=r"choice must be one of 'silhouette', 'most groups', got 'best'"):
        method(good, 5, "best")
    with pytest.raises(ValueError, match=r"square matrix of at least 2 rows, got shape \(60, 59\)"):
        method(good[:, 1:], 5)
    for odd in (good - 1, np.triu(good), np.where(good > 0, np.nan, 0)):
        with pytest.raises(ValueError, match="finite, at least 0 and symmetric"):
            method(odd, 5)


def test_unsuitable_rows_are_refused_by_k_means() -> None:
    with pytest.raises(ValueError, match="finite numbers of at least 0"):
        k_means(-rows(), 5)
    with pytest.raises(ValueError, match=r"at least 2 rows, got shape \(1, 8\)"):
        k_means(rows()[:1], 5)
    with pytest.raises(ValueError, match="max_groups must be an integer of at least 2, got 1"):
        k_means(rows(), 1)
