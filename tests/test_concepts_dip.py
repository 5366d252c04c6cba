"""The dip, against a linear programme made of its definition, and its p-value, against fresh draws."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from shapeconcepts.concepts.dip import SIZES, dip_p_value, dip_statistic


def slow_dip(values: list[float]) -> float:
    """Smallest distance of the empirical distribution function to a unimodal one with its mode at a value.

    A mode between two values can be moved to one of them, where the function may jump.
    """
    places, counts = np.unique(values, return_counts=True)
    after = counts.cumsum() / len(values)
    before = after - counts / len(values)
    distances = [distance_with_mode(places, before, after, mode) for mode in range(len(places))]
    return max(min(distances), 0.5 / len(values))


def distance_with_mode(places: np.ndarray, before: np.ndarray, after: np.ndarray, mode: int) -> float:
    """Smallest distance to a distribution function that is convex before a place and concave behind it.

    The unknowns are the function at each place, and before its jump at the mode in front of that, and the
    distance, which is to be kept on both sides of every step.
    """
    m = len(places)
    left, right = np.arange(mode + 1), np.arange(mode + 1, m + 1)
    rows, limits = [], []

    def at_most(limit: float, terms: dict[int, float]) -> None:
        row = np.zeros(m + 2)
        row[list(terms)] = list(terms.values())
        rows.append(row)
        limits.append(limit)

    for unknown in range(m + 1):
        place = unknown - (unknown > mode)
        lowest = before[place] if unknown == mode else after[place]
        highest = after[place] if unknown == mode + 1 else before[place]
        at_most(highest, {unknown: 1, m + 1: -1})
        at_most(-lowest, {unknown: -1, m + 1: -1})
        if unknown < m:
            at_most(0, {unknown: 1, unknown + 1: -1})
    for side, unknowns in ((1, left), (-1, right)):
        for a, b, c in zip(unknowns, unknowns[1:], unknowns[2:], strict=False):
            x, y, z = places[np.array([a, b, c]) - (side < 0)]
            at_most(0, {a: -side * (z - y), b: side * (z - x), c: -side * (y - x)})
    cost = np.zeros(m + 2)
    cost[-1] = 1
    solution = linprog(cost, np.array(rows), limits, bounds=[(0, 1)] * (m + 2))
    assert solution.success
    return solution.fun


@settings(deadline=None, max_examples=60)
@example([0, 1, 1, 1, 1, 2])
@example([0, 0, 1, 5, 5, 5, 9, 9])
@example([0, 1, 1, 1, 2, 2, 2])
@given(
    st.one_of(
        st.lists(st.integers(0, 4), min_size=1, max_size=14),
        st.lists(st.integers(0, 40), min_size=1, max_size=9),
    )
)
def test_against_the_definition(values):
    assert dip_statistic(values) == pytest.approx(slow_dip(values), abs=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_against_the_definition_with_many_values(seed):
    rng = np.random.default_rng(seed)
    values = np.concatenate([rng.normal(size=12), rng.normal(rng.uniform(0, 5), 0.5, size=10)])
    assert dip_statistic(values) == pytest.approx(slow_dip(values), abs=1e-7)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 17, 1000])
def test_equally_spaced_or_equal_values_have_the_smallest_dip(n):
    for values in (np.arange(n), 0.1 * np.arange(n), np.full(n, -3.7)):
        dip = dip_statistic(values)
        assert dip == pytest.approx(1 / (2 * n), rel=1e-9)
        assert dip_p_value(dip, n) == 1


@pytest.mark.parametrize("n", [1, 2, 5, 500])
def test_two_places_have_the_largest_dip(n):
    assert dip_statistic([3.0] * n + [8.0] * n) == pytest.approx(1 / 4)


@settings(deadline=None)
@given(st.lists(st.integers(-100, 100), min_size=1, max_size=30), st.integers(-1000, 1000), st.randoms())
def test_only_relative_places_matter(values, shift, random):
    values = np.array(values, float)
    dip = dip_statistic(values)
    order = random.sample(range(len(values)), len(values))
    assert dip_statistic(values[order]) == dip
    for factor in (1e-200, 0.37, 2.0, 1e300):
        assert dip_statistic(values * factor) == pytest.approx(dip, abs=1e-12)
    assert dip_statistic(values + shift) == pytest.approx(dip, abs=1e-12)
    assert dip_statistic(-values) == pytest.approx(dip, abs=1e-12)


def test_far_apart_and_near_together():
    largest, tiniest = np.finfo(float).max, np.finfo(float).smallest_subnormal
    assert dip_statistic([-largest, -largest, largest, largest]) == pytest.approx(1 / 4)
    assert dip_statistic([0, tiniest, 1, 1]) == pytest.approx(1 / 4)
    assert dip_statistic([0, 0, tiniest, tiniest]) == pytest.approx(1 / 4)


@pytest.mark.parametrize("values", [[], [[1.0, 2.0]], 3.0, [1.0, np.nan], [np.inf]])
def test_what_has_no_dip(values):
    with pytest.raises(ValueError, match="values must be a sequence of finite numbers"):
        dip_statistic(values)


@pytest.mark.parametrize("n", [4, 8, 13, 50, 300, 9000])
def test_p_value_is_how_often_uniform_values_have_such_a_dip(n):
    rng = np.random.default_rng(n)
    n_draws = 4000 if n < 1000 else 1000
    p_values = np.array([dip_p_value(dip_statistic(rng.random(n)), n) for _ in range(n_draws)])
    for level in (0.05, 0.2):
        tolerance = 3.5 * np.sqrt(level * (1 - level) / n_draws)
        assert np.mean(p_values <= level) == pytest.approx(level, abs=tolerance)


def test_p_value_tells_two_clumps_from_one():
    rng = np.random.default_rng(0)
    one = rng.normal(size=100)
    two = np.concatenate([one[:50], one[50:] + 6])
    assert dip_p_value(dip_statistic(one), 100) > 0.3
    assert 0 < dip_p_value(dip_statistic(two), 100) < 1e-4


@pytest.mark.parametrize("n", [1, 3, *SIZES, 11, 13, 77, 4000, 10**6])
def test_p_value_falls_with_the_dip(n):
    dips = np.linspace(1 / (2 * n), 0.25, 2000)
    p_values = np.array([dip_p_value(dip, n) for dip in dips])
    assert p_values[0] == 1 and (p_values > 0).all()
    assert (np.diff(p_values) <= 0).all()
    if n >= 4:
        assert p_values[-1] < 1e-3
    else:
        assert (p_values == 1).all()


def test_p_value_changes_little_from_size_to_size():
    p_values = [dip_p_value(0.49 / np.sqrt(n), n) for n in range(20, 10_000)]
    assert np.abs(np.diff(p_values)).max() < 0.005
