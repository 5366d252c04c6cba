"""Where a report puts the vertices of the tree and of F, and the order of the concepts."""

import networkx
import numpy as np
import pytest

from report_models import grouped_stimuli, model_of
from shapeconcepts import Concept
from shapeconcepts.report.html.filtration_layout import lay_out_filtration
from shapeconcepts.report.html.ranking import rank_concepts
from shapeconcepts.report.html.time_scale import TimeScale
from shapeconcepts.report.html.tree_layout import lay_out_tree


def random_tree(n: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([(rng.integers(max(0, i - 12), i), i) for i in range(1, n)])


def n_crossings(places: np.ndarray, edges: np.ndarray) -> int:
    """Pairs of edges without a common end that cross, by orientation tests in plain Python."""

    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    crossings = 0
    for i, (a, b) in enumerate(edges):
        for c, d in edges[:i]:
            if len({a, b, c, d}) == 4:
                p, q, r, s = places[[a, b, c, d]]
                crossings += side(p, q, r) * side(p, q, s) < 0 and side(r, s, p) * side(r, s, q) < 0
    return crossings


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_tree_hardly_crosses_itself_and_its_edges_are_alike(seed):
    edges = random_tree(150, seed)
    places = lay_out_tree(edges, 150)
    assert n_crossings(places, edges) <= 3
    lengths = np.linalg.norm(places[edges[:, 0]] - places[edges[:, 1]], axis=1)
    assert lengths.min() > 0.3 and lengths.max() < 6 * np.median(lengths)
    assert np.array_equal(places, lay_out_tree(edges, 150))


@pytest.mark.parametrize("n", [2, 3, 40])
@pytest.mark.parametrize("kind", ["path_graph", "star_graph"])
def test_regular_trees(kind, n):
    graph = getattr(networkx, kind)(n)
    edges = np.array(graph.edges)
    places = lay_out_tree(edges, len(graph))
    assert np.isfinite(places).all()
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)[~np.eye(len(graph), dtype=bool)]
    assert apart.min() > 0.1
    assert np.ptp(places[:, 0]) >= np.ptp(places[:, 1]) - 1e-9


@pytest.mark.parametrize("n", [0, 1])
def test_no_edges(n):
    none = np.empty((0, 2), np.int32)
    assert lay_out_tree(none, n).shape == (n, 2)
    assert np.array_equal(lay_out_filtration(none, np.empty(0), n), np.zeros((n, 2)))


@pytest.mark.parametrize("heat", ["divergence", "geodesic"])
def test_f_runs_inwards_in_time(heat):
    filtration = model_of(grouped_stimuli(80, 5)[0], heat=heat, stop="annexations").filtration_
    death_radii = TimeScale.of(filtration).radii(filtration.times_)
    assert np.all(np.diff(death_radii) <= 0) and death_radii.max() <= 1 and death_radii.min() >= 0.06 - 1e-12
    places = lay_out_filtration(filtration.annexations_, death_radii, 80)
    radii = np.linalg.norm(places, axis=1)
    dying, surviving = filtration.annexations_.T
    assert np.allclose(radii[dying], death_radii)
    is_left = np.isinf(filtration.diagram()[:, 1])
    # A single class that is left is in the middle.
    assert is_left.sum() == 1 and np.allclose(places[filtration.annexations_[-1, 1]], 0)
    several = lay_out_filtration(filtration.annexations_[:-3], death_radii[:-3], 80)
    left = np.setdiff1d(np.arange(80), filtration.annexations_[:-3, 0])
    assert len(left) == 4
    assert np.allclose(np.linalg.norm(several[left], axis=1), 0.6 * death_radii[:-3].min())
    assert np.all(radii[dying] >= radii[surviving] - 1e-12)
    outer = places[radii > 0.2]
    apart = np.linalg.norm(outer[:, None] - outer[None], axis=2)[~np.eye(len(outer), dtype=bool)]
    assert apart.min() > 1e-4


def concept(members: list[int], birth: float = 0.25, death: float = 0.5) -> Concept:
    return Concept(np.array(members), members[0], birth, death)


def test_rank_score_of_the_paper():
    labels = ["can", "can", "box", "can", None, "box", "box", "box"]
    concepts = [concept([0, 1, 2, 3]), concept([4]), concept([5, 6, 7])]
    ranked = rank_concepts(concepts, labels)
    assert [one.number for one in ranked] == [2, 0, 1]
    assert [one.score for one in ranked] == pytest.approx([3 / 0.001, 4 / 0.251, 1 / 1.001])
    assert [one.purity for one in ranked] == [1, 0.75, 0]
    assert ranked[1].label_counts == (("can", 3), ("box", 1))


def test_without_labels_size_times_lifetime_ranks():
    concepts = [concept([0, 1, 2]), concept([3, 4], 0.0, np.inf), concept([5, 6, 7])]
    ranked = rank_concepts(concepts, [None] * 8)
    assert [one.number for one in ranked] == [1, 0, 2]
    assert ranked[0].score == pytest.approx(2) and ranked[0].purity is None
