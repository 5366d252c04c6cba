"""Average linkage along a tree, against fractions and SciPy; and the gathering of many vertices."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform
from sklearn.metrics import adjusted_rand_score

from shapeconcepts.topology import TopologicalSpace, jensen_shannon_divergences
from shapeconcepts.topology.coarse_kernels import gathered
from shapeconcepts.topology.groups import Groups
from shapeconcepts.topology.mean_divergence import mean_divergences
from topology_reference import components, random_rows, random_tree, slow_mean_divergences, uniform_rows


def space_of(seed: int, n: int) -> TopologicalSpace:
    """With equal rows; every other one has many ties."""
    rng = np.random.default_rng(seed)
    rows = uniform_rows(rng, n, 9, 3) if seed % 2 else random_rows(rng, n, 12, 0.4)
    return TopologicalSpace().fit(rows[rng.integers(n, size=n + 5)])


def slowly(space: TopologicalSpace):
    edges = [tuple(edge) for edge in space.edges_.tolist()]
    return slow_mean_divergences(
        edges, mean_divergences(space, 10**6).divergences, space.multiplicities_.tolist()
    )


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**16), n=st.integers(1, 24))
def test_against_fractions(seed, n):
    space = space_of(seed, n)
    order, heights = slowly(space)
    classes = mean_divergences(space, 4096)
    assert classes.order.tolist() == order
    np.testing.assert_allclose(classes.means, np.array(heights, float), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("seed", range(6))
def test_divergences(seed):
    space = space_of(seed, 30)
    classes = mean_divergences(space, 4096)
    expected = jensen_shannon_divergences(space.rows_)
    np.fill_diagonal(expected, 0)
    np.testing.assert_allclose(classes.divergences, expected, atol=1e-6)
    np.testing.assert_array_equal(classes.divergences, classes.divergences.T)


def bunches(seed: int) -> TopologicalSpace:
    rng = np.random.default_rng(seed)
    centres = np.kron(np.eye(4), np.ones(6)) / 6 + 0.003
    return TopologicalSpace().fit(np.concatenate([rng.dirichlet(20 * c, 150) for c in centres]))


def groups_without_the_last(space: TopologicalSpace, classes, n_last: int) -> np.ndarray:
    edges = space.edges_[classes.order[:-n_last]]
    return Groups.connected_by(edges, len(space.multiplicities_), space.vertices_).of_object


@pytest.mark.parametrize("seed", range(3))
def test_against_scipy(seed):
    """Where groups are far apart, the tree forbids next to nothing that average linkage of all pairs does."""
    space = bunches(seed)
    classes = mean_divergences(space, 4096)
    expected = linkage(squareform(classes.divergences.astype(float), checks=False), "average")
    np.testing.assert_allclose(classes.means[-3:], expected[-3:, 2], rtol=0.005)
    found = groups_without_the_last(space, classes, 3)[np.argsort(space.vertices_)]
    assert adjusted_rand_score(found, fcluster(expected, 4, "maxclust")) == 1


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**16), n=st.integers(2, 30), n_most=st.integers(2, 40))
def test_classes_are_stretches(seed, n, n_most):
    """Each is what the edges connect that have entered before, and nothing else."""
    space = space_of(seed, n)
    classes = mean_divergences(space, n_most)
    edges = [tuple(edge) for edge in space.edges_[classes.order].tolist()]
    n_vertices = len(space.multiplicities_)
    assert sorted(classes.members.tolist()) == list(range(len(classes.members)))
    assert len(classes.members) <= max(n_most, 2) and (np.diff(classes.means) >= 0).all()
    # A place stands for the vertices that are gathered in it: its own smallest one among them.
    within = [
        edge for edge, stretch in zip(edges, classes.stretches.tolist(), strict=True) if not any(stretch)
    ]
    places = components(within, n_vertices)
    assert len(places) == len(classes.members)
    for k, (begin, middle, end) in enumerate(classes.stretches.tolist()):
        if end == 0:
            continue
        groups = components(edges[:k], n_vertices)
        for vertex_group, stretch in (
            (next(g for g in groups if min(places[classes.members[i]]) in g), (i, j))
            for i, j in ((begin, middle), (middle, end))
        ):
            found = set().union(*(places[classes.members[p]] for p in range(*stretch)))
            assert found == vertex_group
        assert {next(i for i, g in enumerate(groups) if v in g) for v in edges[k]} == {
            next(i for i, g in enumerate(groups) if min(places[classes.members[p]]) in g)
            for p in (begin, middle)
        }


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**16), n=st.integers(1, 40), n_most=st.integers(2, 20))
def test_gathered(seed, n, n_most):
    rng = np.random.default_rng(seed)
    edges = np.array(random_tree(rng, n), np.int32).reshape(-1, 2)
    sizes = rng.integers(1, 4, n)
    shortest_first = rng.permutation(n - 1)
    class_of, within = gathered(edges, shortest_first, sizes, n_most)
    groups = components([tuple(e) for e in edges[within].tolist()], n)
    assert [sorted(np.flatnonzero(class_of == min(g)).tolist()) for g in groups] == [
        sorted(g) for g in groups
    ]
    assert len(groups) <= n_most or n <= n_most
    if n <= n_most:
        assert not within.any()


def test_dense_is_not_gathered_more_than_rare():
    """A far bunch of a few keeps its places, though all of its edges are longer than those of the many."""
    n_many, n_few = 400, 12
    edges = np.array([(k, k + 1) for k in range(n_many + n_few - 1)], np.int32)
    lengths = np.where(np.arange(len(edges)) < n_many, 0.01, 0.2)
    class_of, _ = gathered(edges, np.argsort(lengths, kind="stable"), np.ones(n_many + n_few, np.int64), 206)
    assert len(np.unique(class_of)) <= 206
    assert len(np.unique(class_of[-n_few:])) >= n_few // 4


def test_few_places_stand_for_many():
    space = bunches(0)
    whole, coarse = mean_divergences(space, 4096), mean_divergences(space, 100)
    assert len(coarse.members) <= 100
    np.testing.assert_allclose(coarse.means[-3:], whole.means[-3:], rtol=0.05)
    found, expected = (groups_without_the_last(space, one, 3) for one in (coarse, whole))
    assert adjusted_rand_score(found, expected) > 0.98
