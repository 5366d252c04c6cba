"""Neighbours, refused edges and settled concepts, against sets, fractions and scikit-learn."""

import warnings
from fractions import Fraction
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import jensenshannon
from sklearn.neighbors import NearestNeighbors

from shapeconcepts import Filtration, TopologicalSpace
from shapeconcepts.topology import neighbourhood
from shapeconcepts.topology.neighbourhood import Neighbourhoods, neighbourhood_size
from shapeconcepts.topology.separation_kernels import separation_order
from topology_reference import (
    components,
    random_rows,
    random_tree,
    rows_of_tree,
    slow_divergences,
    slow_neighbourhood_size,
    slow_neighbours,
    slow_refusals,
    slow_settled,
    uniform_rows,
)


def fitted(rows, **parameters) -> Filtration:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return Filtration(**parameters).fit(rows)


def bunches(rng: np.random.Generator, sizes: list[int], n_columns: int = 6, shape: float = 20) -> np.ndarray:
    """Rows of as many kinds as sizes, which share next to nothing."""
    kinds = np.kron(np.eye(len(sizes)), np.ones(n_columns))
    rows = kinds[np.repeat(np.arange(len(sizes)), sizes)]
    return rows * rng.gamma(shape, 1, rows.shape) + 0.001


def neighbours_of(space: TopologicalSpace, n_neighbours: int) -> list[list[int]]:
    with (
        patch.object(neighbourhood, "neighbourhood_size", lambda n, per_root: n_neighbours),
        patch.object(neighbourhood, "_ROWS_AT_ONCE", 7),
    ):
        found = Neighbourhoods.of(space, 3.0)
    if len(found.starts) == 1:
        return []
    dense = space.rows_.toarray()
    lists = np.split(found.nearest, found.starts[1:-1])
    for vertex, (ours, divergences) in enumerate(
        zip(lists, np.split(found.divergences, found.starts[1:-1]), strict=True)
    ):
        expected = slow_divergences(dense[[vertex]], dense[ours])[0]
        np.testing.assert_allclose(divergences, expected, atol=1e-12)
        assert (np.diff(divergences) >= 0).all()
    return [one.tolist() for one in lists]


def rows_of(kind: str, rng: np.random.Generator, n: int) -> np.ndarray:
    if kind == "tree":
        return rows_of_tree(random_tree(rng, n), rng.integers(1, 5, n).tolist()).toarray()
    if kind == "bunches":
        return bunches(rng, rng.multinomial(n, [0.5, 0.3, 0.2]).tolist(), 3, 2)
    rows = {
        "random": random_rows(rng, n, 8, 0.4),
        "uniform": uniform_rows(rng, n, 7, 3),
        "disjoint": np.eye(n),
        "equal": np.ones((n, 2)),
    }[kind]
    return rows[rng.integers(n, size=n)] if rng.random() < 0.5 else rows


KINDS = ("random", "uniform", "tree", "bunches", "disjoint", "equal")


@given(
    n=st.integers(1, 60),
    seed=st.integers(0, 10**6),
    kind=st.sampled_from(KINDS),
    n_neighbours=st.integers(1, 40),
)
@settings(max_examples=120, deadline=None)
def test_neighbours(n, seed, kind, n_neighbours):
    space = TopologicalSpace().fit(rows_of(kind, np.random.default_rng(seed), n))
    dense = space.rows_.toarray()
    expected = slow_neighbours(slow_divergences(dense, dense), space.multiplicities_.tolist(), n_neighbours)
    assert [set(one) for one in neighbours_of(space, n_neighbours)] == expected


@pytest.mark.parametrize("n_neighbours", [1, 7, 30])
def test_neighbours_against_scikit_learn(n_neighbours):
    """Between random rows without a zero there are no ties, and all are near."""
    space = TopologicalSpace().fit(random_rows(np.random.default_rng(0), 120, 12, 1.0))
    dense = space.rows_.toarray()
    estimator = NearestNeighbors(n_neighbors=n_neighbours, metric=jensenshannon)
    _, expected = estimator.fit(dense).kneighbors()
    assert neighbours_of(space, n_neighbours) == expected.tolist()


