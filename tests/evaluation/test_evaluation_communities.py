"""Communities of neighbour graphs, against networkx and all partitions there are."""

from collections.abc import Iterator

import networkx as nx
import numpy as np
import pytest
from scipy.spatial.distance import cdist
from sklearn.neighbors import kneighbors_graph

from shapeconcepts.evaluation import leiden
from shapeconcepts.evaluation.groupings.grouping import CHOICES, mean_silhouette, without_small_groups
from shapeconcepts.evaluation.groupings.leiden import communities
from shapeconcepts.evaluation.groupings.neighbour_graph import by_nearness, neighbours_both_ways


def neighbours_in(graph: nx.Graph) -> list[list[int]]:
    return [sorted(graph[vertex]) for vertex in range(len(graph))]


def modularity(graph: nx.Graph, labels: np.ndarray, resolution: float) -> float:
    groups = [set(np.flatnonzero(labels == label).tolist()) for label in np.unique(labels)]
    return nx.community.modularity(graph, groups, resolution=resolution)


def partitions(n: int, labels: tuple[int, ...] = ()) -> Iterator[np.ndarray]:
    """All ways to group n vertices."""
    if len(labels) == n:
        yield np.array(labels)
        return
    for label in range(max(labels, default=-1) + 2):
        yield from partitions(n, (*labels, label))


def points(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.repeat(rng.normal(0, 3, (6, 2)), 15, axis=0) + rng.normal(0, 1, (90, 2))


def test_two_cliques_are_two_communities() -> None:
    graph = nx.barbell_graph(6, 0)
    assert without_small_groups(communities(neighbours_in(graph), 1.0), 1).tolist() == [0] * 6 + [1] * 6
    assert np.unique(communities(neighbours_in(graph), 0.01)).tolist() == [0]
    assert len(np.unique(communities(neighbours_in(graph), 64.0))) == 12


@pytest.mark.parametrize("resolution", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_no_partition_of_a_small_clustered_graph_has_more_modularity(seed: int, resolution: float) -> None:
    graph = nx.planted_partition_graph(2, 4, 1.0, 0.15, seed=seed)
    found = modularity(graph, communities(neighbours_in(graph), resolution), resolution)
    most = max(modularity(graph, labels, resolution) for labels in partitions(8))
    assert found == pytest.approx(most)


@pytest.mark.parametrize("resolution", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_communities_are_as_modular_as_those_of_louvain(seed: int, resolution: float) -> None:
    nearest = by_nearness(cdist(points(seed), points(seed)))[:, :8]
    graph = nx.Graph(
        [(i, j) for i, row in enumerate(neighbours_both_ways(nearest)) for j in row],
    )
    labels = communities(neighbours_both_ways(nearest), resolution)
    louvain = nx.community.louvain_communities(graph, resolution=resolution, seed=0)
    by_louvain = nx.community.modularity(graph, louvain, resolution=resolution)
    assert modularity(graph, labels, resolution) > by_louvain - 0.01
    for label in np.unique(labels):
        assert nx.is_connected(graph.subgraph(np.flatnonzero(labels == label).tolist()))


def test_the_graph_is_scikit_learns() -> None:
    of = points(3)
    directed = kneighbors_graph(of, 6).toarray() > 0
    joined = neighbours_both_ways(by_nearness(cdist(of, of))[:, :6])
    assert [np.flatnonzero(row).tolist() for row in directed | directed.T] == joined


def test_an_object_is_not_its_own_neighbour_among_equal_ones() -> None:
    nearest = by_nearness(np.zeros((5, 5)))
    assert all(i not in row and len(set(row)) == 4 for i, row in enumerate(nearest.tolist()))


@pytest.mark.parametrize("choice", CHOICES)
def test_what_is_chosen_is_best(choice: str) -> None:
    between = cdist(points(4), points(4))
    grouping = leiden(between, 8, choice)
    others = []
    for k in (4, 6, 8, 12, 16):
        graph = neighbours_both_ways(by_nearness(between)[:, :k])
        for power in np.arange(-3, 6.5, 0.5):
            labels = without_small_groups(communities(graph, float(2.0**power)), 2)
            if labels.max() >= 8:
                break
            others.append(labels)
    if choice == "silhouette":
        best = max(mean_silhouette(between, labels) for labels in others)
        assert mean_silhouette(between, grouping.labels) == best
    else:
        assert grouping.n_groups == max(labels.max() + 1 for labels in others)
    assert set(grouping.parameters) == {"neighbours", "resolution"}


def test_more_neighbours_are_joined_until_the_groups_fit() -> None:
    centres = np.repeat(np.arange(9), 18)[:, None] * 10.0
    of = centres + np.random.default_rng(0).normal(0, 0.1, (162, 1))
    grouping = leiden(cdist(of, of), 4)
    assert grouping.parameters["neighbours"] > 16
    assert grouping.n_groups <= 4
