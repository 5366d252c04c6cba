"""From what was learned and what was said of it to the concepts as the user has them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.corrections.edit import NONE, Edit, Link
from shapeconcepts.corrections.scan_references import ScanReferences

# (rows, candidates) -> position in the candidates of the one that each row is most like.
MostAlike = Callable[[NDArray[np.int64], NDArray[np.int64]], NDArray[np.int64]]
# A concept that came to be later is what became of an earlier one that gave it such a share of its scans.
_OF_THEM = 1 / 4
# By these the user says of each scan where it belongs; by others, of groups as wholes.
_OF_EACH_SCAN = ("move", "foreign", "link", "confirm")


@dataclass
class Corrected:
    """What the user has.

    Attributes
    ----------
    keys, learned_keys : (n,) int64
        Concept of each scan, by its key, with all edits and without any, -1 for none.
    is_foreign, is_certain : (n,) bool
        Whether the user said that it is something foreign, or where it belongs.
    names : dict of int to str
        What concepts are called, by key.
    linked_by : dict of Link to int
        What is to be together or apart, and the number of the edit that says so.
    unfit : dict of int to str
        Edits that no longer fit, by number, with the reason.
    next_key : int
        The smallest key that is larger than all others.
    """

    keys: NDArray[np.int64]
    learned_keys: NDArray[np.int64]
    is_foreign: NDArray[np.bool_]
    is_certain: NDArray[np.bool_]
    names: dict[int, str]
    next_key: int
    linked_by: dict[Link, int] = field(default_factory=dict)
    unfit: dict[int, str] = field(default_factory=dict)

    @property
    def links(self) -> list[Link]:
        """What is to be together or apart."""
        return list(self.linked_by)

    def is_concept(self, key: int) -> bool:
        """Whether a scan is in it."""
        return bool((self.keys == key).any())


def replay(
    keys: NDArray[np.int64],
    names: dict[int, str],
    next_key: int,
    edits: Sequence[Edit],
    references: ScanReferences,
    most_alike: MostAlike,
) -> Corrected:
    """Apply edits to concepts that were learned.

    Where scans are named, what was said of them holds in any model that has them. Scans that are not, as they
    came later, go where the most alike of the named ones goes if their concept was parted or joined.

    Parameters
    ----------
    keys : (n,) int64
        Learned concept of each scan, by its key, -1 for none.
    names : dict of int to str
        Names of learned concepts, by key.
    next_key : int
        The smallest key that is larger than all that were ever given.
    edits : sequence of Edit
        In force, the oldest first.
    references : ScanReferences
        Of the scans.
    most_alike : callable
    """
    n = len(keys)
    corrected = Corrected(keys.copy(), keys, np.zeros(n, bool), np.zeros(n, bool), dict(names), next_key)
    learned = set(keys.tolist())
    # A concept that was learned later, by another process, may have got the key of one that the user made.
    renumbered: dict[int, int] = {}
    for edit in edits:
        for key in edit.made:
            renumbered.pop(key, None)
            if key in learned:
                renumbered[key] = corrected.next_key
            corrected.next_key = max(corrected.next_key, renumbered.get(key, key) + 1)
        _apply(corrected, _with_keys(edit, renumbered), references, most_alike)
    for (first, second, together), number in corrected.linked_by.items():
        one, other = corrected.keys[[first, second]].tolist()
        if (one == other != NONE) != together:
            corrected.unfit.setdefault(number, "scans that it links were moved since")
    return corrected


def _with_keys(edit: Edit, renumbered: dict[int, int]) -> Edit:
    if not renumbered:
        return edit
    return replace(
        edit,
        keys=tuple(renumbered.get(key, key) for key in edit.keys),
        groups=tuple((renumbered.get(key, key), scans) for key, scans in edit.groups),
        names=tuple((renumbered.get(key, key), name) for key, name in edit.names),
    )


def _apply(corrected: Corrected, edit: Edit, references: ScanReferences, most_alike: MostAlike) -> None:
    found = [(key, references.rows(scans)) for key, scans in edit.groups]
    n_named = sum(len(rows) for _, rows in found)
    groups = [(key, rows[rows >= 0]) for key, rows in found]
    n_missing = n_named - sum(len(rows) for _, rows in groups)
    reasons = []
    if n_missing:
        reasons.append(f"{n_missing} of its {n_named} scans are no longer there")
    if n_named > n_missing:
        followers = _followers(corrected, edit, groups, most_alike)
        for key, rows in [*groups, *followers]:
            corrected.keys[rows] = key
        for _, rows in groups:
            corrected.is_foreign[rows] = edit.kind == "foreign"
            corrected.is_certain[rows] |= edit.kind in _OF_EACH_SCAN
    for key, name in edit.names:
        if corrected.is_concept(key):
            corrected.names[key] = name
        else:
            reasons.append(f"there is no longer a concept with the key {key}, which it calls {name!r}")
    for first, second, together in edit.linked:
        a, b = references.rows([first, second]).tolist()
        if min(a, b) < 0:
            reasons.append("a scan that it links is no longer there")
        else:
            # What is said of two scans again replaces what was.
            kept = {link: by for link, by in corrected.linked_by.items() if {*link[:2]} != {a, b}}
            corrected.linked_by = {**kept, Link(a, b, together): edit.number}
    if reasons:
        corrected.unfit[edit.number] = "; ".join(reasons)


def _followers(
    corrected: Corrected, edit: Edit, groups: list[tuple[int, NDArray[np.int64]]], most_alike: MostAlike
) -> list[tuple[int, NDArray[np.int64]]]:
    """Scans of the concepts that are parted or joined that are not named, with the key that they get."""
    if not edit.keys:
        return []
    is_named = np.zeros(len(corrected.keys), bool)
    for _, rows in groups:
        is_named[rows] = True
    parted = {*edit.keys, *_born_of(corrected.keys, is_named, edit.next_key)}
    others = np.flatnonzero(np.isin(corrected.keys, sorted(parted)) & ~is_named)
    if not len(others):
        return []
    if len(groups) == 1:
        return [(groups[0][0], others)]
    named = np.concatenate([rows for _, rows in groups])
    key_of = np.concatenate([np.full(len(rows), key) for key, rows in groups])
    keys = key_of[most_alike(others, named)]
    return [(int(key), others[keys == key]) for key in np.unique(keys)]


def _born_of(keys: NDArray[np.int64], is_named: NDArray[np.bool_], next_key: int) -> list[int]:
    """Concepts that an update made of those that are named here: they hold some of these scans."""
    born = keys >= next_key
    found, counts = np.unique(keys[born], return_counts=True)
    n_named = [int((is_named & (keys == key)).sum()) for key in found]
    return [int(key) for key, n, of in zip(found, n_named, counts, strict=True) if n >= _OF_THEM * of]
