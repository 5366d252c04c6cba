"""Separation of classes on a tree, against all separations computed anew before each annexation, and Ward."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.cluster.hierarchy import ward

from shapeconcepts import Filtration
from shapeconcepts.topology.separation_kernels import separation_order
from topology_reference import random_tree, rows_of_tree, slow_separations


def order_of(edges, lengths, counts) -> tuple[list[int], list[float]]:
    order, separations = separation_order(
        np.array(edges, np.int32).reshape(-1, 2), np.array(lengths, float), np.array(counts, np.int64)
    )
    return order.tolist(), separations.tolist()


@st.composite
def weighted_trees(draw) -> tuple[list[tuple[int, int]], list[float], list[int]]:
    """Trees with hubs and without; lengths that are equal, nearly equal, zero, or any."""
    n = draw(st.integers(1, 30))
    n_hubs = draw(st.sampled_from([1, 2, 5, 30]))
    parents = [draw(st.integers(0, min(later, n_hubs) - 1)) for later in range(1, n)]
    if draw(st.booleans()):
        # Near the latest ones instead of near the first ones.
        parents = [later - 1 - parent for later, parent in enumerate(parents, 1)]
    names = draw(st.permutations(range(n)))
    edges = sorted(tuple(sorted((names[parent], names[later]))) for later, parent in enumerate(parents, 1))
    length = draw(
        st.sampled_from(
            [
                st.just(1.0),
                st.sampled_from([0.0, 0.5, 1.0]),
                st.sampled_from([0.25, 0.5, 0.75]),
                st.integers(0, 20).map(lambda ulps: 0.5 + ulps * 2.0**-53),
                st.floats(0, 1),
            ]
        )
    )
    lengths = draw(st.lists(length, min_size=n - 1, max_size=n - 1))
    largest = draw(st.sampled_from([1, 2, 50]))
    counts = draw(st.lists(st.integers(1, largest), min_size=n, max_size=n))
    return edges, lengths, counts


@given(weighted_trees())
@settings(max_examples=400, deadline=None)
def test_order_and_separations(tree):
    order, separations = order_of(*tree)
    # Lengths that differ by single bits can give the same rounded separation, and then another order.
    slow_order, slow = slow_separations(*tree)
    assert separations == slow
    if len(set(tree[1])) == len({round(length, 12) for length in tree[1]}):
        assert order == slow_order
    assert sorted(order) == list(range(len(tree[0]))) and separations == sorted(separations)


@pytest.mark.parametrize("kind", ["attached", "long", "star", "pairs at a hub", "caterpillar"])
@pytest.mark.parametrize("lengths", ["equal", "random", "few"])
def test_larger_trees(kind, lengths):
    n = 300
    rng = np.random.default_rng(n)
    if kind in ("attached", "long"):
        edges = sorted(tuple(sorted(edge)) for edge in random_tree(rng, n, 4 if kind == "long" else n))
    elif kind == "star":
        edges = [(0, k) for k in range(1, n)]
    elif kind == "pairs at a hub":
        edges = sorted((0, k) if k % 2 else (k - 1, k) for k in range(1, n))
    else:
        edges = sorted((k - 1, k) if k <= n // 2 else (k - n // 2, k) for k in range(1, n))
    length = {"equal": np.ones(n - 1), "random": rng.random(n - 1), "few": rng.integers(1, 4, n - 1) / 4}
    counts = rng.integers(1, 4, n).tolist()
    tree = (edges, length[lengths].tolist(), counts)
    assert order_of(*tree) == slow_separations(*tree)


def test_star():
    """Leaves enter by length, whatever the hub grows to; equal ones by number."""
    lengths = [0.5, 0.25, 0.5, 0.125, 0.25]
    order, separations = order_of([(0, k) for k in range(1, 6)], lengths, [1] * 6)
    assert order == [3, 1, 4, 0, 2]
    sizes = np.arange(1, 6)
    np.testing.assert_allclose(separations, np.array(lengths)[order] * np.sqrt(sizes / (sizes + 1)))


def test_path_of_equal_lengths():
    """Single vertices pair first, then pairs do."""
    order, separations = order_of([(k, k + 1) for k in range(7)], [1.0] * 7, [1] * 8)
    assert order == [0, 2, 4, 6, 1, 5, 3]
    np.testing.assert_allclose(np.square(separations), [1 / 2] * 4 + [1] * 2 + [2])


def test_a_short_bridge_of_large_classes_waits():
    """Two stars of 20: the bridge is shorter than any other edge, and enters last."""
    edges = sorted([(0, 1), *((k % 2, k) for k in range(2, 40))])
    lengths = [0.5 if edge == (0, 1) else 0.9 for edge in edges]
    counts = [10, 10] + [1] * 38
    order, separations = order_of(edges, lengths, counts)
    assert order[-1] == edges.index((0, 1))
    assert separations[-1] == 0.5 * np.sqrt(29 * 29 / 58)


def test_zero_lengths_and_no_edges():
    assert order_of([(0, 1), (1, 2)], [0, 0], [1, 5, 1]) == ([0, 1], [0, 0])
    assert order_of([], [], [1]) == order_of([], [], []) == ([], [])


@pytest.mark.parametrize(("a", "b"), [(1, 1), (1, 5), (4, 7)])
def test_two_places_against_ward(a, b):
    """The height of SciPy's linkage is sqrt(2) times the separation."""
    _, separations = order_of([(0, 1)], [0.3], [a, b])
    heights = ward(np.repeat([[0.0], [0.3]], [a, b], axis=0))[:, 2]
    assert heights[-1] == pytest.approx(np.sqrt(2) * separations[0])
    assert (heights[:-1] == 0).all()


@pytest.mark.parametrize("seed", range(10))
def test_far_bunches_against_ward(seed):
    """Places on a line, each a multiple farther from the next: every annexation is one of SciPy's linkage."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 5, 7)
    steps = rng.permutation(100.0 ** -np.arange(6))
    places = np.concatenate([[0], np.cumsum(steps)])
    order, _ = order_of([(k, k + 1) for k in range(6)], steps, counts)
    assert order == np.argsort(steps).tolist()
    heights = ward(np.repeat(places, counts)[:, None])[:, 2]
    classes = {vertex: {vertex} for vertex in range(7)}
    for e, height in zip(order, heights[-6:], strict=True):
        a, b = classes[e], classes[e + 1]
        sizes = [counts[list(one)].sum() for one in (a, b)]
        # Between centres of classes, which the edge spans but for what is inside of them.
        assert height == pytest.approx(steps[e] * np.sqrt(2 * np.prod(sizes) / sum(sizes)), rel=0.02)
        classes.update(dict.fromkeys(a | b, a | b))


@pytest.mark.filterwarnings("ignore:the filtration of")
def test_times_are_separations_scaled():
    rows = rows_of_tree([(0, 1), (1, 2), (2, 3)], [2, 1, 1, 3])
    filtration = Filtration(stop="annexations").fit(rows)
    space = filtration.space_
    order, separations = slow_separations(
        [tuple(edge) for edge in space.edges_.tolist()],
        space.divergences_.tolist(),
        space.multiplicities_.tolist(),
    )
    assert filtration.edges_.tolist() == space.edges_[order].tolist()
    np.testing.assert_allclose(filtration.times_, np.array(separations) / separations[-1])
