"""A model that is looked at and corrected: the one lock around it, and what is kept of it."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event, RLock
from typing import TYPE_CHECKING, Any

from shapeconcepts.explorer.changes import Changes
from shapeconcepts.explorer.previews import Previews

if TYPE_CHECKING:
    from shapeconcepts.corrections import JournalFile
    from shapeconcepts.explorer.found_scans import FoundScans
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.segmentation import SegmentedObject
    from shapeconcepts.sources.reader import ReadOptions

_SECONDS_BETWEEN_LOOKS = 0.5
_NAMED_AT_ONCE = 8
_Status = tuple[int, int, int] | None


class Session:
    """A model, read from its file by `open`, that any number of threads ask and correct.

    Edits are made one after the other, and what is asked is answered by a copy of the model as it was after
    one of them: nobody waits for anybody who only looks.

    Parameters
    ----------
    path : Path
        The model's file.
    places : sequence of Path
        Where the scans are that it was learned from; without any there are no pictures.
    reading : ReadOptions
        How these are read.

    Attributes
    ----------
    changes : Changes
        Announced after each edit, and whenever there is more to tell.
    previews : Previews
    is_ready : bool
        Whether the model is read.
    """

    def __init__(self, path: Path, places: Sequence[Path], reading: ReadOptions) -> None:
        self.path, self.places, self.reading = path, list(places), reading
        self.changes, self.previews = Changes(), Previews(self.segmented)
        self.is_ready = False
        self._lock, self._closing = RLock(), Event()
        self._told: dict[str, tuple[int, bytes]] = {}
        self._held = ExitStack()
        self._suggested: dict[int, str] = {}
        self._trouble = ""
        self._model_version = 0
        self._is_likeness_known = False

    # What the main thread does.

    def open(self) -> None:
        """Read the model; no other explorer can have it then.

        Raises
        ------
        ModelError
            If there is none, or another explorer has it.
        """
        from shapeconcepts.corrections import JournalFile

        self._journal: JournalFile = JournalFile(self.path)
        # Where nothing can be written, it can still be looked at: each edit says why it cannot be made.
        with suppress(OSError):
            self._held.enter_context(self._journal.held())
        self._model_status = _status(self.path)
        self._take(*self._read())

    def keep_up(self) -> None:
        """Follow the files, and find out what takes its time, until the session is closed."""
        while not self._closing.wait(_SECONDS_BETWEEN_LOOKS):
            self.follow_files()
            self.think()

    def follow_files(self) -> None:
        """Take what other processes wrote: a model that learned on, or edits."""
        from shapeconcepts.model_file import ModelError

        try:
            if (status := _status(self.path)) != self._model_status:
                # One that cannot be read is not tried again until it changes.
                self._model_status = status
                self._take(*self._read())
            elif _status(self._journal.path) != self._journal_status:
                with self._lock:
                    self._read_journal()
            else:
                return
            self._trouble = ""
        except (ModelError, OSError) as error:
            # What was read before stays.
            self._trouble = str(error)
        self.changes.announce()

    def think(self) -> None:
        """Find out what is alike, and what concepts may be called, if there is something new."""
        from shapeconcepts.explorer.suggestions import suggested_name

        if not self._is_likeness_known:
            # It tells of what was learned: edits that are made meanwhile change nothing in it.
            if self._model.novelty_ is not None:
                self._model.likeness()
            self._is_likeness_known = True
            with self._lock:
                self._show()
        medoids = [
            concept.medoid for concept in self.shown.concepts_ if concept.medoid not in self._suggested
        ]
        if medoids and self.places:
            # A few at a time, so that neither windows nor files wait for all.
            found = {row: suggested_name(self.segmented, row) for row in medoids[:_NAMED_AT_ONCE]}
            self._suggested = {**self._suggested, **found}
            self.changes.announce()

    def close(self) -> None:
        """Let another explorer have the model."""
        self._closing.set()
        self.previews.close()
        self._held.close()

    # What the threads of the server do.

    @property
    def shown(self) -> ShapeConceptModel:
        """The model after the last edit. It does not change."""
        return self._shown

    def edit(self, say: Callable[[ShapeConceptModel], object]) -> bytes:
        """Make an edit; the state after it, once it is on the disk.

        Raises
        ------
        ValueError
            If it cannot be made, or not be written: then nothing has changed.
        """
        with self._lock:
            try:
                say(self._model)
                self._model.write_journal(self.path)
            except (OSError, ValueError) as error:
                self._read_journal()
                reason = error.strerror if isinstance(error, OSError) else None
                raise ValueError(
                    f"{self._journal.path}: cannot be written ({reason})" if reason else str(error)
                ) from None
            self._journal_status = _status(self._journal.path)
            self._show()
            return self.state_json()

    def model_json(self) -> bytes:
        """What stays the same until the model's file changes."""
        from shapeconcepts.explorer.model_document import model_document

        def document() -> dict[str, Any]:
            about = model_document(self.shown, self.path.name, bool(self.places), self.reading)
            return {**about, "modelVersion": self._model_version}

        return self._kept("model", self._model_version, document)

    def state_json(self) -> bytes:
        """What edits change."""
        from shapeconcepts.explorer.state_document import state_document

        # What comes while it is made makes a version of its own.
        version = self.changes.version

        def document() -> dict[str, Any]:
            state = state_document(self.shown, self._suggested, self._is_likeness_known)
            return {
                "version": version,
                "modelVersion": self._model_version,
                "trouble": self._trouble,
                **state,
            }

        return self._kept("state", version, document)

    def figures_json(self) -> bytes:
        """What the figures of a report show."""
        from shapeconcepts.report.html.contents import report_contents

        version, model = self.changes.version, self.shown
        previews = [None] * len(model.scan_names_)
        return self._kept(
            "figures", version, lambda: report_contents(model, previews, (), self.path.name, {})
        )

    def segmented(self, row: int) -> SegmentedObject:
        """A scan with its segments.

        Raises
        ------
        ScanError
            If it is not there, or cannot be used.
        """
        return self._found.segmented(row, self.shown.segmenter_)

    def scan(self, row: int) -> dict[str, Any]:
        """What there is to say of one scan."""
        from shapeconcepts.explorer.scan_document import scan_document
        from shapeconcepts.scan import ScanError

        reason, segmented = "", None
        try:
            segmented = self.segmented(row)
        except ScanError as error:
            reason = str(error)
        return scan_document(self.shown, row, segmented, reason, self._found.path_of(row))

    # How it works.

    def _read(self) -> tuple[ShapeConceptModel, FoundScans]:
        from shapeconcepts.explorer.found_scans import FoundScans
        from shapeconcepts.model import load_model

        model = load_model(self.path)
        model.consolidate()
        return model, FoundScans(model.scan_names_, self.places, self.reading)

    def _take(self, model: ShapeConceptModel, found: FoundScans) -> None:
        with self._lock:
            self._model, self._found = model, found
            self._suggested, self._is_likeness_known = {}, False
            self.previews.forget()
            self._model_version += 1
            # Something may have been said since it was read.
            self._read_journal()
            self.is_ready = True

    def _read_journal(self) -> None:
        self._journal_status = _status(self._journal.path)
        self._model._read_journal(self.path)
        self._show()

    def _show(self) -> None:
        """Let the others see the model as it is: whatever an edit changes in it, it replaces."""
        self._shown = copy.copy(self._model)
        self.changes.announce()

    def _kept(self, name: str, version: int, document: Callable[[], Mapping[str, Any]]) -> bytes:
        """A document of a version, made once."""
        kept_version, content = self._told.get(name, (-1, b""))
        if kept_version != version:
            content = json.dumps(document(), allow_nan=False, separators=(",", ":")).encode("ascii")
            self._told[name] = version, content
        return content


def _status(path: Path) -> _Status:
    """What tells that a file was replaced or written, None where there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino
