"""Filtration of trees, by both kinds of heat, against fractions and sets, SciPy, GUDHI and ripser."""

import warnings

import numpy as np
import pytest
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from shapeconcepts import Filtration
from topology_reference import (
    components,
    random_rows,
    random_tree,
    rows_of_tree,
    slow_divergences,
    slow_filtration,
    uniform_rows,
)

HEATS = ("divergence", "geodesic")
TREES = ("attached", "long", "path", "star", "caterpillar", "two stars")
PAPER = {"heat": "geodesic", "stop": "annexations"}
by_both_heats = pytest.mark.parametrize("heat", HEATS)
no_concepts_are_no_news = pytest.mark.filterwarnings("ignore:the filtration of")


def tree(rng: np.random.Generator, kind: str, n: int) -> list[tuple[int, int]]:
    if kind == "path":
        return [(k, k + 1) for k in range(n - 1)]
    if kind == "star":
        return [(0, k) for k in range(1, n)]
    if kind == "caterpillar":
        return [(k - 1 if k <= n // 2 else k - n // 2 - 1, k) for k in range(1, n)]
    if kind == "two stars":
        return [(0, 1)] + [(k % 2, k) for k in range(2, n)]
    return random_tree(rng, n, 3 if kind == "long" else 10**9)


def example(seed: int, heat: str = "geodesic") -> tuple[Filtration, csr_matrix]:
    """A tree of a random kind with equal rows at some places, and rows without any entry between them.

    Where divergences count, only those of a tree's neighbours under 1 would be too few: bunches of rows then.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 40))
    counts = rng.integers(1, rng.choice([2, 2, 3, 6]), n).tolist()
    rows = rows_of_tree(tree(rng, TREES[seed % len(TREES)], n), counts)
    if heat == "divergence":
        bunches = np.repeat(rng.random((4, 12)) < 0.4, 10, axis=0)[:n]
        rows = csr_matrix(np.repeat(bunches + (rng.random((n, 12)) < 0.3), counts, axis=0), dtype=float)
    rows = csr_matrix(np.concatenate([rows.toarray(), np.zeros((seed % 3, rows.shape[1]))]))
    rows = rows[rng.permutation(rows.shape[0])]
    filtration = Filtration(int(rng.integers(2, 5)), int(rng.choice([1, 3, 7, 20, 200])), heat, "annexations")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return filtration.fit(rows), rows


def slowly(filtration: Filtration):
    edges = sorted(tuple(edge) for edge in filtration.edges_.tolist())
    counts = filtration.space_.multiplicities_.tolist()
    rows = filtration.space_.rows_.toarray()
    divergences = slow_divergences(rows, rows) if filtration.heat == "divergence" else None
    return slow_filtration(edges, counts, filtration.min_concept_size, filtration.max_steps, divergences)


def groups_at(filtration: Filtration, n_edges: int, min_size: int) -> list[tuple[int, ...]]:
    """Objects of the components of the first edges; largest first, then by the smallest vertex."""
    vertices = filtration.space_.vertices_
    joined = [tuple(edge) for edge in filtration.edges_[:n_edges].tolist()]
    groups = components(joined, len(filtration.space_.multiplicities_))
    objects = [tuple(np.flatnonzero(np.isin(vertices, list(group))).tolist()) for group in groups]
    return sorted((one for one in objects if len(one) >= min_size), key=len, reverse=True)


def members(concepts) -> list[tuple[int, ...]]:
    return [tuple(concept.members.tolist()) for concept in concepts]


@by_both_heats
@pytest.mark.parametrize("seed", range(60))
def test_against_fractions_and_sets(seed, heat):
    filtration, rows = example(seed, heat)
    slow = slowly(filtration)
    assert [tuple(edge) for edge in filtration.edges_.tolist()] == slow.edges
    np.testing.assert_allclose(filtration.times_, np.array(slow.times, float), rtol=1e-12)
    assert len(set(slow.times)) == len(set(filtration.times_.tolist())), (
        "equal times are equal to the last bit"
    )
    assert [tuple(pair) for pair in filtration.annexations_.tolist()] == slow.annexations
    ends, counts = filtration.annexations()
    assert counts.tolist() == slow.counts
    np.testing.assert_allclose(ends, np.arange(1, len(counts) + 1) / len(counts))
    assert counts.sum() == len(filtration.times_)

    assert filtration.epsilon_max_ == filtration.concept_time_
    if slow.epsilon_max is None:
        assert filtration.epsilon_max_ is None and filtration.concepts_ == []
        assert (filtration.labels_ == -1).all()
    else:
        np.testing.assert_allclose(filtration.epsilon_max_, float(slow.epsilon_max), rtol=1e-12)
        n_edges = sum(time <= slow.epsilon_max for time in slow.times)
        expected = groups_at(filtration, n_edges, filtration.min_concept_size)
        assert members(filtration.concepts_) == expected and len(expected) >= 2
        assert 2 * len(expected[0]) <= (filtration.space_.vertices_ >= 0).sum()
        labels = np.full(rows.shape[0], -1)
        for number, group in enumerate(expected):
            labels[list(group)] = number
        np.testing.assert_array_equal(filtration.labels_, labels)
    assert filtration.labels_.dtype == np.int32 and filtration.labels_.shape == (rows.shape[0],)


@by_both_heats
def test_examples_are_worth_comparing(heat):
    filtrations = [example(seed, heat)[0] for seed in range(60)]
    found = [one.epsilon_max_ is not None for one in filtrations]
    assert 15 < sum(found) < 55
    assert sum(len(one.concepts_) > 2 for one in filtrations) > 5
    assert sum(len(set(one.times_.tolist())) < len(one.times_) for one in filtrations) > 20


@by_both_heats
@pytest.mark.parametrize("seed", range(0, 60, 5))
def test_concepts_at_any_time(seed, heat):
    filtration, _ = example(seed, heat)
    times = filtration.times_
    middles = (times[:-1] + times[1:]) / 2
    for time in np.unique(np.concatenate([times[::2], middles[::3], [0, 0.5, 1]])):
        n_edges = int((times <= time).sum())
        for min_size in (1, 2, 5):
            concepts = filtration.groups_at(time, min_size)
            assert members(concepts) == groups_at(filtration, n_edges, min_size)
            for concept in concepts:
                check_life(filtration, concept, time)
        assert members(filtration.groups_at(time)) == groups_at(
            filtration, n_edges, filtration.min_concept_size
        )


@by_both_heats
@pytest.mark.parametrize("seed", range(0, 60, 6))
def test_concepts_are_components_of_scipy(seed, heat):
    filtration, _ = example(seed, heat)
    n, (a, b) = len(filtration.space_.multiplicities_), filtration.edges_.T
    for time in (0, 0.2, 0.5, 0.8, 1):
        entered = filtration.times_ <= time
        graph = coo_matrix((np.ones(entered.sum()), (a[entered], b[entered])), (n, n))
        n_groups, group = connected_components(graph, directed=False)
        placed = filtration.space_.vertices_ >= 0
        group_of = np.where(placed, group[filtration.space_.vertices_], -1)
        expected = {tuple(np.flatnonzero(group_of == k).tolist()) for k in range(n_groups)}
        found = members(filtration.groups_at(time, 1))
        assert set(found) == expected and len(found) == n_groups


def check_life(filtration: Filtration, concept, time: float) -> None:
    """It is there from its birth to just before its death, and not before or after."""
    own = set(filtration.space_.vertices_[concept.members].tolist())
    inside = [t for t, edge in zip(filtration.times_, filtration.edges_, strict=True) if own.issuperset(edge)]
    leaving = [
        t for t, (a, b) in zip(filtration.times_, filtration.edges_, strict=True) if (a in own) != (b in own)
    ]
    assert concept.birth == max(inside, default=0) <= time
    assert concept.death == min(leaving, default=np.inf) > time
    assert concept.lifetime == min(concept.death, 1) - concept.birth
    assert concept.size == len(concept.members) and concept.name == ""


@pytest.mark.parametrize("seed", range(12))
@no_concepts_are_no_news
def test_medoid(seed):
    rng = np.random.default_rng(seed)
    rows = random_rows(rng, 40, 15, 0.4)
    rows = np.concatenate([rows, rows[:10], rows[:4]])
    filtration = Filtration().fit(rows)
    checked = 0
    for time in (0, 0.3, 0.6, 1):
        for concept in filtration.groups_at(time, min_size=1):
            means = slow_divergences(rows[concept.members], rows[concept.members]).mean(axis=1)
            assert concept.medoid in concept.members
            assert means[concept.members == concept.medoid] <= means.min() + 1e-12
            # Of several objects at its place, it is the first.
            place = filtration.space_.vertices_
            assert concept.medoid == np.flatnonzero(place == place[concept.medoid])[0]
            checked += concept.size > 2
    assert checked > 3


@no_concepts_are_no_news
def test_medoid_of_a_large_group():
    """Its mean is over a part of the group: nearly the smallest, and the same for any order of the rows."""
    rng = np.random.default_rng(0)
    rows = random_rows(rng, 400, 8, 1.0)
    medoid = Filtration().fit(rows).groups_at(1)[0].medoid
    means = slow_divergences(rows[:20], rows).mean(axis=1)
    mean = slow_divergences(rows[[medoid]], rows).mean()
    assert mean < np.quantile(means, 0.2)
    order = rng.permutation(400)
    assert order[Filtration().fit(rows[order]).groups_at(1)[0].medoid] == medoid


@by_both_heats
@pytest.mark.parametrize("seed", range(0, 60, 3))
def test_diagram_against_gudhi_and_ripser(seed, heat):
    gudhi = pytest.importorskip("gudhi")
    ripser = pytest.importorskip("ripser")
    filtration, _ = example(seed, heat)
    n, (a, b) = len(filtration.space_.multiplicities_), filtration.edges_.T
    diagram = filtration.diagram()
    assert diagram.shape == (n, 2) and (diagram[:, 0] == 0).all() and np.isinf(diagram[:, 1]).sum() == 1
    complex_ = gudhi.SimplexTree()
    for vertex in range(n):
        complex_.insert([vertex], 0.0)
    for end, other, time in zip(a, b, filtration.times_, strict=True):
        complex_.insert([end, other], time)
    complex_.compute_persistence(min_persistence=-1)
    expected = complex_.persistence_intervals_in_dimension(0)
    np.testing.assert_array_equal(np.sort(diagram[:, 1]), np.sort(expected[:, 1]))
    graph = coo_matrix((np.tile(filtration.times_, 2), (np.r_[a, b], np.r_[b, a])), (n, n))
    expected = ripser.ripser(graph.tocsr(), distance_matrix=True, maxdim=0)["dgms"][0]
    np.testing.assert_allclose(np.sort(diagram[:, 1]), np.sort(expected[:, 1]), rtol=1e-6)


@by_both_heats
@pytest.mark.parametrize("seed", range(0, 60, 7))
def test_filtration_graph(seed, heat):
    filtration, _ = example(seed, heat)
    graph = filtration.graph()
    vertices = filtration.space_.vertices_
    assert {v: data["objects"] for v, data in graph.nodes(data=True)} == {
        v: np.flatnonzero(vertices == v).tolist() for v in range(len(filtration.space_.multiplicities_))
    }
    assert set(graph.edges(data="time")) == {
        (*pair, t) for pair, t in zip(filtration.annexations_.tolist(), filtration.times_, strict=True)
    }
    assert graph.number_of_edges() == len(filtration.times_)
    # Every class but the last dies once, at the time in the diagram.
    deaths = filtration.diagram()[:, 1]
    for vertex in graph:
        out = [time for _, _, time in graph.out_edges(vertex, data="time")]
        assert out == ([deaths[vertex]] if np.isfinite(deaths[vertex]) else [])


@pytest.mark.parametrize(
    ("heat", "stop"),
    [("divergence", "persistence"), ("divergence", "annexations"), ("geodesic", "annexations")],
)
@pytest.mark.parametrize("seed", range(5))
@no_concepts_are_no_news
def test_order_of_the_rows_does_not_matter(seed, heat, stop):
    rng = np.random.default_rng(seed)
    rows = uniform_rows(rng, 60, 9, 3) if seed % 2 else random_rows(rng, 60, 12, 0.2)
    order = rng.permutation(60)
    one, other = (Filtration(heat=heat, stop=stop).fit(one) for one in (rows, rows[order]))
    assert (one.epsilon_max_, one.concept_time_) == (other.epsilon_max_, other.concept_time_)
    np.testing.assert_array_equal(one.labels_[order], other.labels_)
    np.testing.assert_array_equal(one.times_, other.times_)
    np.testing.assert_array_equal(one.annexations_, other.annexations_)
    for time in (0.2, 0.5, 0.9):
        concepts = other.groups_at(time, 1)
        assert [set(order[c.members]) for c in concepts] == [set(c.members) for c in one.groups_at(time, 1)]


LARGE = "most at one place"
TRIVIAL = {
    "one object": [[1, 2]],
    "two objects": [[1, 2], [2, 1]],
    "three objects": [[1, 2, 0], [2, 1, 0], [0, 1, 1]],
    "all equal": [[1, 2]] * 9,
    "all disjoint": np.eye(9),
    "star": rows_of_tree([(0, k) for k in range(1, 9)], [1] * 9),
    LARGE: rows_of_tree([(0, 1), (1, 2), (2, 3), (3, 4)], [9, 3, 1, 1, 3]),
    "nothing but empty rows": np.zeros((5, 3)),
    "no columns": np.zeros((5, 0)),
    "no columns, sparse": csr_matrix((5, 0)),
}


@pytest.mark.parametrize("name", TRIVIAL)
@by_both_heats
def test_no_state_that_is_not_trivial(name, heat):
    with pytest.warns(UserWarning, match="none with more than half: no object is in a concept") as caught:
        filtration = Filtration(heat=heat, stop="annexations").fit(TRIVIAL[name])
    assert caught[0].filename == __file__
    assert filtration.epsilon_max_ is None and filtration.concepts_ == []
    assert filtration.concept_time_ is None
    n = np.shape(TRIVIAL[name])[0]
    assert filtration.labels_.tolist() == [-1] * n
    placed = int((filtration.space_.vertices_ >= 0).sum())
    everything = filtration.groups_at(1, min_size=1)
    assert [concept.size for concept in everything] == ([placed] if placed else [])
    assert (
        filtration.annexations()[1].sum()
        == len(filtration.times_)
        == len(filtration.diagram()) - bool(placed)
    )
    assert filtration.graph().number_of_nodes() == len(filtration.space_.multiplicities_)


@pytest.mark.parametrize(
    "name", ["one object", "two objects", "all disjoint", "nothing but empty rows", "no columns"]
)
def test_nothing_that_is_left_is_a_concept(name):
    with pytest.warns(UserWarning, match="leaves no class of at least 3 objects: no object is in a concept"):
        filtration = Filtration().fit(TRIVIAL[name])
    assert filtration.concepts_ == [] and filtration.concept_time_ is None
    assert (filtration.labels_ == -1).all() and filtration.concepts_at(0.5) == []
    assert len(filtration.times_) == max(len(filtration.diagram()) - 1, 0)


@pytest.mark.parametrize("name", ["three objects", "all equal", "star", LARGE])
def test_a_single_concept(name):
    """Of one kind there is one concept, without a warning."""
    filtration = Filtration().fit(TRIVIAL[name])
    n = np.shape(TRIVIAL[name])[0]
    assert [concept.size for concept in filtration.concepts_] == [n]
    assert filtration.labels_.tolist() == [0] * n
    assert filtration.concept_time_ == 1 - filtration.granularity_


def test_all_edges_equally_hot():
    with pytest.warns(UserWarning):
        filtration = Filtration(**PAPER).fit(TRIVIAL["star"])
    assert filtration.times_.tolist() == [1] * 8
    ends, counts = filtration.annexations()
    assert (ends.tolist(), counts.tolist()) == ([1], [8])
    assert [c.size for c in filtration.groups_at(1 - 1e-12, 1)] == [1] * 9
    only = filtration.groups_at(1)[0]
    assert (only.birth, only.death, only.lifetime) == (1, np.inf, 0)


def test_two_bunches():
    """Two stars, their centres joined by a path of one more: leaves go first, the bridge last."""
    edges = [(0, k) for k in range(1, 6)] + [(6, k) for k in range(7, 12)] + [(0, 12), (12, 6)]
    filtration = Filtration(**PAPER).fit(rows_of_tree(edges, [1] * 13))
    assert members(filtration.concepts_) == [(0, 1, 2, 3, 4, 5), (6, 7, 8, 9, 10, 11)] or members(
        filtration.concepts_
    ) == [(6, 7, 8, 9, 10, 11), (0, 1, 2, 3, 4, 5)]
    assert filtration.labels_[12] == -1
    assert all(c.medoid in c.members and c.death == 1 for c in filtration.concepts_)
    # The leaves join at 11/23, in the second of three steps.
    assert [c.birth for c in filtration.concepts_] == pytest.approx([11 / 23] * 2)
    assert filtration.epsilon_max_ == pytest.approx(2 / 3)


def test_multiples_are_concepts_from_the_start():
    filtration = Filtration().fit(rows_of_tree([(k, k + 1) for k in range(5)], [3, 1, 1, 1, 1, 4]))
    concepts = filtration.groups_at(0)
    assert [c.size for c in concepts] == [4, 3] and [c.birth for c in concepts] == [0, 0]
    assert [c.medoid for c in concepts] == [7, 0]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"min_concept_size": 1}, r"an int in the range \[2, 2147483647\]. Got 1"),
        ({"min_concept_size": 2.5}, r"an int in the range \[2, 2147483647\]. Got 2.5"),
        ({"min_concept_size": True}, r"an int in the range \[2, 2147483647\]. Got 'True'"),
        ({"max_steps": 0}, r"an int in the range \[1, 2147483647\]. Got 0"),
        ({"max_steps": "many"}, r"an int in the range \[1, 2147483647\]. Got 'many'"),
        # The names come in the order of a set.
        ({"heat": "warm"}, r"a str among {('divergence'|'geodesic'|, ){3}}. Got 'warm'"),
        ({"stop": None}, r"a str among {('persistence'|'annexations'|, ){3}}. Got None"),
        ({"error_rate": 1.1}, r"a float in the range \[0.0, 1.0\]. Got 1.1"),
        ({"error_rate": np.nan}, r"a float in the range \[0.0, 1.0\]. Got nan"),
        ({"granularity": -0.1}, r"a float in the range \[0.0, 1.0\] or None. Got -0.1"),
        ({"max_vertices": 1}, r"an int in the range \[2, 2147483647\]. Got 1"),
    ],
)
def test_bad_parameters(parameters, message):
    (name,) = parameters
    with pytest.raises(ValueError, match=f"The '{name}' parameter of Filtration must be {message} instead"):
        Filtration(**parameters).fit(np.eye(4))


def test_persistence_needs_divergences():
    with pytest.raises(ValueError, match="heat must be 'divergence' where stop is 'persistence', got 'geode"):
        Filtration(heat="geodesic").fit(np.eye(4))
    filtration, _ = example(0)
    with pytest.raises(ValueError, match="no granularities, where stop is 'annexations': groups_at gives"):
        filtration.concepts_at(0.5)


def test_bad_time_and_size():
    filtration, _ = example(0)
    for time in (-0.1, 1.1, np.nan):
        with pytest.raises(ValueError, match="time must be between 0 and 1"):
            filtration.groups_at(time)
    for size in (0, 1.5):
        with pytest.raises(ValueError, match="min_size must be an integer of at least 1"):
            filtration.groups_at(0.5, size)
