"""Significant splits, the tree of concepts, and its cuts, against slow versions, SciPy and known bunches."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import false_discovery_control
from sklearn.metrics import adjusted_rand_score

from shapeconcepts import Filtration
from shapeconcepts.concepts.dip import dip_p_value, dip_statistic
from shapeconcepts.concepts.significance import significant
from topology_reference import components, slow_divergences

no_concepts_are_no_news = pytest.mark.filterwarnings("ignore:the filtration of")


def bunches(seed: int, sizes: list[int], spread: float = 20) -> tuple[np.ndarray, np.ndarray]:
    """Rows around centres that have little in common, and the bunch of each, in random order."""
    rng = np.random.default_rng(seed)
    own = np.kron(np.eye(len(sizes)), np.ones(6))
    centres = own / 6 + 0.05 / own.shape[1]
    rows = [rng.dirichlet(spread * centre, size) for centre, size in zip(centres, sizes, strict=True)]
    order = rng.permutation(sum(sizes))
    return np.concatenate(rows)[order], np.repeat(np.arange(len(sizes)), sizes)[order]


def example(seed: int) -> Filtration:
    rng = np.random.default_rng(seed)
    rows, _ = bunches(
        seed, rng.integers(3, 25, rng.integers(1, 6)).tolist(), spread=float(rng.choice([3, 20]))
    )
    rows[rng.random(rows.shape) < 0.1] = 0
    rows = np.concatenate([rows, rows[:4]])
    return Filtration(
        error_rate=float(rng.choice([0.05, 0.5])), min_concept_size=int(rng.integers(2, 6))
    ).fit(rows)


def slow_p_value(divergences: np.ndarray, larger: list[int], smaller: list[int]) -> float:
    """Of the objects of two classes on the axis between them."""
    if len(larger) < len(smaller):
        larger, smaller = smaller, larger
    by_distance = sorted(larger, key=lambda i: divergences[i, smaller].mean())
    near = by_distance[: max(len(smaller), 5)]
    places = []
    for i in near + smaller:
        to_near = [divergences[i, j] for j in near if j != i]
        to_smaller = [divergences[i, j] for j in smaller if j != i]
        places.append((np.mean(to_smaller) if to_smaller else 0.0) - (np.mean(to_near) if to_near else 0.0))
    return dip_p_value(dip_statistic(places), len(places))


@pytest.mark.parametrize("seed", range(8))
@no_concepts_are_no_news
def test_p_values_against_a_slow_version(seed):
    filtration = example(seed)
    rows = filtration.space_.rows_.toarray()
    divergences = slow_divergences(rows, rows)
    np.fill_diagonal(divergences, 0)
    edges = [tuple(edge) for edge in filtration.edges_.tolist()]
    counts = filtration.space_.multiplicities_
    n_tested = 0
    for k, p_value in enumerate(filtration.p_values_.tolist()):
        groups = components(edges[:k], len(rows))
        ends = [sorted(next(g for g in groups if vertex in g)) for vertex in edges[k]]
        sizes = [counts[end].sum() for end in ends]
        assert np.isnan(p_value) == (min(sizes) < filtration.min_concept_size)
        if not np.isnan(p_value):
            n_tested += 1
            # Near ties, the rounding of single precision decides who is compared.
            assert p_value == pytest.approx(slow_p_value(divergences, *ends), abs=0.02, rel=0.3)
    assert n_tested == np.isfinite(filtration.p_values_).sum()


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(0, 1), max_size=30), st.floats(0, 1))
def test_false_discovery_rate_against_scipy(p_values, rate):
    found = significant(np.array([np.nan, *p_values, np.nan]), rate)
    assert not found[0] and not found[-1]
    if p_values:
        adjusted = false_discovery_control(p_values)
        # SciPy multiplies where we divide.
        is_clear = np.abs(adjusted - rate) > 1e-12
        np.testing.assert_array_equal(found[1:-1][is_clear], (adjusted <= rate)[is_clear])


@pytest.mark.parametrize("seed", range(12))
@no_concepts_are_no_news
def test_cuts_against_components(seed):
    """A cut leaves out late edges whose splits are significant, or that are later than such a one within."""
    filtration = example(seed)
    tree, size = filtration.concept_tree_, filtration.min_concept_size
    edges, times = [tuple(e) for e in filtration.edges_.tolist()], filtration.times_
    counts, vertices = filtration.space_.multiplicities_, filtration.space_.vertices_
    splits = significant(filtration.p_values_, filtration.error_rate)
    for granularity in (0.0, 0.05, 0.2, 0.5, 0.9, 1.0, *tree.granularities[:5]):
        late = 1 - granularity
        cut = []
        for k in range(len(edges)):
            groups = components(edges[:k], len(counts))
            ends = [next(g for g in groups if vertex in g) for vertex in edges[k]]
            inner = any(e in cut for e in range(k) if edges[e][0] in ends[0] | ends[1])
            is_large = min(counts[list(end)].sum() for end in ends) >= size
            if times[k] >= 1 or (times[k] > late and ((splits[k] and is_large) or (inner and is_large))):
                cut.append(k)
        kept = [edge for k, edge in enumerate(edges) if k not in cut]
        groups = [
            np.flatnonzero(np.isin(vertices, list(g))).tolist()
            for g in components(kept, len(counts))
            if counts[list(g)].sum() >= size
        ]
        concepts = filtration.concepts_at(granularity)
        assert [c.members.tolist() for c in concepts] == sorted(groups, key=len, reverse=True)
        for concept in concepts:
            assert concept.medoid in concept.members and concept.birth <= concept.death
    assert (filtration.labels_at(1, 1) >= -1).all()


@pytest.mark.parametrize("seed", range(6))
@no_concepts_are_no_news
def test_tree(seed):
    tree = example(seed).concept_tree_
    n = len(tree.parents)
    assert len(tree.births) == len(tree.deaths) == len(tree.p_values) == n
    for group in range(n):
        children = tree.children(group)
        assert len(children) == (0 if np.isnan(tree.p_values[group]) else 2)
        if children:
            members = np.concatenate([tree.members(child) for child in children])
            assert sorted(members.tolist()) == tree.members(group).tolist()
            assert {tree.deaths[child] for child in children} == {tree.births[group]}
        assert (tree.parents[group] < 0) == (tree.deaths[group] == np.inf)
        assert tree.parents[group] < 0 or tree.parents[group] > group
        assert tree.persistence[group] >= 0
    cuts = [tree.cut(granularity) for granularity in np.linspace(0, 1, 30)]
    for coarse, fine in pairwise(cuts):
        sets = [set(tree.members(group)) for group in coarse]
        assert all(any(set(tree.members(group)) <= one for one in sets) for group in fine)


def test_default_granularity_lasts_longest():
    filtration = Filtration().fit(bunches(0, [30, 30, 30])[0])
    tree = filtration.concept_tree_
    middle = filtration.granularity_
    assert 1 / 12 < middle < 1 / 4
    changes = np.concatenate([[1 / 12], tree.granularities, [1 / 4]])
    changes = np.unique(changes[(changes >= 1 / 12) & (changes <= 1 / 4)])
    longest = (changes[1:] / changes[:-1]).argmax()
    assert middle == pytest.approx(np.sqrt(changes[longest] * changes[longest + 1]))


@pytest.mark.parametrize("sizes", [[40] * 3, [12, 20, 60, 200], [8] * 10, [5, 5, 5, 5, 60]])
def test_bunches_are_concepts(sizes):
    rows, bunch = bunches(3, sizes)
    filtration = Filtration().fit(rows)
    assert adjusted_rand_score(bunch, filtration.labels_) > 0.98
    assert len(filtration.concepts_) == len(sizes)


@pytest.mark.parametrize("kind", ["uniform", "gaussian", "dirichlet"])
@pytest.mark.parametrize("n_columns", [2, 5, 50])
def test_noise_is_one_concept(kind, n_columns):
    """In small what benchmarks/noise.py does in large."""
    rng = np.random.default_rng(n_columns)
    draw = {
        "uniform": lambda: rng.random((100, n_columns)),
        "gaussian": lambda: np.abs(rng.normal(4, 1, (100, n_columns))),
        "dirichlet": lambda: rng.dirichlet(np.ones(n_columns), 100),
    }[kind]
    filtrations = [Filtration(error_rate=0.2).fit(draw()) for _ in range(25)]
    assert all(len(one.concepts_) == 1 for one in filtrations)
    # Whatever the granularity, nothing is split more often than the error rate says.
    assert sum(len(one.concepts_at(1)) > 1 for one in filtrations) <= 11


def chain(length: float, n: int) -> np.ndarray:
    """A continuous family of rows, each of which reaches about 6 columns."""
    columns, rng = np.arange(80), np.random.default_rng(0)
    rows = np.exp(-0.5 * ((columns - rng.uniform(5, 5 + length, (n, 1))) / 2) ** 2)
    return np.where(rows < 1e-3, 0, rows)


@pytest.mark.parametrize("n", [100, 1000])
def test_a_short_chain_is_one_concept(n):
    """Its ends have nearly nothing in common, but there is no gap."""
    assert len(Filtration().fit(chain(12, n)).concepts_) == 1


def test_a_long_chain_has_as_many_concepts_however_many_objects():
    assert max(len(Filtration().fit(chain(50, n)).concepts_) for n in (100, 300, 1000)) <= 4


def test_number_does_not_grow_with_the_objects():
    small, large = (Filtration().fit(bunches(5, [size] * 4)[0]) for size in (30, 400))
    assert len(small.concepts_) == len(large.concepts_) == 4


def test_few_places_stand_for_many():
    rows, bunch = bunches(5, [100] * 4)
    filtration = Filtration(max_vertices=150).fit(rows)
    assert adjusted_rand_score(bunch, filtration.labels_) > 0.98


def test_names_stay_in_every_cut():
    filtration = Filtration(granularity=0.1).fit(bunches(0, [30, 30, 30, 30])[0])
    fine = filtration.concepts_at(1.0)
    filtration.concepts_[0].name = "first"
    assert any(concept.name == "first" for concept in filtration.concepts_at(filtration.granularity_))
    fine[-1].name = "last"
    assert filtration.concepts_at(1.0)[-1] is fine[-1]
    other = filtration.at_granularity(1.0)
    assert other.concepts_[-1].name == "last" and other.granularity == other.granularity_ == 1.0
    assert filtration.granularity_ == 0.1 and other.labels_.max() + 1 == len(fine)
    again = Filtration(granularity=1.0).fit(bunches(0, [30, 30, 30, 30])[0])
    np.testing.assert_array_equal(again.labels_, other.labels_)


def test_bad_granularity():
    filtration = Filtration().fit(bunches(0, [10, 10])[0])
    for bad in (-0.1, 1.1, np.nan, "fine", True, None):
        for call in (filtration.concepts_at, filtration.at_granularity):
            with pytest.raises(ValueError, match="granularity must be a number from 0 to 1, got"):
                call(bad)


@pytest.mark.parametrize(
    "rows", [np.ones((40, 3)), np.eye(3).repeat(20, axis=0), np.eye(40), np.tile([[1.0, 2.0]], (2, 1))]
)
def test_degenerate(rows):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        filtration = Filtration().fit(rows)
    expected = {len(set(map(tuple, rows)))} if len(rows) / len(set(map(tuple, rows))) >= 3 else {0}
    assert {len(filtration.concepts_at(g)) for g in (0, 0.5, 1)} == expected


def test_nothing_stays_of_the_fit_before():
    rows, _ = bunches(0, [20, 20])
    filtration = Filtration().fit(rows)
    assert filtration.concept_tree_ is not None
    filtration.set_params(stop="annexations").fit(rows)
    assert filtration.concept_tree_ is None and filtration._group_names() == []
    with pytest.raises(ValueError, match="no granularities"):
        filtration.concepts_at(0.5)


@given(st.integers(0, 400))
@settings(deadline=None, max_examples=25)
@no_concepts_are_no_news
def test_groups_within_groups_against_a_slow_version(seed):
    filtration = example(seed)
    tree, groups = filtration.concept_tree_, filtration.group_tree()
    coarse = [frozenset(tree.members(group).tolist()) for group in range(len(tree.parents))][::-1]
    assert [members_within(groups, number) for number in range(len(coarse))] == coarse

    # What has formed within the smallest groups, edge by edge.
    vertices = filtration.space_.vertices_
    group_of = tree.group_of_object
    within = [
        edge
        for edge in filtration.edges_.tolist()
        if len({group_of[i] for i in np.flatnonzero(np.isin(vertices, edge))}) == 1
        and group_of[np.flatnonzero(vertices == edge[0])[0]] >= 0
    ]
    formed = []
    for n_entered in range(len(within) + 1):
        for component in components(within[:n_entered], len(filtration.space_.multiplicities_)):
            members = frozenset(np.flatnonzero(np.isin(vertices, list(component))).tolist())
            is_group = len(members) >= filtration.min_concept_size and members <= set(
                np.flatnonzero(group_of >= 0)
            )
            if is_group and members not in formed and members not in coarse:
                formed.append(members)
    finer = [members_within(groups, number) for number in range(len(coarse), len(groups.parents))]
    assert len(finer) == len(set(finer)) and set(finer) == set(formed)
    is_below = groups.parents < np.arange(len(groups.parents))
    assert is_below.all()
    assert all(
        members_within(groups, number) < members_within(groups, parent)
        for number, parent in enumerate(groups.parents.tolist())
        if parent >= 0
    )
    few = groups.coarsest(5)
    assert [members_within(few, number) for number in range(len(few.parents))] == (coarse + finer)[:5]


def members_within(groups, number: int) -> frozenset[int]:
    """Objects in a group or in a part of it."""
    inside = set()
    for one, group in enumerate(groups.group_of_object.tolist()):
        while group not in (-1, number):
            group = int(groups.parents[group])
        if group == number:
            inside.add(one)
    return frozenset(inside)


def test_fewer_groups_than_roots():
    rows = np.kron(np.eye(3), np.ones((8, 4))) + np.kron(np.eye(3), np.random.default_rng(0).random((8, 4)))
    groups = Filtration(min_concept_size=3).fit(rows).group_tree()
    assert (groups.parents == -1).sum() == 3
    distances = np.random.default_rng(1).random((2, 24))
    means = groups.coarsest(1).mean_distances(distances, np.arange(24), np.full(2, -1))
    inside = sorted(members_within(groups, 0))
    np.testing.assert_allclose(means, distances[:, inside].mean(axis=1)[:, None])
