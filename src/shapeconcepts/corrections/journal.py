"""All that was said of a model's concepts, in order: what counts, what was undone, what can be done again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from shapeconcepts.corrections.edit import Edit
from shapeconcepts.model_file.error import require


@dataclass(frozen=True)
class Journal:
    """Edits, each undo and redo included; nothing is ever taken out.

    Attributes
    ----------
    identity : str
        By which a journal and what it goes on from are known; empty as long as nothing was said.
    lines : tuple of Edit
        By rising number.
    """

    identity: str = ""
    lines: tuple[Edit, ...] = ()

    def __post_init__(self) -> None:
        numbers = [edit.number for edit in self.lines]
        require(numbers == list(range(1, len(numbers) + 1)), "has edits that are not numbered from 1 on")
        self._done_and_undone()

    def with_edit(self, edit: Edit, identity: str) -> Journal:
        """This journal and one edit more, which gets its number; `identity` where it has none yet."""
        numbered = replace(edit, number=len(self.lines) + 1)
        return Journal(self.identity or identity, (*self.lines, numbered))

    @property
    def edits(self) -> tuple[Edit, ...]:
        """All but undo and redo, each with whether it is undone."""
        done = set(self._done_and_undone()[0])
        return tuple(
            replace(edit, is_undone=edit.number not in done)
            for edit in self.lines
            if edit.kind not in ("undo", "redo")
        )

    @property
    def in_force(self) -> tuple[Edit, ...]:
        """Edits that are not undone, the oldest first."""
        return tuple(self.lines[number - 1] for number in self._done_and_undone()[0])

    @property
    def last_done(self) -> Edit | None:
        """What `undo` would undo."""
        done, _ = self._done_and_undone()
        return self.lines[done[-1] - 1] if done else None

    @property
    def last_undone(self) -> Edit | None:
        """What `redo` would do again: what was undone since the last new edit, the latest first."""
        _, undone = self._done_and_undone()
        return self.lines[undone[-1] - 1] if undone else None

    @property
    def next_key(self) -> int:
        """The smallest key that is larger than all that were given here."""
        return max((key for edit in self.lines for key in edit.made), default=-1) + 1

    def goes_on_from(self, other: Journal) -> bool:
        """Whether this journal is the other one, or it and more."""
        n = len(other.lines)
        return not n or (self.identity == other.identity and self.lines[:n] == other.lines)

    def _done_and_undone(self) -> tuple[list[int], list[int]]:
        done: list[int] = []
        undone: list[int] = []
        for edit in self.lines:
            if edit.kind == "undo":
                require(done[-1:] == [edit.of], f"undoes edit {edit.of}, which is not the last one")
                undone.append(done.pop())
            elif edit.kind == "redo":
                require(undone[-1:] == [edit.of], f"does edit {edit.of} again, which is not the last undone")
                done.append(undone.pop())
            else:
                done.append(edit.number)
                undone.clear()
        return done, undone


def journal_of(identity: str, edits: Iterable[Edit]) -> Journal:
    """A journal of edits that have their numbers.

    Raises
    ------
    ModelError
        If they are not in order, or one undoes what is not there.
    """
    return Journal(identity, tuple(edits))
