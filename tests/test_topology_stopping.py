"""The time at which concepts are taken, against an enumeration of all states."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts import Filtration
from shapeconcepts.topology.stopping import States, longest_state
from topology_reference import random_rows, random_tree, rows_of_tree, slow_longest_state, uniform_rows


def fitted(rows, **parameters) -> Filtration:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return Filtration(**parameters).fit(rows)


def check(filtration: Filtration) -> None:
    expected = slow_longest_state(
        filtration.times_.tolist(),
        lambda time: len(filtration.concepts_at(time)),
        int((filtration.space_.vertices_ >= 0).sum()),
    )
    assert filtration.concept_time == filtration.concept_time_ == expected
    if expected is None:
        assert filtration.concepts_ == [] and (filtration.labels_ == -1).all()
        return
    assert len(filtration.concepts_) >= 2
    for number, concept in enumerate(filtration.concepts_):
        assert concept.birth <= expected < concept.death
        assert np.flatnonzero(filtration.labels_ == number).tolist() == concept.members.tolist()
    # Something begins with the state.
    assert expected in filtration.times_


@pytest.mark.parametrize("heat", ["separation", "geodesic"])
@given(
    n=st.integers(1, 40),
    seed=st.integers(0, 10**6),
    kind=st.sampled_from(["random", "uniform", "tree", "disjoint", "equal"]),
    min_size=st.integers(2, 5),
)
@settings(max_examples=120, deadline=None)
def test_longest_state(heat, n, seed, kind, min_size):
    rng = np.random.default_rng(seed)
    if kind == "tree":
        rows = rows_of_tree(random_tree(rng, n), rng.integers(1, 5, n).tolist())
    else:
        rows = {
            "random": random_rows(rng, n, 8, 0.4),
            "uniform": uniform_rows(rng, n, 7, 3),
            "disjoint": np.eye(n),
            "equal": np.ones((n, 2)),
        }[kind]
    check(fitted(rows, heat=heat, min_concept_size=min_size))


@pytest.mark.parametrize("n", range(2, 9))
@pytest.mark.parametrize("seed", range(8))
def test_a_few_objects(n, seed):
    rng = np.random.default_rng(seed)
    filtration = fitted(random_rows(rng, n, 5, 0.9) + 0.01, min_concept_size=2)
    check(filtration)
    assert (filtration.concept_time is None) or n >= 4


def test_examples_are_worth_comparing():
    found = [
        fitted(random_rows(np.random.default_rng(seed), 40, 8, 0.4), min_concept_size=2) for seed in range(20)
    ]
    assert all(one.concept_time is not None for one in found)
    assert len({len(one.concepts_) for one in found}) >= 3


def test_clear_bunches_are_found():
    rng = np.random.default_rng(0)
    kinds = np.kron(np.eye(5), np.ones(6))
    which = np.repeat(np.arange(5), 10)
    filtration = Filtration().fit(kinds[which] * rng.gamma(20, 1, (50, 30)) + 0.001)
    np.testing.assert_array_equal(filtration.labels_[:, None] == filtration.labels_, which[:, None] == which)


def states(times: list[float], n_concepts: list[int], n_objects: int) -> States:
    return States(np.array(times), np.array(n_concepts), np.ones(len(times), int), n_objects)


def test_rule():
    # Of 3 or 4 concepts of 32 objects, the one that lasts longest for its time, not by the clock.
    assert longest_state(states([0.1, 0.15, 0.5, 0.9, 1], [4, 4, 3, 3, 1], 32)) == 0.15
    assert longest_state(states([0.1, 0.15, 0.25, 0.9, 1], [4, 4, 3, 3, 1], 32)) == 0.25
    # As long as they become more, most objects are in none.
    assert longest_state(states([0.1, 0.3, 0.5, 0.9, 1], [3, 4, 4, 3, 1], 32)) == 0.5
    # More concepts than 4, or fewer than 3, last longer, but do not compete.
    assert longest_state(states([0.01, 0.5, 0.6, 0.7, 1], [5, 4, 3, 2, 1], 32)) == 0.5
    # Of 27 to 36 concepts of 900 objects; of 400, a 24th of which is 16.7, of 17 to 24; without any, the
    # nearest.
    assert longest_state(states([0.1, 0.2, 0.5, 0.6, 1], [37, 36, 27, 26, 1], 900)) == 0.2
    assert longest_state(states([0.1, 0.2, 0.5, 0.6, 1], [25, 24, 17, 16, 1], 400)) == 0.2
    assert longest_state(states([0.1, 0.2, 0.3, 1], [2, 3, 2, 1], 400)) == 0.2
    assert longest_state(states([0.1, 0.2, 0.3, 1], [40, 30, 28, 1], 400)) == 0.3
    # In small sets fewer: at most 5 of 40 objects, whose root is above 6; 3 of 60 will do, and 4 of 90, whose
    # roots are above 7 and 9.
    assert longest_state(states([0.1, 0.5, 0.6, 0.9, 1], [6, 5, 5, 2, 1], 40)) == 0.6
    assert longest_state(states([0.1, 0.2, 0.3, 0.9, 1], [30, 5, 3, 2, 1], 60)) == 0.3
    assert longest_state(states([0.1, 0.2, 0.3, 0.9, 1], [30, 5, 4, 3, 1], 90)) == 0.3
    # No more than 2 of 23.
    assert longest_state(states([0.1, 0.2, 0.3, 1], [4, 3, 2, 1], 23)) == 0.3
    # Of several annexations at one time, the state is that after the last.
    assert longest_state(states([0.1, 0.1, 0.5, 1], [4, 3, 1, 1], 32)) == 0.1
    assert longest_state(states([0.1, 0.1, 0.5, 1], [4, 1, 1, 1], 32)) is None
    # The first of equally long ones.
    assert longest_state(states([0.1, 0.125, 0.25, 0.5, 1], [4, 3, 3, 3, 1], 32)) == 0.125


@pytest.mark.parametrize(
    ("times", "n_concepts"),
    [([], []), ([1.0], [1]), ([1.0], [2]), ([1.0] * 4, [2, 3, 2, 1]), ([0.2, 0.4, 1], [0, 1, 1])],
)
def test_no_state_of_two_concepts(times, n_concepts):
    assert longest_state(states(times, n_concepts, 9)) is None
