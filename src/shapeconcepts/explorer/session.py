"""A model that is looked at and corrected: the one lock around it, and what is made of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any

from shapeconcepts.explorer.changes import Changes
from shapeconcepts.explorer.previews import Previews

if TYPE_CHECKING:
    from shapeconcepts.explorer.found_scans import FoundScans
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.segmentation import SegmentedObject
    from shapeconcepts.sources.reader import ReadOptions


class Session:
    """A model, read from its file by `open`, that any number of threads ask.

    Parameters
    ----------
    path : Path
        The model's file.
    scans : sequence of Path
        Where the scans are that it was learned from; without any there are no pictures.
    reading : ReadOptions
        How these are read.
    """

    def __init__(self, path: Path, scans: Sequence[Path], reading: ReadOptions) -> None:
        self.path, self._places, self._reading = path, list(scans), reading
        self.changes, self.lock = Changes(), RLock()
        self.previews = Previews(self.segmented)
        self.is_ready = False
        self._model_json: bytes | None = None
        self._state_json: tuple[int, bytes] | None = None

    def open(self) -> None:
        """Read the model.

        Raises
        ------
        ModelError
            If there is none.
        """
        from shapeconcepts.explorer.found_scans import FoundScans
        from shapeconcepts.model import load_model

        model = load_model(self.path)
        model.consolidate()
        found = FoundScans(model.scan_names_, self._places, self._reading)
        with self.lock:
            self.model: ShapeConceptModel = model
            self._found: FoundScans = found
            self.n_scans = len(model.scan_names_)
            self.is_ready = True
        self.changes.announce()

    def model_json(self) -> bytes:
        """What stays the same until the model's file changes."""
        from shapeconcepts.explorer.model_document import model_document

        with self.lock:
            if self._model_json is None:
                document = model_document(self.model, self.path.name, bool(self._places), self._reading)
                self._model_json = _json(document)
            return self._model_json

    def state_json(self) -> bytes:
        """What edits change."""
        from shapeconcepts.explorer.state_document import state_document

        with self.lock:
            version = self.changes.version
            if self._state_json is None or self._state_json[0] != version:
                self._state_json = version, _json(state_document(self.model, version))
            return self._state_json[1]

    def segmented(self, row: int) -> SegmentedObject:
        """A scan with its segments; a ScanError tells why it cannot be had."""
        return self._found.segmented(row, self.model.segmenter_)

    def scan(self, row: int) -> dict[str, Any]:
        """What there is to say of one scan."""
        from shapeconcepts.explorer.scan_document import scan_document
        from shapeconcepts.scan import ScanError

        reason, segmented = "", None
        try:
            segmented = self.segmented(row)
        except ScanError as error:
            reason = str(error)
        with self.lock:
            return scan_document(self.model, row, segmented, reason, self._found.path_of(row))


def _json(document: object) -> bytes:
    import json

    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii")