@pytest.mark.parametrize("heat", ["separation", "geodesic"])
@given(
    n=st.integers(1, 70),
    seed=st.integers(0, 10**6),
    kind=st.sampled_from(KINDS),
    min_size=st.integers(2, 5),
    least_mixing=st.sampled_from(["0.8", "0.8", "0", "0.5", "1"]),
    n_nearest=st.sampled_from([10, 10, 1, 3]),
)
@settings(max_examples=100, deadline=None)
def test_refusals(heat, n, seed, kind, min_size, least_mixing, n_nearest):
    filtration = fitted(
        rows_of(kind, np.random.default_rng(seed), n),
        heat=heat,
        min_concept_size=min_size,
        least_mixing=float(least_mixing),
        n_nearest=n_nearest,
    )
    space = filtration.space_
    if heat == "separation":
        order, _ = separation_order(space.edges_, space.divergences_, space.multiplicities_)
    else:
        order = np.argsort(space.edge_heat_, kind="stable")
    edges, counts = space.edges_[order], space.multiplicities_.tolist()
    dense = space.rows_.toarray()
    between = slow_divergences(dense, dense)
    refused = slow_refusals(edges.tolist(), between, counts, min_size, Fraction(least_mixing))
    np.testing.assert_array_equal(filtration.edges_, edges[~np.array(refused, bool)])
    np.testing.assert_array_equal(filtration.refused_edges_, edges[np.array(refused, bool)])
    assert len(filtration.refused_times_) == sum(refused) and (np.diff(filtration.refused_times_) >= 0).all()

    groups = components(filtration.edges_.tolist(), len(counts))
    expected = [group for group in groups if sum(counts[vertex] for vertex in group) >= min_size]
    left = [set(space.vertices_[one.members].tolist()) for one in filtration.concepts_at(1, min_size)]
    assert sorted(map(sorted, left)) == sorted(map(sorted, expected))

    before = [next((k for k, group in enumerate(left) if v in group), -1) for v in range(len(counts))]
    n_neighbours = slow_neighbourhood_size(sum(counts))
    settled = slow_settled(before, between, counts, n_neighbours, min_size, n_nearest)
    expected = [{v for v, own in enumerate(settled) if own == k} for k in set(settled) - {-1}]
    found = [set(space.vertices_[concept.members].tolist()) for concept in filtration.concepts_]
    assert sorted(map(sorted, found)) == sorted(map(sorted, expected))
    assert [one.size for one in filtration.concepts_] == sorted(one.size for one in filtration.concepts_)[
        ::-1
    ]
    assert filtration.concept_time_ == (1 if expected else None)
    for number, concept in enumerate(filtration.concepts_):
        assert concept.birth <= 1 < concept.death
        assert np.flatnonzero(filtration.labels_ == number).tolist() == concept.members.tolist()


def test_examples_are_worth_comparing():
    """Some refuse nothing, some once or twice, some often."""
    counts = [
        len(fitted(rows_of(kind, np.random.default_rng(seed), 8 + seed)).refused_edges_)
        for kind in KINDS
        for seed in range(0, 60, 6)
    ]
    assert counts.count(0) > 10 and sum(1 <= count <= 2 for count in counts) > 8 and max(counts) > 10


@pytest.mark.parametrize("sizes", [[40, 30, 25, 20, 15], [20, 20, 20], [30, 30, 30], [50] * 7])
def test_clear_bunches_are_the_concepts(sizes):
    which = np.repeat(np.arange(len(sizes)), sizes)
    filtration = Filtration().fit(bunches(np.random.default_rng(0), sizes))
    np.testing.assert_array_equal(filtration.labels_[:, None] == filtration.labels_, which[:, None] == which)
    assert len(filtration.refused_edges_) == len(sizes) - 1
    assert np.isinf(filtration.diagram()[:, 1]).sum() == len(sizes)


def test_a_bunch_much_larger_than_a_neighbourhood_comes_in_parts():
    sizes = [300, 300]
    filtration = Filtration().fit(bunches(np.random.default_rng(0), sizes))
    which = np.repeat(np.arange(2), sizes)
    assert 2 < len(filtration.concepts_) < 600 / 8
    assert all(len(set(which[concept.members])) == 1 for concept in filtration.concepts_)
    # In neighbourhoods of half of all objects each is whole; where nothing has to mix, nothing is refused.
    rows = bunches(np.random.default_rng(0), sizes)
    wide, lenient = Filtration(neighbours_per_root=13).fit(rows), Filtration(least_mixing=0).fit(rows)
    assert [set(which[concept.members]) for concept in wide.concepts_] in ([{0}, {1}], [{1}, {0}])
    assert [concept.size for concept in wide.concepts_] == sizes
    assert [concept.size for concept in lenient.concepts_] == [600] and len(lenient.refused_edges_) == 0


def test_strays_are_annexed():
    """One odd object is no concept, and its neighbour does not refuse it."""
    rows = bunches(np.random.default_rng(0), [40, 40])
    rows = np.concatenate([rows, rows[:1] + 3 * rows[-1:].mean()])
    filtration = Filtration().fit(rows)
    assert (filtration.labels_ >= 0).all() and len(filtration.concepts_) == 2


def test_neighbourhood_size():
    numbers = (1, 2, 3, 40, 72, 100, 346, 10_000)
    assert [neighbourhood_size(n, 3.0) for n in numbers] == [1, 1, 1, 20, 36, 36, 56, 300]
    assert [neighbourhood_size(n, 10.0) for n in numbers] == [1, 1, 1, 20, 36, 50, 173, 1000]
    for per_root in (0.1, 0.5, 3, 3.7, 20):
        expected = [slow_neighbourhood_size(n, per_root) for n in range(1, 500)]
        assert [neighbourhood_size(n, per_root) for n in range(1, 500)] == expected


def test_what_hangs_on_the_wrong_concept_moves():
    """Of mixtures of two kinds, each belongs to the kind that it has more of, whatever the tree."""
    rng = np.random.default_rng(0)
    rows = bunches(rng, [60, 60])
    for k, share in enumerate(rng.uniform(0.75, 0.9, 30)):
        own, other = (0, 60) if k < 15 else (60, 0)
        rows = np.concatenate([rows, [share * rows[own + k] + (1 - share) * rows[other + k]]])
    filtration = Filtration().fit(rows)
    which = np.repeat([0, 1, 0, 1], [60, 60, 15, 15])
    found = [set(which[concept.members]) for concept in filtration.concepts_]
    assert all(len(kinds) == 1 for kinds in found)
