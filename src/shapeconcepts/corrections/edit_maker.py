"""From what the user means to the edit that says it of each scan, or why it cannot be."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Concept
from shapeconcepts.concepts.group_tree import GroupTree
from shapeconcepts.concepts.identity import identities_after
from shapeconcepts.corrections.doubt import Likeness, confident
from shapeconcepts.corrections.edit import NONE, Edit, ScanReference
from shapeconcepts.corrections.replay import Corrected, MostAlike
from shapeconcepts.corrections.scan_references import ScanReferences
from shapeconcepts.corrections.tree_split import parts_along_tree

ScanLike = int | str
ConceptLike = int | Concept
Groups = tuple[tuple[int, tuple[ScanReference, ...]], ...]


@dataclass(frozen=True)
class EditMaker:
    """Makes edits of a model as it is.

    Scans are rows or names, concepts their keys or themselves. Each method raises a ValueError that says what
    is wrong: no such concept or scan, or nothing that could be done.

    Attributes
    ----------
    concepts : sequence of Concept
    corrected : Corrected
    references : ScanReferences
    scan_names : sequence of str
    skipped : mapping of int to str
    new_key : int
        The first key that no concept ever had.
    most_alike : callable
        See `replay`.
    """

    concepts: Sequence[Concept]
    corrected: Corrected
    references: ScanReferences
    scan_names: Sequence[str]
    skipped: Mapping[int, str]
    new_key: int
    most_alike: MostAlike

    def rename(self, concept: ConceptLike, name: str) -> Edit:
        """A concept is called something, or nothing any more."""
        one = self._concept(concept)
        _check_name(name)
        return edit_of_name(one, name)

    def merge(self, concepts: Iterable[ConceptLike], name: str) -> Edit:
        """Several concepts are one."""
        found = list({one.key: one for one in map(self._concept, concepts)}.values())
        if len(found) < 2:
            raise ValueError(f"concepts must be at least two, got {len(found)}")
        _check_name(name)
        into = max(found, key=lambda one: one.size)
        name = name or next((one.name for one in found if one.name), "")
        members = np.sort(np.concatenate([one.members for one in found]))
        *first, last = map(_title, found)
        text = f"{', '.join(first)} and {last} are one" + (f", “{name}”" if name else "")
        keys, groups = tuple(one.key for one in found), self._groups({into.key: members})
        names = ((into.key, name),) if name else ()
        return Edit(0, "merge", text, keys, groups, next_key=self.new_key, names=names)

    def split(
        self, concept: ConceptLike, scans: Iterable[ScanLike] | None, tree: Callable[[], GroupTree]
    ) -> Edit:
        """A concept is two: some scans and the others, or what falls apart in the tree."""
        one = self._concept(concept)
        if scans is None:
            kept, chosen = self._parts(one, tree())
            text = f"{_title(one)} was split into {len(kept)} and {_counted(len(chosen))}"
        else:
            chosen = self.rows(scans)
            outside = np.setdiff1d(chosen, one.members)
            if len(outside):
                raise ValueError(f"{self._name(outside[0])} is not in {_title(one)}")
            kept = np.setdiff1d(one.members, chosen)
            if not len(kept):
                raise ValueError("scans must not be all of the concept: nothing would be left of it")
            text = f"{_counted(len(chosen))} of {_title(one)} became a concept of their own"
        groups = self._groups({one.key: kept, self.new_key: chosen})
        made = (self.new_key,)
        return Edit(0, "split", text, (one.key,), groups, made=made, next_key=self.new_key)

    def move(self, scans: Iterable[ScanLike], concept: ConceptLike | None, name: str) -> Edit:
        """Scans belong in a concept, or are a new one."""
        rows = self.rows(scans)
        if concept is None:
            _check_name(name)
            text = f"{self._some(rows)} became a concept" + (f", “{name}”" if name else "")
            names = ((self.new_key, name),) if name else ()
            groups = self._groups({self.new_key: rows})
            return Edit(0, "move", text, groups=groups, made=(self.new_key,), names=names)
        if name:
            raise ValueError(f"name is for a new concept, got {name!r} with a concept that is there")
        one = self._concept(concept)
        text = f"{self._some(rows)} went to {_title(one)}"
        return Edit(0, "move", text, groups=self._groups({one.key: rows}))

    def foreign(self, scans: Iterable[ScanLike]) -> Edit:
        """Scans are none of what this is about."""
        rows = self.rows(scans)
        text = f"{self._some(rows)} {_is_or_are(rows)} foreign"
        return Edit(0, "foreign", text, groups=self._groups({NONE: rows}))

    def confirm(self, scans: Iterable[ScanLike]) -> Edit:
        """Scans are in the right concepts."""
        rows = self.rows(scans)
        keys = self.corrected.keys[rows]
        if (keys == NONE).any():
            raise ValueError(f"{self._name(rows[keys == NONE][0])} is in no concept: say in which it is")
        groups = self._groups({int(key): rows[keys == key] for key in np.unique(keys)})
        return Edit(0, "confirm", f"{self._some(rows)} {_is_or_are(rows)} right", groups=groups)

    def link(self, first: ScanLike, second: ScanLike, together: bool, likeness: Likeness | None) -> Edit:
        """Two scans belong together, or apart; the second one follows."""
        a, b = int(self.rows([first])[0]), int(self.rows([second])[0])
        if a == b:
            raise ValueError("first and second must be two scans, got one")
        key_a, key_b = self.corrected.keys[[a, b]].tolist()
        if together:
            if key_a == NONE:
                raise ValueError(f"{self._name(a)} is in no concept: say in which it is first")
            groups = self._groups({key_a: np.union1d([a], self._linked_with(b))})
        elif key_a == key_b != NONE:
            groups = self._groups({key_a: np.array([a]), self._next_best(b, likeness): np.array([b])})
        else:
            groups = ((key_a, self.references.of([a])), (key_b, self.references.of([b])))
        text = f"{self._name(a)} and {self._name(b)} belong {'together' if together else 'apart'}"
        (reference_a,), (reference_b,) = self.references.of([a]), self.references.of([b])
        return Edit(0, "link", text, groups=groups, linked=((reference_a, reference_b, together),))

    def recut(self, cut: Sequence[Concept], granularity: float) -> Edit:
        """The concepts are those of another cut of the tree."""
        now, keys_before = self.corrected.keys, [concept.key for concept in self.concepts]
        is_foreign, is_certain = self.corrected.is_foreign, self.corrected.is_certain
        group_of = np.full(len(now), -1)
        for number, concept in enumerate(cut):
            group_of[concept.members] = number
        group_of[is_foreign] = -1
        number_of = {key: number for number, key in enumerate(keys_before)}
        before = np.array([number_of.get(key, -1) for key in now.tolist()])
        found = identities_after(before, group_of, keys_before, len(cut), self.new_key)
        keys = np.array([*found.keys, NONE])[group_of]
        # One that was put into another concept than its like goes where the most of that concept go.
        for row in np.flatnonzero(is_certain & (now != NONE)).tolist():
            if _most_frequent(now[group_of == group_of[row]]) != now[row]:
                keys[row] = _most_frequent(keys[(now == now[row]) & ~is_certain], now[row])
        touched = np.union1d(keys[keys != now], now[keys != now]).tolist()
        if not touched:
            raise ValueError(f"the concepts are those at a granularity of {granularity:.3g} already")
        members = {key: np.flatnonzero((keys == key) & ~is_foreign) for key in touched}
        text = f"{_counted(len(np.unique(keys[keys != NONE])), 'concept')}, at granularity {granularity:.3g}"
        return Edit(
            0,
            "recut",
            text,
            tuple(key for key in touched if key in number_of),
            self._groups({key: rows for key, rows in members.items() if len(rows)}),
            made=tuple(key for key in found.keys if key >= self.new_key),
            granularity=float(granularity),
            next_key=self.new_key,
        )

    def propagate(self, rate: float, likeness: Likeness) -> Edit:
        """Scans in no named concept go into those that they can only be in."""
        names, keys = self.corrected.names, self.corrected.keys
        is_named = np.isin(keys, [key for key, name in names.items() if name])
        if not is_named.any():
            raise ValueError("no concept has a name: name some first")
        is_scan = ~np.isin(np.arange(len(keys)), list(self.skipped))
        is_said = self.corrected.is_certain | self.corrected.is_foreign
        undecided = np.flatnonzero(is_scan & ~is_named & ~is_said)
        found = confident(self.corrected, likeness, undecided, rate)
        found = np.where(self._is_kept_apart(undecided, found), NONE, found)
        groups = self._groups({int(key): undecided[found == key] for key in np.unique(found[found != NONE])})
        of_how_many = f"of {_counted(len(undecided))} in no named concept"
        if not groups:
            raise ValueError(f"none {of_how_many} is sure enough to be put into one")
        text = f"{(found != NONE).sum()} {of_how_many} went to {_counted(len(groups), 'concept')}"
        return Edit(0, "propagate", text, groups=groups)

    def rows(self, scans: Iterable[ScanLike]) -> NDArray[np.int64]:
        """Rows of scans, rising, each once."""
        if isinstance(scans, str):
            raise ValueError(f"scans must be several, as a list, got {scans!r}")
        rows = [self._row(scan) for scan in scans]
        if not rows:
            raise ValueError("scans must be at least one, got none")
        return np.unique(np.array(rows, np.int64))

    def _row(self, scan: ScanLike) -> int:
        n = len(self.scan_names)
        row = self.references.named(scan) if isinstance(scan, str) else scan
        if isinstance(row, bool) or not isinstance(row, int | np.integer) or not 0 <= row < n:
            raise ValueError(f"scans must be names, or rows from 0 to {n - 1}, got {scan!r}")
        if int(row) in self.skipped:
            raise ValueError(f"{self._name(row)} could not be used: {self.skipped[int(row)]}")
        return int(row)

    def _concept(self, concept: ConceptLike) -> Concept:
        key = concept.key if isinstance(concept, Concept) else concept
        for one in self.concepts:
            if one.key == key and not isinstance(key, bool):
                return one
        known = ", ".join(str(one.key) for one in self.concepts[:20]) or "(there is none)"
        raise ValueError(f"concept must be one of the keys {known}, got {key!r}")

    def _groups(self, members: Mapping[int, NDArray[np.int64]]) -> Groups:
        return tuple((key, self.references.of(rows)) for key, rows in members.items())

    def _parts(self, concept: Concept, tree: GroupTree) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        parts = parts_along_tree(tree, concept.members)
        if parts is None:
            raise ValueError(f"{_title(concept)} has no parts in the tree: choose the scans to split off")
        named = np.concatenate(parts)
        late = np.setdiff1d(concept.members, named)
        is_first = self.most_alike(late, named) < len(parts[0])
        first, second = np.union1d(parts[0], late[is_first]), np.union1d(parts[1], late[~is_first])
        return (first, second) if len(first) >= len(second) else (second, first)

    def _linked_with(self, row: int) -> NDArray[np.int64]:
        """All scans that are to be together with one, itself included."""
        found, new = {row}, [row]
        pairs = [link[:2] for link in self.corrected.links if link.together]
        while new:
            one = new.pop()
            near = {b if a == one else a for a, b in pairs if one in (a, b)} - found
            found |= near
            new.extend(near)
        return np.array(sorted(found), np.int64)

    def _next_best(self, row: int, likeness: Likeness | None) -> int:
        """The concept of the most alike scan in another one that it may be in; -1 if there is none."""
        keys = self.corrected.keys
        apart = [link for link in self.corrected.links if not link.together and row in link[:2]]
        barred = {int(keys[b if a == row else a]) for a, b, _ in apart} | {int(keys[row]), NONE}
        near = keys[likeness.neighbours[row]].tolist() if likeness else []
        return next((key for key in near if key not in barred), NONE)

    def _is_kept_apart(self, rows: NDArray[np.int64], keys: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether a scan is linked as apart from one in the concept that it would get."""
        then = self.corrected.keys.copy()
        then[rows] = np.where(keys == NONE, then[rows], keys)
        bars = {
            (row, int(then[other]))
            for a, b, together in self.corrected.links
            if not together
            for row, other in ((a, b), (b, a))
        }
        pairs = zip(rows.tolist(), keys.tolist(), strict=True)
        return np.array([pair in bars for pair in pairs], bool)

    def _name(self, row: int | np.integer) -> str:
        return self.scan_names[int(row)] or f"scan {row}"

    def _some(self, rows: NDArray[np.int64]) -> str:
        return self._name(rows[0]) if len(rows) == 1 else _counted(len(rows))


def edit_of_name(concept: Concept, name: str) -> Edit:
    """What says that a concept has a name, or none where it is empty."""
    text = f"{_title(concept)} is called “{name}”" if name else f"{_title(concept)} has no name any more"
    return Edit(0, "rename", text, names=((concept.key, name),))


def _most_frequent(keys: NDArray[np.int64], otherwise: int = NONE) -> int:
    """The smallest of the most frequent keys but none."""
    found, counts = np.unique(keys[keys != NONE], return_counts=True)
    return int(found[counts.argmax()]) if len(found) else otherwise


def _check_name(name: str) -> None:
    if not isinstance(name, str):
        raise ValueError(f"name must be a str, got {name!r}")


def _title(concept: Concept) -> str:
    return f"“{concept.name}”" if concept.name else f"concept {concept.key}"


def _counted(n: int, what: str = "scan") -> str:
    return f"{n} {what}" + ("" if n == 1 else "s")


def _is_or_are(rows: NDArray[np.int64]) -> str:
    return "is" if len(rows) == 1 else "are"
