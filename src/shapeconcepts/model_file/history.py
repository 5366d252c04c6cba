"""The history of a model in its file: what each update changed."""

from __future__ import annotations

from typing import Any

from shapeconcepts.concepts.identity import KINDS, Change
from shapeconcepts.model_file.error import require
from shapeconcepts.model_file.state import Update


def read_history(entries: object, n_scans: int, n_identities: int) -> tuple[Update, ...]:
    """Updates from the description of a file.

    Raises
    ------
    ModelError
        If an entry is none, or names scans or identities that are not there.
    """
    require(isinstance(entries, list), f"history must be a list, got {entries!r:.60}")
    assert isinstance(entries, list)
    return tuple(_update(entry, n_scans, n_identities) for entry in entries)


def _update(entry: Any, n_scans: int, n_identities: int) -> Update:
    is_entry = isinstance(entry, list) and len(entry) == 4
    require(is_entry, f"history must hold updates of four parts, got {entry!r:.60}")
    n_before, n_after, changes, moved = entry
    require(
        _is_number(n_before, n_scans) and _is_number(n_after, n_scans) and n_before <= n_after,
        f"history must tell of rising numbers of scans up to {n_scans}, got {[n_before, n_after]!r:.40}",
    )
    require(
        isinstance(changes, list) and all(_is_change(one, n_scans, n_identities) for one in changes),
        f"history must hold changes of concepts, got {changes!r:.60}",
    )
    require(
        isinstance(moved, list) and all(_is_move(one, n_scans, n_identities) for one in moved),
        f"history must hold scans with identities before and after, got {moved!r:.60}",
    )
    return Update(
        n_before,
        n_after,
        tuple(Change(kind, key, tuple(others), a, b) for kind, key, others, a, b in changes),
        tuple((scan, before, after) for scan, before, after in moved),
    )


def _is_change(one: Any, n_scans: int, n_identities: int) -> bool:
    if not (isinstance(one, list) and len(one) == 5 and one[0] in KINDS and isinstance(one[2], list)):
        return False
    keys = [one[1], *one[2]]
    return all(_is_number(key, n_identities - 1) for key in keys) and all(
        _is_number(size, n_scans) for size in one[3:]
    )


def _is_move(one: Any, n_scans: int, n_identities: int) -> bool:
    return (
        isinstance(one, list)
        and len(one) == 3
        and _is_number(one[0], n_scans - 1)
        and all(key == -1 or _is_number(key, n_identities - 1) for key in one[1:] if type(key) is int)
        and all(type(key) is int for key in one[1:])
    )


def _is_number(value: object, largest: int) -> bool:
    return type(value) is int and 0 <= value <= largest
