"""Jensen-Shannon divergence of sparse rows, against SciPy."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import sparse

from shapeconcepts.topology import jensen_shannon_divergences
from topology_reference import random_rows, slow_divergences


@pytest.mark.parametrize("seed", range(8))
def test_against_scipy(seed):
    rng = np.random.default_rng(seed)
    n_columns = int(rng.integers(1, 40))
    rows = random_rows(rng, 12, n_columns, rng.uniform(0.05, 0.9))
    others = random_rows(rng, 9, n_columns) * 10.0 ** rng.integers(-9, 9, (9, 1))
    rows[0] = 0
    expected = slow_divergences(rows, others)
    np.testing.assert_allclose(jensen_shannon_divergences(rows, others), expected, atol=1e-12)
    for form in (sparse.csr_matrix, sparse.csc_matrix, sparse.coo_array, sparse.csr_array):
        mixed = jensen_shannon_divergences(form(rows), others)
        np.testing.assert_array_equal(mixed, jensen_shannon_divergences(rows, others))
    np.testing.assert_array_equal(
        jensen_shannon_divergences(rows), jensen_shannon_divergences(rows, sparse.csr_matrix(rows))
    )
    np.testing.assert_allclose(jensen_shannon_divergences(rows), slow_divergences(rows, rows), atol=1e-12)


@settings(deadline=None, max_examples=60)
@example([[0.0, 1.0, 0.0, 0.0], [6.103515625e-05, 381061692393.0, 0.0, 0.0]])
@example([[0.0, 0.0, 0.0, 1.0], [0.0, 22906492249.0, 1.69759663297e-313, 0.0]])
@given(st.lists(st.lists(st.floats(0, 1e12), min_size=4, max_size=4), min_size=2, max_size=2))
def test_any_two_rows(rows):
    rows = np.array(rows)
    values = jensen_shannon_divergences(rows)
    assert (values >= 0).all() and (values <= 1).all()
    np.testing.assert_array_equal(values, values.T)
    normal = np.array([row / row.sum() if row.any() else row for row in rows])
    np.testing.assert_allclose(values, slow_divergences(normal, normal), atol=1e-12)


def test_disjoint_is_exactly_1_and_a_multiple_is_0():
    rng = np.random.default_rng(0)
    rows = random_rows(rng, 30, 50)
    rows[:, 0] = 0.1
    left, right = rows.copy(), rows.copy()
    left[:, 25:], right[:, :25] = 0, 0
    assert (jensen_shannon_divergences(left, right) == 1).all()
    scaled = jensen_shannon_divergences(rows, rows * rng.uniform(1e-6, 1e6, (30, 1)))
    assert np.abs(np.diag(scaled)).max() < 1e-12
    assert (scaled[~np.eye(30, dtype=bool)] > 1e-3).all()


def test_empty_rows_are_far_from_everything():
    values = jensen_shannon_divergences([[0, 0], [1, 2], [0, 0]])
    np.testing.assert_array_equal(values[0], 1)
    np.testing.assert_array_equal(values[:, 2], 1)
    assert jensen_shannon_divergences(np.zeros((3, 0))).tolist() == [[1] * 3] * 3
    assert jensen_shannon_divergences(np.zeros((0, 4)), np.ones((2, 4))).shape == (0, 2)


def test_any_form_of_csr():
    """Unsorted columns, explicit zeros, and duplicate entries, which count as their sum; X stays."""
    dense = np.array([[3.0, 0, 1, 2], [0, 5, 0, 1]])
    other = np.array([[1.0, 1, 0, 2], [0, 0, 1, 0], [1, 1, 1, 1]])
    columns, values = np.array([3, 0, 2, 1, 0, 3, 1, 3]), np.array([2.0, 1, 1, 0, 2, 0.5, 5, 0.5])
    untidy = sparse.csr_matrix((values.copy(), columns.copy(), [0, 5, 8]), (2, 4))
    np.testing.assert_array_equal(
        jensen_shannon_divergences(untidy, other), jensen_shannon_divergences(dense, other)
    )
    np.testing.assert_array_equal(untidy.indices, columns)
    np.testing.assert_array_equal(untidy.data, values)


def test_entries_too_small_to_matter():
    rows = np.array([[1e-300, 1e300], [0, 1], [1, 0]])
    np.testing.assert_array_equal(jensen_shannon_divergences(rows)[0], [0, 0, 1])


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
@pytest.mark.parametrize("form", [np.array, sparse.csr_matrix])
def test_bad_numbers(bad, form):
    good, matrix = np.ones((2, 3)), np.ones((2, 3))
    matrix[1, 2] = bad
    with pytest.raises(ValueError, match="first must hold finite numbers of at least 0"):
        jensen_shannon_divergences(form(matrix))
    with pytest.raises(ValueError, match="second must hold finite numbers of at least 0"):
        jensen_shannon_divergences(good, form(matrix))


def test_bad_shapes():
    with pytest.raises(ValueError, match="as many columns, got 3 and 2"):
        jensen_shannon_divergences(np.ones((2, 3)), np.ones((2, 2)))
    for shape in ((3,), (2, 2, 2), ()):
        with pytest.raises(ValueError, match=f"first must be a matrix, got {len(shape)} dimensions"):
            jensen_shannon_divergences(np.ones(shape))
