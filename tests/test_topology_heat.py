"""Mean geodesic distances within trees, against SciPy's Johnson, and the heat made of them."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import johnson

from shapeconcepts import TopologicalSpace
from topology_reference import random_tree, rows_of_tree, slow_heat


def johnson_means(edges: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Mean distance of each vertex to all objects (paper: equation 2)."""
    n = len(counts)
    graph = coo_matrix((np.ones(n - 1), (edges[:, 0], edges[:, 1])), (n, n))
    return johnson(graph.tocsr(), directed=False) @ counts / counts.sum()


def check_against_johnson(space: TopologicalSpace) -> None:
    means = johnson_means(space.edges_, space.multiplicities_)
    np.testing.assert_allclose(space.mean_distances_, means, rtol=0, atol=1e-9)
    span = np.ptp(means)
    heat = (means.max() - means) / span if span > 1e-12 else np.zeros(len(means))
    np.testing.assert_allclose(space.vertex_heat_, heat, rtol=0, atol=1e-9)
    np.testing.assert_allclose(space.edge_heat_, heat[space.edges_].mean(axis=1), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("n", "reach"), [(1, 1), (2, 1), (3, 9), (17, 1), (100, 3), (300, 10**9), (1000, 20), (2000, 10**9)]
)
@pytest.mark.parametrize("largest_count", [1, 4])
def test_random_trees(n, reach, largest_count):
    rng = np.random.default_rng(n)
    counts = rng.integers(1, largest_count + 1, n)
    space = TopologicalSpace().fit(rows_of_tree(random_tree(rng, n, reach), counts))
    assert len(space.multiplicities_) == n and space.multiplicities_.sum() == counts.sum()
    check_against_johnson(space)


def test_five_thousand_vertices():
    space = TopologicalSpace().fit(rows_of_tree(random_tree(np.random.default_rng(0), 5000, 50), [1] * 5000))
    check_against_johnson(space)


def test_mean_is_over_objects():
    """A path a - b - c with three objects at a: distances are 0, 0, 0, 1, 2, itself included."""
    space = TopologicalSpace().fit(rows_of_tree([(0, 1), (1, 2)], [3, 1, 1]))
    a, b, c = space.vertices_[[0, 3, 4]]
    np.testing.assert_allclose(space.mean_distances_[[a, b, c]], [3 / 5, 4 / 5, 7 / 5])
    np.testing.assert_allclose(space.vertex_heat_[[a, b, c]], [1, 3 / 4, 0])


@pytest.mark.parametrize("n", [2, 3, 10, 101])
def test_path(n):
    space = TopologicalSpace().fit(rows_of_tree([(k, k + 1) for k in range(n - 1)], [1] * n))
    place = np.arange(n)
    expected = (place * (place + 1) + (n - 1 - place) * (n - place)) / 2 / n
    np.testing.assert_allclose(space.mean_distances_[space.vertices_], expected, atol=1e-12)
    heat = space.vertex_heat_[space.vertices_]
    assert heat[0] == heat[-1] == 0
    assert heat.max() == heat[n // 2] == (1 if n > 2 else 0)
    # Mirrored places are equally hot to the last bit.
    np.testing.assert_array_equal(heat, heat[::-1])


@pytest.mark.parametrize("n", [3, 10, 100])
def test_star(n):
    space = TopologicalSpace().fit(rows_of_tree([(0, k) for k in range(1, n)], [1] * n))
    heat = space.vertex_heat_[space.vertices_]
    assert heat.tolist() == [1] + [0] * (n - 1)
    assert (space.edge_heat_ == 0.5).all()
    np.testing.assert_allclose(space.mean_distances_[space.vertices_[:2]], [(n - 1) / n, (2 * n - 3) / n])


@pytest.mark.parametrize("seed", range(5))
def test_equal_heat_is_equal_to_the_last_bit(seed):
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 3, 40).tolist()
    space = TopologicalSpace().fit(rows_of_tree(random_tree(rng, 40, 4), counts))
    edges = [tuple(edge) for edge in space.edges_.tolist()]
    _, heat = slow_heat(edges, space.multiplicities_.tolist())
    exact = [(heat[a] + heat[b]) / 2 for a, b in edges]
    for values, floats in ((heat, space.vertex_heat_), (exact, space.edge_heat_)):
        np.testing.assert_allclose(floats, np.array(values, float), rtol=1e-15)
        assert len(set(values)) == len(np.unique(floats))
