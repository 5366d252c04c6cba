"""What a user can say of a model's concepts: one edit, and the line of a journal that holds it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, NamedTuple

from shapeconcepts.model_file.error import ModelError, require

# What a scan is called: its name, or name and place among the scans of this name where there are several.
ScanReference = str | tuple[str, int]

KINDS = (
    "rename",
    "merge",
    "split",
    "move",
    "foreign",
    "link",
    "confirm",
    "recut",
    "propagate",
    "undo",
    "redo",
)
# In no concept.
NONE = -1


class Link(NamedTuple):
    """Two scans that belong in one concept, or in different ones (must-link, cannot-link).

    Attributes
    ----------
    first, second : int
        Training scans.
    together : bool
    """

    first: int
    second: int
    together: bool


@dataclass(frozen=True)
class Edit:
    """One thing that the user said.

    Attributes
    ----------
    number : int
        Place in the journal, from 1.
    kind : str
        One of `KINDS`.
    text : str
        What it did, as a sentence.
    keys : tuple of int
        Concepts that are parted or joined as wholes: scans that come into them later follow the scans that
        are named here.
    groups : tuple of (int, tuple of ScanReference)
        Concepts, by key, and the scans that belong there; -1 is none.
    made : tuple of int
        Keys of concepts that came to be by this edit.
    next_key : int
        Where concepts are parted or joined as wholes, the first key that no concept had before.
    names : tuple of (int, str)
        Concepts, by key, and what they are called.
    linked : tuple of (ScanReference, ScanReference, bool)
        As `Link`.
    of : int
        The edit that is undone or done again; 0 otherwise.
    granularity : float
        At which the concepts were taken; 0 where they were not.
    is_undone : bool
    unfit : str
        Why it no longer fits the model, in part or as a whole; empty where it does.
    """

    number: int
    kind: str
    text: str
    keys: tuple[int, ...] = ()
    groups: tuple[tuple[int, tuple[ScanReference, ...]], ...] = ()
    made: tuple[int, ...] = ()
    next_key: int = 0
    names: tuple[tuple[int, str], ...] = ()
    linked: tuple[tuple[ScanReference, ScanReference, bool], ...] = ()
    of: int = 0
    granularity: float = 0.0
    is_undone: bool = False
    unfit: str = ""

    def to_line(self) -> str:
        """Line of a journal, without its end."""
        content = {name: getattr(self, name) for name in _STORED if getattr(self, name) not in ((), 0)}
        return json.dumps(content, separators=(",", ":"))

    @classmethod
    def from_line(cls, line: str) -> Edit:
        """Edit of a line.

        Raises
        ------
        ModelError
            If the line holds none.
        """
        try:
            content = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise ModelError(f"is not valid JSON ({error!s:.80})") from None
        is_edit = isinstance(content, dict) and set(content) <= set(_STORED) and set(content) >= _REQUIRED
        require(is_edit, f"holds no edit, got {line!r:.80}")
        edit = cls(**{name: _frozen(value) for name, value in content.items()})
        _check(edit)
        return edit


_STORED = (
    "number",
    "kind",
    "text",
    "keys",
    "groups",
    "made",
    "next_key",
    "names",
    "linked",
    "of",
    "granularity",
)
_REQUIRED = {"number", "kind", "text"}


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def _check(edit: Edit) -> None:
    require(_is_whole(edit.number, 1), f"must have a number from 1, got {edit.number!r:.40}")
    require(edit.kind in KINDS, f"has kind {edit.kind!r:.40}, expected one of {', '.join(KINDS)}")
    require(isinstance(edit.text, str), f"must have a text, got {edit.text!r:.40}")
    require(_is_whole(edit.of, 0), f"must name the edit that is undone, got {edit.of!r:.40}")
    require(_is_whole(edit.next_key, 0), f"must have a key as next_key, got {edit.next_key!r:.40}")
    is_share = type(edit.granularity) in (int, float) and 0 <= edit.granularity <= 1
    require(is_share, f"must have a granularity from 0 to 1, got {edit.granularity!r:.40}")
    for name in ("keys", "made"):
        keys = getattr(edit, name)
        are_keys = isinstance(keys, tuple) and all(_is_whole(key, 0) for key in keys)
        require(are_keys, f"must have keys of concepts as {name}, got {keys!r:.40}")
    are_groups = _are_tuples(edit.groups, 2) and all(
        _is_whole(key, NONE) and isinstance(scans, tuple) and all(map(_is_reference, scans))
        for key, scans in edit.groups
    )
    require(are_groups, f"must have concepts with scans as groups, got {edit.groups!r:.60}")
    are_names = _are_tuples(edit.names, 2) and all(
        _is_whole(key, 0) and isinstance(name, str) for key, name in edit.names
    )
    require(are_names, f"must have concepts with names as names, got {edit.names!r:.60}")
    are_links = _are_tuples(edit.linked, 3) and all(
        _is_reference(first) and _is_reference(second) and isinstance(together, bool)
        for first, second, together in edit.linked
    )
    require(are_links, f"must have pairs of scans as linked, got {edit.linked!r:.60}")


def _are_tuples(values: object, length: int) -> bool:
    return isinstance(values, tuple) and all(isinstance(one, tuple) and len(one) == length for one in values)


def _is_reference(value: object) -> bool:
    if isinstance(value, tuple):
        return len(value) == 2 and isinstance(value[0], str) and _is_whole(value[1], 0)
    return isinstance(value, str)


def _is_whole(value: object, least: int) -> bool:
    # Numbers beyond 32 bits are no keys, and would not fit the arrays that hold them.
    return type(value) is int and least <= value < 2**31
