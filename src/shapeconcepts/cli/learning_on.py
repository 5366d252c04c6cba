"""What an update changed, and what of the user's edits still fits, in words; and scans that are known."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from shapeconcepts.cli.terminal import say

if TYPE_CHECKING:
    from shapeconcepts.concepts.identity import Change
    from shapeconcepts.descriptors import DescribedObject
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.model_file.state import Update

_MOVES_SHOWN = 5


def say_update(model: ShapeConceptModel, update: Update) -> None:
    """Say which concepts an update changed, and which scans are in another one now."""
    say(f"{update.n_after - update.n_before:,} scans joined {update.n_before:,}:")
    title_of = {concept.key: concept_key_title(concept.name, concept.key) for concept in model.concepts_}
    for change in update.changes:
        say(f"  {_in_words(change, title_of)}")
    joined = [move for move in update.moved if move[0] < update.n_before]
    for scan, before, after in joined[:_MOVES_SHOWN]:
        source, target = (title_of.get(key, f"key {key}") if key >= 0 else "none" for key in (before, after))
        say(f"  {model.scan_names_[scan] or f'scan {scan}'}: from {source} to {target}")
    if len(joined) > _MOVES_SHOWN:
        say(f"  {len(joined) - _MOVES_SHOWN:,} more of the scans known before are in another concept")


def corrected_before(path: Path) -> ShapeConceptModel | None:
    """The model that a new one is to replace, if somebody corrected it."""
    from shapeconcepts.corrections import JournalFile
    from shapeconcepts.model_file import ModelError

    file = JournalFile(path)
    if not path.exists() or not file.path.exists():
        return None
    from shapeconcepts.model import load_model

    try:
        file.read()
    except ModelError as error:
        say(f"Note: {error}; it is {file.set_aside()} now")
        return None
    try:
        return load_model(path)
    except ModelError as error:
        say(f"Note: the edits beside {path} cannot be kept, as the model that they are of {error}")
        return None


def keep_corrections(model: ShapeConceptModel, earlier: ShapeConceptModel) -> None:
    """Let a new model have the identities and edits of the one that it replaces."""
    with contextlib.suppress(ValueError):
        # Without a scan in common, saving sets the edits aside, and says so.
        model.take_identities(earlier)


def say_edits(model: ShapeConceptModel) -> None:
    """Say how many edits are in force, and which of them no longer fit."""
    edits = [edit for edit in model.journal if not edit.is_undone]
    unfit = [edit for edit in edits if edit.unfit]
    if edits:
        say(
            f"{len(edits):,} edits are in force"
            + (f", of which {len(unfit):,} no longer fit:" if unfit else "")
        )
    for edit in unfit:
        say(f"  {edit.number}. {edit.text}: {edit.unfit}")


def concept_key_title(name: str, key: int) -> str:
    """What a concept is called where its number says nothing, as it changes."""
    return f"{name} (key {key})" if name else f"concept with key {key}"


def _in_words(change: Change, title_of: dict[int, str]) -> str:
    title = title_of.get(change.key, f"concept with key {change.key}")
    others = ", ".join(title_of.get(key, f"key {key}") for key in change.others)
    return {
        "born": f"{title} is born, of {change.n_after:,} scans",
        "grown": f"{title}: {change.n_before:,} scans, now {change.n_after:,}",
        "split": f"{title}: {change.n_before:,} scans, now {change.n_after:,}; split off: {others}",
        "merged": f"{title}, of {change.n_before:,} scans, is a part of {others} now",
        "dissolved": f"{title}, of {change.n_before:,} scans, is no more",
    }[change.kind]


# Row of each scan in the model, by its name and what it looks like as a whole; -1 for one that comes now.
Known = dict[tuple[str, bytes], int]


def known_scans(model: ShapeConceptModel) -> Known:
    """What a model knows."""
    wholes = model.ensemble_.hierarchies_.object_histograms
    rows = [row for row in range(len(model.scan_names_)) if row not in model.skipped_]
    return {(model.scan_names_[row], whole.tobytes()): row for row, whole in zip(rows, wholes, strict=True)}


def known_as(described: DescribedObject) -> tuple[str, bytes]:
    """By what a model knows an object."""
    return described.name, described.description.whole().astype("float16").tobytes()


def is_new(described: DescribedObject, known: Known) -> bool:
    """Whether an object is not known; from now on it is."""
    key = known_as(described)
    if key in known:
        return False
    known[key] = -1
    return True
