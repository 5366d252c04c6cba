"""The hierarchical dictionary of visual words."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from sklearn.base import clone
from sklearn.cluster import KMeans
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import OneHotEncoder
from sklearn.utils.estimator_checks import parametrize_with_checks

from shapeconcepts import SegmentDictionary

METRICS = ["hellinger", "euclidean"]
every_metric = pytest.mark.parametrize("metric", METRICS)
few_words_are_no_news = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")


def histograms(seed: int, n: int, n_bins: int = 7) -> np.ndarray:
    return np.random.default_rng(seed).dirichlet(np.full(n_bins, 0.5), n)


def embedded(X: np.ndarray, metric: str) -> np.ndarray:
    return np.sqrt(X) if metric == "hellinger" else np.asarray(X, float)


def principal_halves(rows: np.ndarray) -> np.ndarray:
    """Which rows lie on the far side of the mean along the axis of largest variance."""
    values, vectors = np.linalg.eigh(np.cov(rows.T, bias=True))
    axis = vectors[:, values.argmax()]
    axis = axis * np.sign(axis[np.abs(axis).argmax()])
    return (rows - rows.mean(axis=0)) @ axis > 0


def kmeans_halves(rows: np.ndarray) -> np.ndarray:
    """2-means of scikit-learn from the same two centres."""
    far = principal_halves(rows)
    centres = np.stack([rows[~far].mean(axis=0), rows[far].mean(axis=0)])
    return KMeans(2, init=centres, n_init=1, tol=0, algorithm="lloyd").fit(rows).labels_ == 1


@few_words_are_no_news
@parametrize_with_checks([SegmentDictionary(n_levels=3), SegmentDictionary(8, metric="euclidean")])
def test_scikit_learn_contract(estimator, check):
    check(estimator)


@every_metric
def test_levels_and_words(metric):
    X = histograms(0, 300)
    dictionary = SegmentDictionary(4, metric).fit(X)
    assert [len(words) for words in dictionary.words_] == [2, 4, 8, 16]
    assert dictionary.n_features_in_ == 7
    assert dictionary.clusters_.shape == (300, 4) and dictionary.clusters_.dtype == np.int32
    for level, words in enumerate(dictionary.words_):
        for word in range(len(words)):
            behind = embedded(X, metric)[dictionary.clusters_[:, level] == word]
            centre = behind.mean(axis=0)
            np.testing.assert_allclose(
                words[word], centre**2 if metric == "hellinger" else centre, atol=1e-12
            )


@every_metric
@pytest.mark.parametrize("seed", range(8))
def test_splits_are_those_of_kmeans(metric, seed):
    X = histograms(seed, 160, n_bins=5)
    dictionary = SegmentDictionary(4, metric).fit(X)
    rows = embedded(X, metric)
    parents = np.zeros(len(X), int)
    for level in range(4):
        clusters = dictionary.clusters_[:, level]
        for parent in np.unique(parents):
            members = np.flatnonzero(parents == parent)
            if len(members) > 1:
                numbers, halves = np.unique(clusters[members], return_inverse=True)
                assert numbers[1] == numbers[0] + 1
                np.testing.assert_array_equal(halves == 1, kmeans_halves(rows[members]))
        parents = clusters


@every_metric
def test_parents_clusters_and_members_tell_the_same(metric):
    dictionary = SegmentDictionary(5, metric).fit(histograms(1, 200))
    clusters = dictionary.clusters_
    assert (dictionary.parents_[0] == 0).all()
    for level in range(1, 6):
        words, parents = dictionary.words_[level - 1], dictionary.parents_[level - 1]
        assert len(parents) == len(words)
        assert (np.diff(parents) >= 0).all()
        every_row = np.concatenate([dictionary.members(level, word) for word in range(len(words))])
        assert sorted(every_row) == list(range(200))
        for word in range(len(words)):
            members = dictionary.members(level, word)
            assert len(members) > 0
            np.testing.assert_array_equal(members, np.flatnonzero(clusters[:, level - 1] == word))
            if level > 1:
                assert set(members) <= set(dictionary.members(level - 1, parents[word]))


@every_metric
def test_words_are_the_nearest(metric):
    dictionary = SegmentDictionary(5, metric).fit(histograms(2, 250))
    X = histograms(3, 100)
    expected = [
        np.linalg.norm(embedded(X, metric)[:, None] - embedded(words, metric), axis=2).argmin(axis=1)
        for words in dictionary.words_
    ]
    words = dictionary.transform(X)
    assert words.dtype == np.int32
    np.testing.assert_array_equal(words, np.stack(expected, axis=1))
    np.testing.assert_array_equal(np.concatenate([dictionary.transform(row[None]) for row in X]), words)


def test_metrics_differ():
    X, other = histograms(2, 250), histograms(3, 100)
    a, b = (SegmentDictionary(5, metric).fit(X).transform(other) for metric in METRICS)
    assert (a != b).any()


@pytest.mark.parametrize(("first", "then"), [METRICS, METRICS[::-1]])
def test_another_metric_waits_for_the_next_fit(first, then):
    X, other = histograms(2, 250), histograms(3, 100)
    dictionary = SegmentDictionary(5, first).fit(X)
    words = dictionary.transform(other)
    np.testing.assert_array_equal(dictionary.set_params(metric=then).transform(other), words)
    fresh = SegmentDictionary(5, then).fit(X)
    np.testing.assert_array_equal(dictionary.fit(X).transform(other), fresh.transform(other))


@few_words_are_no_news
@settings(max_examples=40, deadline=None)
@given(
    X=st_numpy.arrays(
        float,
        st.tuples(st.integers(1, 14), st.integers(1, 4)),
        elements=st.sampled_from([0.0, 1.0, 2.0, 1 / 3, 0.1]),
    ),
    metric=st.sampled_from(METRICS),
    n_levels=st.integers(1, 4),
    data=st.data(),
)
def test_order_of_segments_does_not_matter(X, metric, n_levels, data):
    order = np.array(data.draw(st.permutations(range(len(X)))))
    a = SegmentDictionary(n_levels, metric).fit(X)
    b = SegmentDictionary(n_levels, metric).fit(X[order])
    assert [words.tobytes() for words in a.words_] == [words.tobytes() for words in b.words_]
    np.testing.assert_array_equal(a.clusters_[order], b.clusters_)
    for one, other in zip(a.parents_, b.parents_, strict=True):
        np.testing.assert_array_equal(one, other)
    # A cluster is split exactly where it holds different rows.
    for level, words in enumerate(a.words_):
        assert len(words) <= min(2 ** (level + 1), len(np.unique(X, axis=0)))
        above = a.clusters_[:, level - 1] if level else np.zeros(len(X))
        for cluster in np.unique(above):
            members = above == cluster
            n_halves = len(np.unique(a.clusters_[members, level]))
            assert n_halves == min(2, len(np.unique(X[members], axis=0)))


@every_metric
def test_many_permuted_rows_give_the_same_bits(metric):
    X = histograms(4, 400)
    order = np.random.default_rng(0).permutation(400)
    a, b = SegmentDictionary(6, metric).fit(X), SegmentDictionary(6, metric).fit(X[order])
    assert all(one.tobytes() == other.tobytes() for one, other in zip(a.words_, b.words_, strict=True))
    np.testing.assert_array_equal(a.clusters_[order], b.clusters_)


@every_metric
def test_fewer_segments_than_words(metric):
    X = np.repeat(histograms(5, 3), 4, axis=0)
    with pytest.warns(UserWarning, match="3 different segment descriptions give 3 of 8 words"):
        dictionary = SegmentDictionary(3, metric).fit(X)
    assert [len(words) for words in dictionary.words_] == [2, 3, 3]
    np.testing.assert_array_equal(dictionary.transform(X), dictionary.clusters_)


@every_metric
@pytest.mark.parametrize("n", [1, 5])
def test_one_description(metric, n):
    X = np.repeat(histograms(6, 1), n, axis=0)
    with pytest.warns(UserWarning, match="1 different segment descriptions give 1 of 4 words"):
        dictionary = SegmentDictionary(2, metric).fit(X)
    assert [len(words) for words in dictionary.words_] == [1, 1]
    np.testing.assert_allclose(dictionary.words_[1], X[:1])
    assert [parents.tolist() for parents in dictionary.parents_] == [[0], [0]]
    assert dictionary.transform(histograms(7, 3)).tolist() == [[0, 0]] * 3
    assert dictionary.members(2, 0).tolist() == list(range(n))


@few_words_are_no_news
def test_segments_without_mass():
    dictionary = SegmentDictionary(2).fit(np.vstack([histograms(8, 5), np.zeros((3, 7))]))
    word = dictionary.transform(np.zeros((1, 7)))[0]
    assert {5, 6, 7} <= set(dictionary.members(2, word[1]))


@pytest.mark.parametrize("call", ["fit", "transform"])
@pytest.mark.parametrize(
    ("X", "message"),
    [
        ([[np.nan, 1.0]], "NaN"),
        ([[np.inf, 1.0]], "infinity"),
        ([[-0.5, 1.0], [0.5, 0.5]], "Negative values"),
        ([0.5, 0.5], "2D array"),
        (np.empty((0, 2)), "0 sample"),
        ([["a", "b"]], "could not convert"),
    ],
)
def test_wrong_descriptions_are_refused(call, X, message):
    dictionary = SegmentDictionary(1).fit(histograms(9, 10, n_bins=2))
    with pytest.raises(ValueError, match=message):
        getattr(dictionary, call)(X)


def test_another_number_of_bins_is_refused():
    with pytest.raises(ValueError, match=r"3 features.*7 features"):
        SegmentDictionary(1).fit(histograms(9, 10)).transform(histograms(9, 10, n_bins=3))


@pytest.mark.parametrize("n_levels", [0, -1, 17, 1.5, True, "2", None])
def test_wrong_number_of_levels_is_refused(n_levels):
    message = r"The 'n_levels' parameter of SegmentDictionary must be an int in the range \[1, 16\]\. "
    with pytest.raises(ValueError, match=message + f"Got '?{n_levels}'? instead"):
        SegmentDictionary(n_levels).fit(histograms(9, 10))


@few_words_are_no_news
def test_numbers_of_levels():
    assert len(SegmentDictionary().fit(histograms(9, 40)).words_) == 2
    for n_levels in (1, np.int64(3), 8, 16):
        assert len(SegmentDictionary(n_levels).fit(histograms(9, 40)).words_) == n_levels


@pytest.mark.parametrize("metric", ["cosine", None, 2])
def test_wrong_metric_is_refused(metric):
    message = "The 'metric' parameter of SegmentDictionary must be a str among {'(hellinger|euclidean)', "
    with pytest.raises(ValueError, match=message + f"'(hellinger|euclidean)'}}. Got '?{metric}'? instead"):
        SegmentDictionary(1, metric).fit(histograms(9, 10))


@pytest.mark.parametrize(("level", "word"), [(0, 0), (3, 0), (1, 2), (2, 4), (1, -1)])
def test_wrong_words_are_refused(level, word):
    dictionary = SegmentDictionary(2).fit(histograms(9, 30))
    with pytest.raises(ValueError, match=r"(level|word) must be between"):
        dictionary.members(level, word)


def test_not_fitted():
    dictionary = SegmentDictionary()
    for call in (
        lambda: dictionary.transform(histograms(0, 2)),
        lambda: dictionary.members(1, 0),
        dictionary.get_feature_names_out,
    ):
        with pytest.raises(NotFittedError):
            call()


def test_as_an_estimator():
    X = histograms(10, 60)
    dictionary = SegmentDictionary(n_levels=3, metric="euclidean")
    assert dictionary.get_params() == {"n_levels": 3, "metric": "euclidean"}
    copy = clone(dictionary).set_params(n_levels=2)
    assert (copy.n_levels, copy.metric, dictionary.n_levels) == (2, "euclidean", 3)
    words = dictionary.fit_transform(X)
    np.testing.assert_array_equal(words, dictionary.transform(X))
    assert dictionary.get_feature_names_out().tolist() == ["d1", "d2", "d3"]
    again = pickle.loads(pickle.dumps(dictionary))
    np.testing.assert_array_equal(again.transform(X), words)
    pipeline = make_pipeline(dictionary, OneHotEncoder()).fit(X)
    assert pipeline.get_feature_names_out()[0] == "d1_0"


def test_learning_again_forgets():
    dictionary = SegmentDictionary(3).fit(histograms(11, 80, n_bins=4))
    fresh = SegmentDictionary(3).fit(histograms(12, 50))
    dictionary.fit(histograms(12, 50))
    assert dictionary.n_features_in_ == 7
    np.testing.assert_array_equal(
        dictionary.transform(histograms(13, 30)), fresh.transform(histograms(13, 30))
    )
