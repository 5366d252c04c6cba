"""Which concept is which of before: identities outlive updates, and what became of the others is told."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

KINDS = ("born", "grown", "split", "merged", "dissolved")
# Of the members that a concept had before, or that one has which was there before.
_MOST = 0.5


class Change(NamedTuple):
    """What an update did to a concept.

    Attributes
    ----------
    kind : {"born", "grown", "split", "merged", "dissolved"}
        A concept that splits keeps its identity in its largest part; `others` are those of the parts that
        came from it. One that merges gives its members to another, and its identity ends there; `others` is
        that other one. One that dissolves leaves its members in no concept, or in many.
    key : int
        Identity of the concept.
    others : tuple of int
    n_before, n_after : int
        Number of its members before and after; 0 where it was not there.
    """

    kind: str
    key: int
    others: tuple[int, ...]
    n_before: int
    n_after: int


class Identities(NamedTuple):
    """Identities of the concepts after an update.

    Attributes
    ----------
    keys : tuple of int
        Of each concept, in their order.
    n_given : int
        How many identities were ever given: the next new one.
    changes : tuple of Change
        Of all concepts whose members are others, or more.
    """

    keys: tuple[int, ...]
    n_given: int
    changes: tuple[Change, ...]


def identities_after(
    before: NDArray[np.integer],
    after: NDArray[np.integer],
    keys_before: Sequence[int],
    n_after: int,
    n_given: int,
) -> Identities:
    """Carry identities over to the concepts of an update.

    Concepts are matched so that as many objects as possible stay in a concept of the same identity. A match
    counts if the two share more than half of the objects of one of them.

    Parameters
    ----------
    before : (m,) int
        Concept of each object that was there before, as a position in `keys_before`, -1 for none.
    after : (n,) int
        Concept of the same objects, followed by new ones.
    keys_before : sequence of int
    n_after : int
        Number of concepts after the update.
    n_given : int
        How many identities were given so far.
    """
    sizes_before = np.bincount(before[before >= 0], minlength=len(keys_before))
    sizes_after = np.bincount(after[after >= 0], minlength=n_after)
    shared = np.zeros((len(keys_before), n_after), np.int64)
    in_both = (before >= 0) & (after[: len(before)] >= 0)
    np.add.at(shared, (before[in_both], after[: len(before)][in_both]), 1)
    known_after = shared.sum(axis=0)

    match_of = np.full(n_after, -1)
    for old, new in zip(*linear_sum_assignment(-shared), strict=True):
        overlap = shared[old, new]
        if overlap > _MOST * sizes_before[old] or overlap > _MOST * max(known_after[new], 1):
            match_of[new] = old
    keys = []
    for new in range(n_after):
        keys.append(int(keys_before[match_of[new]]) if match_of[new] >= 0 else n_given)
        n_given += int(match_of[new] < 0)
    return Identities(
        tuple(keys),
        n_given,
        _changes(shared, sizes_before, sizes_after, match_of, tuple(keys_before), tuple(keys)),
    )


def _changes(
    shared: NDArray[np.int64],
    sizes_before: NDArray[np.int64],
    sizes_after: NDArray[np.int64],
    match_of: NDArray[np.int64],
    keys_before: tuple[int, ...],
    keys: tuple[int, ...],
) -> tuple[Change, ...]:
    changes = []
    parts_of: dict[int, list[int]] = {}
    for new in np.flatnonzero(match_of < 0).tolist():
        old = int(shared[:, new].argmax()) if len(keys_before) else -1
        came_from_one = old >= 0 and shared[old, new] > _MOST * sizes_after[new]
        if came_from_one:
            parts_of.setdefault(old, []).append(new)
        changes.append(Change("born", keys[new], (), 0, int(sizes_after[new])))
    for old, key in enumerate(keys_before):
        matched = np.flatnonzero(match_of == old)
        n_before = int(sizes_before[old])
        if len(matched) == 0:
            into = int(shared[old].argmax()) if len(keys) else -1
            has_joined = into >= 0 and shared[old, into] > _MOST * n_before
            others: tuple[int, ...] = (keys[into],) if has_joined else ()
            changes.append(Change("merged" if has_joined else "dissolved", key, others, n_before, 0))
            continue
        n_after = int(sizes_after[matched[0]])
        if old in parts_of:
            others = tuple(keys[new] for new in parts_of[old])
            changes.append(Change("split", key, others, n_before, n_after))
        elif n_after != n_before or shared[old, matched[0]] != n_before:
            changes.append(Change("grown", key, (), n_before, n_after))
    return tuple(sorted(changes, key=lambda change: change.key))
