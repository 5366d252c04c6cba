"""Radius neighbours against SciPy's k-d tree."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial import cKDTree

from shapeconcepts.geometry.neighbour_kernels import restrict
from shapeconcepts.geometry.neighbours import cell_grid, radius_neighbours, sorting_order


def tree_neighbours(points: np.ndarray, radius: float) -> list[list[int]]:
    lists = cKDTree(points).query_ball_point(points, radius, return_sorted=True)
    return [[j for j in found if j != i] for i, found in enumerate(lists)]


def as_lists(points: np.ndarray, radius: float) -> list[list[int]]:
    indptr, indices = radius_neighbours(points, radius)
    assert indptr.dtype == np.int64 and indices.dtype == np.int32
    assert len(indptr) == len(points) + 1
    return [indices[indptr[i] : indptr[i + 1]].tolist() for i in range(len(points))]


# A lattice makes duplicates, collinear runs and full cells likely; a radius off the lattice spacing keeps the
# two implementations from rounding a distance that equals the radius to different sides.
lattices = hnp.arrays(np.int64, st.tuples(st.integers(1, 60), st.just(3)), elements=st.integers(-6, 6))


@settings(max_examples=150, deadline=None)
@given(lattices, st.sampled_from([0.3, 1.2, 2.1, 3.7, 40.0]), st.floats(-1e3, 1e3))
def test_agrees_with_tree(lattice, radius, offset):
    points = 0.97 * lattice + offset
    assert as_lists(points, radius) == tree_neighbours(points, radius)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 300), st.floats(0.01, 0.6))
def test_agrees_with_tree_on_random_points(seed, n, radius):
    points = np.random.default_rng(seed).uniform(-1, 1, (n, 3)) * [1.0, 0.5, 0.02]
    assert as_lists(points, radius) == tree_neighbours(points, radius)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(4, 14))
def test_far_apart_clusters(seed, exponent):
    rng = np.random.default_rng(seed)
    centres = rng.integers(-3, 4, (30, 3)) * 10.0**exponent
    points = centres + np.round(rng.uniform(-2, 2, (30, 3)))
    assert as_lists(points, 1.2) == tree_neighbours(points, 1.2)


def test_more_neighbours_than_first_allocated():
    points = np.random.default_rng(0).normal(size=(400, 3))
    assert as_lists(points, 100.0) == [[j for j in range(400) if j != i] for i in range(400)]


def test_radius_is_inclusive_and_duplicates_are_neighbours():
    points = np.array([[0.0, 0, 0], [2, 0, 0], [0, 0, 0], [4.5, 0, 0]])
    assert as_lists(points, 2.0) == [[1, 2], [0, 2], [0, 1], []]


def test_one_point_and_no_point():
    assert as_lists(np.zeros((1, 3)), 0.1) == [[]]
    assert as_lists(np.zeros((0, 3)), 0.1) == []


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 200), st.sampled_from([1, 2, 3]))
def test_candidates_of_cells_hold_all_neighbours(seed, n, reach):
    points = np.random.default_rng(seed).uniform(size=(n, 3)) * [1.0, 1.0, 0.2]
    grid = cell_grid(points, 0.2, reach)
    np.testing.assert_array_equal(points[grid.order], grid.coordinates.T)
    lists = tree_neighbours(grid.coordinates.T, 0.2)
    assert grid.cells[0] == 0 and grid.cells[-1] == n
    for cell, (start, end) in enumerate(itertools.pairwise(grid.cells)):
        candidates = grid.candidates[grid.indptr[cell] : grid.indptr[cell + 1]]
        assert end > start and (np.diff(candidates.astype(int)) > 0).all()
        assert set().union(range(start, end), *lists[start:end]) <= set(candidates)
        box = grid.coordinates[:, start:end]
        nearest = np.clip(grid.coordinates, box.min(axis=1, keepdims=True), box.max(axis=1, keepdims=True))
        distances = np.linalg.norm(grid.coordinates - nearest, axis=0)
        assert (distances[candidates] < 0.2001).all()


@given(st.lists(st.integers(0, 2**62 - 1) | st.integers(0, 9)))
def test_sorting_order_is_stable(keys):
    keys = np.array(keys, np.int64)
    np.testing.assert_array_equal(sorting_order(keys), np.argsort(keys, kind="stable"))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 120))
def test_restricted_lists_are_those_of_the_kept_points(seed, n):
    rng = np.random.default_rng(seed)
    points = rng.uniform(size=(n, 3))
    kept = rng.random(n) < 0.7
    kept[rng.integers(n)] = True
    found = restrict(*radius_neighbours(points, 0.3), kept)
    for array, expected in zip(found, radius_neighbours(points[kept], 0.3), strict=True):
        np.testing.assert_array_equal(array, expected)


def test_order_of_points_does_not_matter():
    rng = np.random.default_rng(2)
    points = rng.uniform(size=(150, 3))
    order = rng.permutation(150)
    lists = as_lists(points, 0.25)
    permuted = as_lists(points[order], 0.25)
    assert [sorted(order[permuted[i]]) for i in range(150)] == [lists[order[i]] for i in range(150)]


@pytest.mark.parametrize(
    ("points", "radius", "message"),
    [
        (np.zeros((4, 2)), 1.0, r"points must have shape \(m, 3\), got \(4, 2\)"),
        (np.full((4, 3), np.nan), 1.0, "points must be finite"),
        (np.zeros((4, 3)), 0.0, r"radius must be a positive number, got 0\.0"),
        (np.zeros((4, 3)), np.nan, "radius must be a positive number, got nan"),
    ],
)
def test_bad_input(points, radius, message):
    with pytest.raises(ValueError, match=message):
        radius_neighbours(points, radius)
