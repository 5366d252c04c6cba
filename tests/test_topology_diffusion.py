"""Diffusion among nearest neighbours, against lists and dictionaries."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from shapeconcepts import Diffusion
from topology_reference import random_rows, slow_divergence, uniform_rows


def shares(row: np.ndarray) -> np.ndarray:
    return row / row.sum() if row.any() else row


def slow_diffusion(
    training: np.ndarray, rows: np.ndarray, n_neighbours: int | None
) -> list[np.ndarray | None]:
    """None where rounding decides which of equally near rows is a neighbour."""
    training = [shares(row) for row in training if row.any()]
    n = n_neighbours or max(1, round(math.sqrt(len(training)) / 2))
    places = {tuple(row.tolist()): row for row in training}
    means = []
    for row in map(shares, rows):
        near = sorted(
            ((slow_divergence(row, other), key) for key, other in places.items()), key=lambda pair: pair[0]
        )
        near = [(d, key) for d, key in near if 1e-9 < d < 1 - 1e-12]
        if not row.any():
            means.append(row)
        elif len(near) > n and near[n][0] - near[n - 1][0] < 1e-9:
            means.append(None)
        else:
            near = near[:n]
            total = row + sum(math.exp(-2 * d / near[-1][0]) * places[key] for d, key in near)
            means.append(total / total.sum())
    return means


def same_bits(a, b) -> bool:
    return a.shape == b.shape and all(
        getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in ("data", "indices", "indptr")
    )


@settings(max_examples=80, deadline=None)
@given(
    n=st.integers(1, 40),
    seed=st.integers(0, 10**6),
    kind=st.sampled_from(["random", "sparse", "uniform", "disjoint", "equal"]),
    n_neighbours=st.sampled_from([None, 1, 2, 5, 100]),
)
def test_against_lists(n, seed, kind, n_neighbours):
    rng = np.random.default_rng(seed)
    training, new = {
        "random": lambda: np.split(random_rows(rng, n + 9, 8, 0.7), [n]),
        "sparse": lambda: np.split(random_rows(rng, n + 9, 8, 0.15), [n]),
        "uniform": lambda: np.split(uniform_rows(rng, n + 9, 7, 3), [n]),
        "disjoint": lambda: (np.eye(n), np.eye(n)[:9]),
        "equal": lambda: (np.ones((n, 3)), np.ones((2, 3))),
    }[kind]()
    training[:: max(n // 3, 2)] = training[0] * 2.0
    diffusion = Diffusion(n_neighbours).fit(training)
    for rows in (training, new):
        found = diffusion.transform(rows)
        assert sparse.isspmatrix_csr(found) and found.shape == rows.shape and found.has_sorted_indices
        for one, expected in zip(found.toarray(), slow_diffusion(training, rows, n_neighbours), strict=True):
            if expected is not None:
                np.testing.assert_allclose(one, expected, atol=1e-9)
            np.testing.assert_allclose(one.sum(), 1 if one.any() else 0)


def test_weights():
    """The row itself counts 1, the farthest neighbour exp(-2), nearer ones more, others nothing."""
    rows = np.array([[8.0, 2, 0, 0], [7, 3, 0, 0], [3, 7, 0, 0], [0, 1, 9, 0], [0, 0, 0, 1]])
    near, far = slow_divergence(rows[0], rows[1]), slow_divergence(rows[0], rows[2])
    expected = shares(rows[0] / 10 + math.exp(-2 * near / far) * rows[1] / 10 + math.exp(-2) * rows[2] / 10)
    found = Diffusion(2).fit_transform(rows).toarray()
    np.testing.assert_allclose(found[0], expected)
    # What has nothing in common with any other stays as it is.
    np.testing.assert_array_equal(found[4], rows[4])


def test_number_of_neighbours():
    """Half the root of the number of rows that are not empty, distinct or not, but no more than 10."""
    rng = np.random.default_rng(0)
    for n, expected in ((1, 1), (8, 1), (10, 2), (64, 4), (100, 5), (900, 10)):
        rows = np.concatenate([random_rows(rng, n, 6, 0.9) + 0.01, np.zeros((50, 6))])
        assert Diffusion().fit(rows).n_neighbours_ == expected
        assert Diffusion().fit(np.ones((n, 2))).n_neighbours_ == expected
        assert Diffusion(7).fit(rows).n_neighbours_ == 7


@pytest.mark.parametrize("seed", range(5))
def test_a_row_does_not_depend_on_the_others(seed):
    """To the last bit, nor on how many there are, their order, their form, or whether it was trained with."""
    rng = np.random.default_rng(seed)
    training = random_rows(rng, 300, 20, 0.3)
    diffusion = Diffusion()
    trained = diffusion.fit_transform(training)
    assert same_bits(diffusion.transform(training), trained)
    rows = np.concatenate([random_rows(rng, 290, 20, 0.3), training])
    together = diffusion.transform(rows)
    assert same_bits(together[290:], trained)
    for i in range(0, len(rows), 7):
        assert same_bits(diffusion.transform(rows[[i]]), together[[i]])
    order = rng.permutation(len(rows))
    assert same_bits(diffusion.transform(rows[order]), together[order])
    for form in (sparse.csc_matrix, sparse.coo_matrix, sparse.csr_array):
        assert same_bits(diffusion.transform(form(rows)), together)
    assert same_bits(diffusion.transform(rows.tolist()), together)


def test_order_of_the_training_rows_does_not_matter():
    rng = np.random.default_rng(1)
    training, rows = random_rows(rng, 80, 10), random_rows(rng, 30, 10)
    found = Diffusion().fit(training).transform(rows)
    assert same_bits(Diffusion().fit(sparse.csr_matrix(training[::-1])).transform(rows), found)


def test_untidy_matrices_are_left_as_they_are():
    """Columns in any order, entries in several parts, and zeros."""
    tidy = sparse.csr_matrix(np.array([[1.0, 0, 2], [0, 3, 1], [1, 1, 0]]))
    values, columns = np.array([2.0, 1, 0, 1, 2, 1, 0, 1, 1]), np.array([2, 0, 1, 2, 1, 1, 2, 0, 1])
    untidy = sparse.csr_matrix((values, columns, [0, 3, 6, 9]), (3, 3))
    before = untidy.copy()
    np.testing.assert_array_equal(untidy.toarray(), tidy.toarray())
    assert same_bits(Diffusion().fit(tidy).transform(untidy), Diffusion().fit_transform(tidy))
    assert same_bits(Diffusion().fit(untidy).transform(tidy), Diffusion().fit_transform(tidy))
    assert same_bits(untidy, before)


def test_only_shares_count():
    rng = np.random.default_rng(2)
    training, rows = random_rows(rng, 40, 10), random_rows(rng, 20, 10)
    found = Diffusion().fit(training).transform(rows).toarray()
    scaled = Diffusion().fit(training * rng.uniform(0.1, 9, (40, 1))).transform(rows * 1e6).toarray()
    np.testing.assert_allclose(scaled, found, atol=1e-12)


@pytest.mark.parametrize(
    "training",
    [np.zeros((4, 3)), np.zeros((4, 0)), np.array([[1.0, 2, 0]]), np.tile([[1.0, 2, 0]], (9, 1)), np.eye(3)],
    ids=["empty rows", "no columns", "one row", "equal rows", "nothing in common"],
)
@pytest.mark.parametrize("form", [np.array, sparse.csr_matrix])
@pytest.mark.parametrize("n_neighbours", [None, 50])
def test_without_neighbours(training, form, n_neighbours):
    diffusion = Diffusion(n_neighbours).fit(form(training))
    expected = np.array([shares(row) for row in training]).reshape(training.shape)
    np.testing.assert_array_equal(diffusion.transform(form(training)).toarray(), expected)
    empty = np.zeros((2, training.shape[1]))
    np.testing.assert_array_equal(diffusion.transform(form(empty)).toarray(), empty)
    assert diffusion.transform(form(empty[:0])).shape == (0, training.shape[1])


def test_rows_that_differ_by_rounding_are_one():
    rows = np.array([[1.0, 2, 3], [1, 2, 3 * (1 + 1e-15)], [3, 2, 1]])
    found = Diffusion(1).fit_transform(rows).toarray()
    expected = shares(shares(rows[0]) + math.exp(-2) * shares(rows[2]))
    np.testing.assert_allclose(found[:2], [expected] * 2, atol=1e-12)


def test_alike_rows_become_more_alike():
    rng = np.random.default_rng(3)
    kinds = np.kron(np.eye(4), np.ones(6)) + 0.05
    which = np.repeat(np.arange(4), 15)
    rows = kinds[which] * rng.gamma(1, 1, (60, 24))

    def ratio(rows: np.ndarray) -> float:
        divergences = np.array([[slow_divergence(p, q) for q in rows] for p in rows])
        same = which[:, None] == which
        return divergences[same].mean() / divergences[~same].mean()

    assert ratio(Diffusion().fit_transform(rows).toarray()) < 0.6 * ratio(rows)


def test_errors():
    rows = np.ones((3, 2))
    for wrong in (0, -1, 1.5, True, "2"):
        with pytest.raises(ValueError, match=f"n_neighbours must be an integer of at least 1, got {wrong!r}"):
            Diffusion(wrong).fit(rows)
    for bad in (-1.0, np.nan, np.inf):
        for form in (np.array, sparse.csr_matrix):
            matrix = form([[1.0, 2], [3, bad]])
            with pytest.raises(ValueError, match=r"Negative values|NaN|infinity"):
                Diffusion().fit(matrix)
            with pytest.raises(ValueError, match=r"Negative values|NaN|infinity"):
                Diffusion().fit(rows).transform(matrix)
    with pytest.raises(ValueError, match="X has 3 features, but Diffusion is expecting 2 features"):
        Diffusion().fit(rows).transform(np.ones((1, 3)))
    with pytest.raises(ValueError, match="minimum of 1 is required"):
        Diffusion().fit(rows[:0])
    with pytest.raises(NotFittedError):
        Diffusion().transform(rows)


def test_parameters():
    diffusion = Diffusion(4)
    assert clone(diffusion).get_params() == {"n_neighbours": 4} != Diffusion().get_params()
    assert not hasattr(clone(diffusion.fit(np.ones((2, 2)))), "rows_")
