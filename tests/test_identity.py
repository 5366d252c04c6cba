"""Identities of concepts across updates."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.concepts.identity import KINDS, identities_after


def after(before, labels, keys=None):
    before, labels = np.array(before), np.array(labels)
    keys = list(range(before.max(initial=-1) + 1)) if keys is None else keys
    return identities_after(before, labels, keys, int(labels.max(initial=-1)) + 1, max(keys, default=-1) + 1)


def kinds(identities):
    return {change.key: (change.kind, change.others) for change in identities.changes}


def test_numbers_change_and_identities_do_not():
    found = after([0, 0, 0, 1, 1], [1, 1, 1, 0, 0, 0, 0, 0], keys=[7, 3])
    assert found.keys == (3, 7)
    assert kinds(found) == {3: ("grown", ())}
    assert found.n_given == 8


def test_a_split_leaves_the_identity_to_the_largest_part():
    found = after([0] * 10, [0] * 6 + [1] * 4)
    assert found.keys == (0, 1)
    assert kinds(found) == {0: ("split", (1,)), 1: ("born", ())}


def test_a_merged_concept_gives_its_identity_up():
    found = after([0] * 6 + [1] * 4, [0] * 10)
    assert found.keys == (0,)
    assert kinds(found) == {0: ("grown", ()), 1: ("merged", (0,))}


def test_what_is_new_is_born():
    found = after([0, 0, -1, -1, -1], [0, 0, 1, 1, 1, 1])
    assert found.keys == (0, 1)
    assert kinds(found) == {1: ("born", ())}


def test_what_is_in_none_any_more_has_dissolved():
    found = after([0, 0, 1, 1], [0, 0, -1, -1])
    assert kinds(found) == {1: ("dissolved", ())}


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.integers(-1, 4), st.integers(-1, 4)), max_size=60),
    st.lists(st.integers(-1, 4), max_size=20),
    st.permutations([11, 5, 8, 2, 0]),
)
def test_identities_of_anything(pairs, new, keys):
    before = np.array([a for a, _ in pairs], int)
    labels = np.array([b for _, b in pairs] + new, int)
    found = identities_after(before, labels, keys, 5, 12)
    assert len(found.keys) == len(set(found.keys)) == 5
    assert all(key in keys or 12 <= key < found.n_given for key in found.keys)
    assert found.n_given == 12 + sum(key not in keys for key in found.keys)
    told = {change.key: change for change in found.changes}
    assert len(told) == len(found.changes)
    for old, key in enumerate(keys):
        members = set(np.flatnonzero(before == old).tolist())
        if key not in found.keys:
            assert told[key].kind in ("merged", "dissolved")
            continue
        now = set(np.flatnonzero(labels[: len(before)] == found.keys.index(key)).tolist())
        shared = len(members & now)
        assert shared > len(members) / 2 or shared > len({i for i in now if before[i] >= 0}) / 2
    assert {change.kind for change in found.changes} <= set(KINDS)
