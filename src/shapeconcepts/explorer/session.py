"""A model that is looked at and corrected, and the one lock around it."""

from __future__ import annotations

import copy
import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event, RLock
from typing import TYPE_CHECKING

from shapeconcepts.explorer.changes import Changes
from shapeconcepts.explorer.file_status import file_status

if TYPE_CHECKING:
    from shapeconcepts.corrections import JournalFile
    from shapeconcepts.explorer.found_scans import FoundScans
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.segmentation import SegmentedObject
    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.reader import ReadOptions

_SECONDS_BETWEEN_LOOKS = 0.5
# Names are found a few at a time, so that neither windows nor files wait for all.
_NAMED_AT_ONCE = 8


class Session:
    """A model, read from its file by `open`, that any number of threads look at and correct.

    Edits are made one after the other. Who looks gets a copy of the model as it was after one of them, and so
    waits for nobody.

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
    model_status, journal_status : str
        Of the files as they were read.
    suggested : dict of int to str
        What concepts may be called, by their medoids.
    is_likeness_known : bool
        Whether it was found out which scans are alike, without which there are no doubts.
    trouble : str
        Why a file that another process wrote cannot be read.
    """

    def __init__(self, path: Path, places: Sequence[Path], reading: ReadOptions) -> None:
        self.path, self.places, self.reading = path, list(places), reading
        self.changes = Changes()
        self.suggested: dict[int, str] = {}
        self.is_likeness_known = False
        self.trouble = ""
        self._journal_path = Path(f"{path.resolve()}.journal")
        self.model_status, self.journal_status = file_status(path), file_status(self._journal_path)
        self._tried_status = self.model_status
        self._lock, self._is_read, self._is_closed = RLock(), Event(), Event()
        self._held = ExitStack()
        self._shown: ShapeConceptModel | None = None

    # What the main thread does.

    def open(self) -> None:
        """Read the model; no other explorer can have it then.

        Raises
        ------
        ModelError
            If there is none, or another explorer has it.
        ScanError
            If there are no scans where they are said to be.
        """
        from shapeconcepts.corrections import JournalFile

        self._journal: JournalFile = JournalFile(self.path)
        # Where nothing can be written, it can still be looked at: each edit says why it cannot be made.
        with suppress(OSError):
            self._held.enter_context(self._journal.held())
        self._take(*self._read(), self._tried_status)

    def wait(self) -> bool:
        """Until it is time to keep up again, True; or False, as the session is closed."""
        return not self._is_closed.wait(_SECONDS_BETWEEN_LOOKS)

    def keep_up(self) -> None:
        """Follow the files, and find out what takes its time."""
        self._follow_files()
        self._find_likeness()
        self._suggest_names()

    def close(self) -> None:
        """Let another explorer have the model."""
        self._is_closed.set()
        self._held.close()

    # What the threads of the server do.

    @property
    def is_read(self) -> bool:
        """Whether the model is read."""
        return self._is_read.is_set()

    @property
    def shown(self) -> ShapeConceptModel:
        """The model after the last edit, as soon as it is read. It does not change."""
        self._is_read.wait()
        assert self._shown is not None
        return self._shown

    def edit(self, say: Callable[[ShapeConceptModel], object]) -> None:
        """Make an edit; it is on the disk when this returns.

        Raises
        ------
        ValueError
            If it cannot be made, or not be written: then nothing has changed.
        """
        self._is_read.wait()
        with self._lock:
            try:
                say(self._model)
                self._model.write_journal(self.path)
            except (OSError, ValueError) as error:
                # What was said and not written was not said.
                self._read_journal()
                raise ValueError(_refusal(error, self._journal.path)) from None
            self.journal_status = file_status(self._journal_path)
            self._show()

    def segmented(self, row: int) -> SegmentedObject:
        """A scan with its segments.

        Raises
        ------
        ScanError
            If it is not there, or cannot be used.
        """
        model = self.shown
        return self._found.segmented(row, model.segmenter_)

    @property
    def files(self) -> list[ScanFile]:
        """Where the scans may be."""
        return self._found.files

    def path_of(self, row: int) -> Path | None:
        """The file that holds a scan, where that is known."""
        self._is_read.wait()
        return self._found.path_of(row)

    # How it works.

    def _follow_files(self) -> None:
        """Take what other processes wrote: a model that learned on, or edits."""
        from shapeconcepts.model_file import ModelError
        from shapeconcepts.scan import ScanError

        try:
            if file_status(self.path) != self._tried_status:
                # One that cannot be read is not tried again until it changes.
                self._tried_status = file_status(self.path)
                self._take(*self._read(), self._tried_status)
            elif file_status(self._journal_path) != self.journal_status:
                with self._lock:
                    self._read_journal()
            else:
                return
            self.trouble = ""
        except (ModelError, ScanError, OSError) as error:
            # What was read before stays.
            self.trouble = str(error)
        self.changes.announce()

    def _find_likeness(self) -> None:
        if self.is_likeness_known:
            return
        # It tells of what was learned: edits that are made meanwhile change nothing in it.
        if self._model.novelty_ is not None:
            self._model.likeness()
        with self._lock:
            self.is_likeness_known = True
            self._show()

    def _suggest_names(self) -> None:
        from shapeconcepts.explorer.suggestions import suggested_name

        medoids = [one.medoid for one in self.shown.concepts_ if one.medoid not in self.suggested]
        if medoids and self.places:
            found = {row: suggested_name(self.segmented, row) for row in medoids[:_NAMED_AT_ONCE]}
            self.suggested = {**self.suggested, **found}
            self.changes.announce()

    def _read(self) -> tuple[ShapeConceptModel, FoundScans]:
        from shapeconcepts.explorer.found_scans import FoundScans
        from shapeconcepts.model import load_model
        from shapeconcepts.parallel import MOST_THREADS

        # One core is left for pictures.
        n_jobs = max(min((os.cpu_count() or 1) - 1, MOST_THREADS), 1)
        model = load_model(self.path).set_params(n_jobs=n_jobs)
        return model, FoundScans(model.scan_names_, self.places, self.reading)

    def _take(self, model: ShapeConceptModel, found: FoundScans, status: str) -> None:
        with self._lock:
            self._model, self._found, self.model_status = model, found, status
            self.suggested, self.is_likeness_known = {}, False
            # Something may have been said since it was read.
            self._read_journal()
            self._is_read.set()

    def _read_journal(self) -> None:
        self.journal_status = file_status(self._journal_path)
        self._model.read_journal(self.path)
        self._show()

    def _show(self) -> None:
        """Let the others see the model as it is: whatever an edit changes in it, it replaces."""
        self._shown = copy.copy(self._model)
        self.changes.announce()


def _refusal(error: OSError | ValueError, place: Path) -> str:
    if isinstance(error, OSError):
        return f"{place}: cannot be written ({error.strerror or error}), so nothing was changed"
    return str(error)
