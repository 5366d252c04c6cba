"""Stray points and connected components."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse import csgraph as scipy_csgraph

from shapeconcepts.geometry.neighbours import Neighbours, radius_neighbours
from shapeconcepts.preparation.component_kernels import connected_components
from shapeconcepts.preparation.stray_points import stray_points


def sheet(columns: int, rows: int, origin=(0.0, 0.0, 0.0)) -> np.ndarray:
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) + origin


def strays(*parts: np.ndarray) -> np.ndarray:
    return stray_points(radius_neighbours(np.vstack(parts), 3.0))


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 60), st.lists(st.tuples(st.integers(0, 59), st.integers(0, 59)), max_size=70))
def test_components_agree_with_scipy(n, pairs):
    pairs = [(a % n, b % n) for a, b in pairs if a % n != b % n]
    # SciPy 1.11.1 connects nothing that is numbered by int64.
    a, b = np.array([*pairs, *((b, a) for a, b in pairs)], dtype=np.int32).reshape(-1, 2).T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(n, n)).tocsr()
    component = connected_components(graph.indptr.astype(np.int64), graph.indices.astype(np.int32))
    assert component.dtype == np.int32
    np.testing.assert_array_equal(component, scipy_csgraph.connected_components(graph, directed=False)[1])


def test_components_of_a_long_chain():
    n = 100_000
    points = np.column_stack([np.arange(n), np.zeros(n), np.zeros(n)]).astype(float)
    points[n // 2 :, 0] += 5.0
    component = connected_components(*radius_neighbours(points, 1.5))
    np.testing.assert_array_equal(component, np.arange(n) >= n // 2)


def test_far_blob_of_a_few_points_is_stray():
    stray = strays(sheet(40, 40), sheet(3, 4, (100, 0, 0)))
    np.testing.assert_array_equal(stray, np.arange(1612) >= 1600)


def test_two_large_components_are_kept():
    assert not strays(sheet(30, 30), sheet(20, 25, (100, 0, 50))).any()


def test_component_of_two_in_a_hundred_is_kept():
    assert not strays(sheet(50, 40), sheet(8, 5, (100, 0, 0))).any()


def test_point_with_two_neighbours_is_stray_and_with_three_is_not():
    body = sheet(30, 30)
    assert strays(body, np.array([[31.9, 10.5, 0.0]])).tolist() == [False] * 900 + [True]
    assert not strays(body, np.array([[31.7, 10.0, 0.0]])).any()


def test_never_everything():
    for n in (1, 2, 3, 500):
        line = np.column_stack([10.0 * np.arange(n), np.zeros(n), np.zeros(n)])
        assert not strays(line).any()
    many_blobs = [sheet(3, 3, (50.0 * k, 0, 0)) for k in range(150)]
    assert not strays(*many_blobs).any()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 150), st.floats(0.5, 30))
def test_agrees_with_definition(seed, n, spread):
    points = np.random.default_rng(seed).normal(size=(n, 3)) * spread
    close = np.linalg.norm(points[:, None] - points, axis=-1) <= 3.0
    _, component = scipy_csgraph.connected_components(close)
    expected = [close[i].sum() - 1 < 3 or (component == component[i]).sum() < 0.01 * n for i in range(n)]
    if all(expected):
        expected = [False] * n
    assert strays(points).tolist() == expected


def test_no_points_have_no_strays():
    nothing = Neighbours(np.zeros(1, np.int64), np.zeros(0, np.int32))
    assert connected_components(*nothing).shape == (0,)
    assert stray_points(nothing).shape == (0,)
