"""Writes scans with segments, concepts and responses for the Rerun viewer. Needs the extra `rerun`."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun
import rerun.blueprint

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry
from shapeconcepts.interruption import unfinished, uninterrupted
from shapeconcepts.io.atomic_write import check_replaceable
from shapeconcepts.printable import encodable
from shapeconcepts.report.palette import colours_of

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.scan import Scan

# Of the time that the slider of the viewer is on.
TIMELINE = "scan"
# What so many scans give is on the disk within a second. Where the disk is full, the library waits for ever.
_SCANS_AT_ONCE = 32
_MOST_SECONDS = 20.0


class RerunRecording:
    """Scans one after the other.

    Parameters
    ----------
    stream : rerun.RecordingStream
    model : ShapeConceptModel
    catalogue : Catalogue
    """

    def __init__(self, stream: Any, model: ShapeConceptModel, catalogue: Catalogue) -> None:
        self._stream, self._model, self._catalogue = stream, model, catalogue
        self._titles = [encodable(one.title) for one in catalogue.classes if one.number >= 0]
        self._n_recorded = 0
        stream.log("scan", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def add(self, entry: CatalogueEntry, scan: Scan) -> None:
        """Record a scan, cut into segments, with what the model knows of it.

        Raises
        ------
        ScanError
            If it cannot be segmented.
        """
        segmented = self._model.segment(scan)
        stream = self._stream
        stream.set_time(TIMELINE, sequence=self._n_recorded)
        # Each scan around its middle: the viewer's camera stays where it is.
        middle = segmented.points.mean(axis=0)
        points = rerun.Points3D(
            segmented.points - middle,
            colors=colours_of(segmented.segment_labels),
            radii=segmented.voxel_size / 2,
            class_ids=np.maximum(segmented.segment_labels + 1, 0),
        )
        stream.log("scan/segments", points)
        one = self._catalogue.class_of(entry)
        stream.log("concept", rerun.TextDocument(_said_of(entry, encodable(one.title))))
        stream.log("concept/number", rerun.Scalars([one.number]))
        if entry.p_value is not None:
            stream.log("p-value", rerun.Scalars([entry.p_value]))
        [responses] = self._model.response_.transform(self._model.stimuli_[[entry.row]])
        for title, response in zip(self._titles, responses.tolist(), strict=True):
            if not np.isnan(response):
                stream.log(["responses", title], rerun.Scalars([response]))
        self._n_recorded += 1
        if self._n_recorded % _SCANS_AT_ONCE == 0:
            self.flush()

    def flush(self) -> None:
        """Wait until all that was recorded is on the disk.

        Raises
        ------
        OSError
            If the disk refuses it.
        """
        try:
            self._stream.flush(timeout_sec=_MOST_SECONDS)
        except Exception as error:
            raise OSError(f"the recording cannot be written ({error})") from error


@contextmanager
def rerun_recording(path: Path, model: ShapeConceptModel, catalogue: Catalogue) -> Iterator[RerunRecording]:
    """A recording that is there, whole, at the end, if nothing fails. No viewer is started.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    path = Path(os.path.realpath(path))
    check_replaceable(path)
    temporary = path.parent / f".shapeconcepts-{secrets.token_hex(8)}"
    try:
        with uninterrupted():
            unfinished.add(temporary)
            # Before the library opens it, which would end the process where that is not possible.
            temporary.touch(exist_ok=False)
        stream = rerun.RecordingStream("shapeconcepts", recording_id=secrets.token_hex(16))
        try:
            stream.save(temporary, default_blueprint=_blueprint())
            recording = RerunRecording(stream, model, catalogue)
            yield recording
            recording.flush()
        finally:
            stream.disconnect()
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
        unfinished.discard(temporary)


def _blueprint() -> Any:
    """The scan on the left; its concept, and responses over all scans, on the right."""
    view = rerun.blueprint
    numbers = view.Vertical(
        view.TextDocumentView(origin="/concept", name="Concept"),
        view.TimeSeriesView(origin="/responses", name="Responses: the smaller, the more alike"),
        view.TimeSeriesView(origin="/p-value", name="p-value"),
        row_shares=[1, 3, 2],
    )
    return view.Blueprint(
        view.Horizontal(view.Spatial3DView(origin="/scan", name="Segments"), numbers, column_shares=[3, 2])
    )


def _said_of(entry: CatalogueEntry, title: str) -> str:
    lines = [encodable(entry.name), f"concept: {title}"]
    if entry.response is not None:
        lines.append(f"response: {entry.response:.3g}" + (", its medoid" if entry.is_medoid else ""))
    if entry.p_value is not None:
        lines.append(f"p-value: {entry.p_value:.3g}")
    if entry.label is not None:
        lines.append(f"label: {encodable(entry.label)}")
    return "\n\n".join(lines)
