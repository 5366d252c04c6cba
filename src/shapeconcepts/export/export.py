"""From a model and the scans that it was learned from to a labelled data set."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry, ConceptClass, catalogue_of
from shapeconcepts.export.checks import check_packages, check_places, check_sources
from shapeconcepts.export.layout import Layout, Place
from shapeconcepts.export.table_rows import index_content, row_of
from shapeconcepts.export.training_scans import (
    FoundScan,
    ScansInFiles,
    ScansInMemory,
    TrainingScans,
    UnusableScan,
)
from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.io.whole_folder import FolderInMaking, folder_written_whole
from shapeconcepts.scan import Scan, ScanError, scan_errors
from shapeconcepts.sources.collection import ScanFile, Source, find_scan_files
from shapeconcepts.sources.reader import ReadOptions

if TYPE_CHECKING:
    from shapeconcepts.export.rerun_recording import RerunRecording
    from shapeconcepts.model import ShapeConceptModel

# Where each layout is: of folders the class, of tables what makes their content.
_FOLDERS = {
    "folders": ("folders", "FoldersLayout"),
    "semantic-kitti": ("semantic_kitti", "SemanticKittiLayout"),
    "labelcloud": ("labelcloud", "LabelCloudLayout"),
    "fiftyone": ("fiftyone", "FiftyOneLayout"),
}
_TABLES = {"csv": "csv_table", "parquet": "parquet_table"}
LAYOUTS = ("folders", "csv", "parquet", "semantic-kitti", "labelcloud", "fiftyone")
_INDEX = "index.csv"


@dataclass(frozen=True)
class Export:
    """What was exported.

    Attributes
    ----------
    n_written : int
        Number of scans; in tables, of rows.
    counts : tuple of (ConceptClass, int)
        Classes of the data set, none last, and how many scans of each were written.
    missing : tuple of str
        Names of scans that were not found; tables have them all the same.
    skipped : tuple of (str, str)
        Names of scans that could not be exported, with the reason.
    """

    n_written: int
    counts: tuple[tuple[ConceptClass, int], ...]
    missing: tuple[str, ...]
    skipped: tuple[tuple[str, str], ...]


def export_scans(
    model: ShapeConceptModel,
    out: str | PathLike[str] | None,
    layout: str = "folders",
    *,
    scans: Source | Sequence[Scan] | Sequence[ScanFile] = (),
    force: bool = False,
    rerun: str | PathLike[str] | None = None,
    **options: Unpack[ReadOptions],
) -> Export:
    """Write the scans that a model was learned from, with their concepts, as a labelled data set.

    Scans are found again by their names and read one at a time; those that are not there are left out. What
    is written appears complete or not at all, and is the same to the last bit each time, but for `rerun`.

    Parameters
    ----------
    model : ShapeConceptModel
        Fitted.
    out : path or None
        A folder that is not there yet, or empty; for the layouts "csv" and "parquet" a file. None: only the
        recording is written.
    layout : {"folders", "csv", "parquet", "semantic-kitti", "labelcloud", "fiftyone"}
        See docs/export.md. "parquet" needs the package pyarrow.
    scans : path, iterable of paths, or sequence of Scan or ScanFile
        Where the scans are: what was given to `read_scans`, or what `find_scan_files` found there. Tables do
        without it, and without paths.
    force : bool
        Whether what is at `out` may be replaced, with all that is in it.
    rerun : path, optional
        A recording for the Rerun viewer to write as well: each scan with its segments, concept, p-value and
        responses. Needs the package rerun-sdk.
    **options
        How scans are read: those of `read_scan`, see `iter_scans`.

    Returns
    -------
    Export

    Raises
    ------
    ValueError
        If a parameter is out of range.
    ScanError
        If no scan is found, or none of those found can be exported.
    ModuleNotFoundError
        If a package that is needed is not installed.
    OSError
        If something is at the place already, or the disk refuses what is written.

    Examples
    --------
    >>> import shapeconcepts as sc
    >>> model = sc.load_model("m.safetensors")  # doctest: +SKIP
    >>> sc.export_scans(model, "dataset", scans="scans/").n_written  # doctest: +SKIP
    168
    """
    if layout not in LAYOUTS:
        raise ValueError(f"layout must be one of {', '.join(map(repr, LAYOUTS))}, got {layout!r}")
    if out is None and rerun is None:
        raise ValueError("out must be a path where rerun is None, got None for both")
    check_packages(layout if out is not None else "", rerun is not None)
    place = None if out is None else Path(os.path.realpath(out))
    recording = None if rerun is None else Path(os.path.realpath(rerun))
    check_places(place, recording, layout, layout in _FOLDERS, force)
    catalogue = catalogue_of(model)
    found = _found(model, catalogue, scans, options)
    check_sources(place, found, force)
    places: dict[int, Place] = {}
    skipped = list(catalogue.skipped)
    if recording is not None or (place is not None and layout in _FOLDERS):
        if len(found.missing) == len(catalogue.entries):
            where = "say where they are with scans" if not scans else "they are found by their names"
            raise ScanError(f"none of {len(catalogue.entries)} scans of the model is there: {where}")
        folder = place if layout in _FOLDERS else None
        _write_scans(folder, recording, layout, force, model, catalogue, found, places, skipped)
    is_table = layout in _TABLES and place is not None
    if is_table and place is not None:
        _write_table(place, layout, catalogue, found)
    written = [entry for entry in catalogue.entries if is_table or entry.row in places]
    counts = [sum(entry.concept == one.number for entry in written) for one in catalogue.classes]
    # Who says nothing of where scans are, misses none.
    missing = tuple(model.scan_names_[row] for row in found.missing) if scans else ()
    return Export(len(written), tuple(zip(catalogue.classes, counts, strict=True)), missing, tuple(skipped))


def _found(
    model: ShapeConceptModel,
    catalogue: Catalogue,
    scans: Source | Sequence[Scan] | Sequence[ScanFile],
    options: ReadOptions,
) -> TrainingScans:
    """The scans of a model, wherever they are."""
    names, wanted = model.scan_names_, [entry.row for entry in catalogue.entries]
    given = [scans] if isinstance(scans, str | PathLike) else list(scans)
    in_memory = [one for one in given if isinstance(one, Scan)]
    found = [one for one in given if isinstance(one, ScanFile)]
    paths = [one for one in given if not isinstance(one, Scan | ScanFile)]
    if len(given) > max(len(in_memory), len(found), len(paths)):
        raise ValueError("scans must be paths or Scans, got some of each")
    if in_memory:
        return ScansInMemory(names, wanted, in_memory)
    return ScansInFiles(names, wanted, find_scan_files(paths) if paths else found, options)


def _write_table(place: Path, layout: str, catalogue: Catalogue, found: TrainingScans) -> None:
    rows = [row_of(catalogue, entry, found.path_of(entry.row)) for entry in catalogue.entries]
    content: bytes = import_module(f"shapeconcepts.export.{_TABLES[layout]}").table_content(rows)
    write_atomically(place, content)


def _write_scans(
    place: Path | None,
    recording: Path | None,
    layout: str,
    force: bool,
    model: ShapeConceptModel,
    catalogue: Catalogue,
    found: TrainingScans,
    places: dict[int, Place],
    skipped: list[tuple[str, str]],
) -> None:
    """Write scans one at a time; notes where they are, or why they are nowhere."""
    entry_of = {entry.row: entry for entry in catalogue.entries}
    with _folder(place, force) as folder, _recorder(recording, model, catalogue) as recorder:
        writer = None if folder is None else _layout(layout, folder, catalogue)
        for one in found.read():
            entry = entry_of[one.row]
            if isinstance(one, UnusableScan):
                skipped.append((entry.name, one.reason))
                continue
            try:
                places[entry.row] = _written(entry, one, writer, recorder)
            except ScanError as error:
                skipped.append((entry.name, str(error)))
        if not places:
            raise ScanError(f"no scan can be exported, the first one as: {skipped[0][1]}")
        if writer is not None and folder is not None:
            writer.finish(places)
            folder.write(_INDEX, index_content(catalogue, places, found.path_of))


def _written(
    entry: CatalogueEntry, found: FoundScan, writer: Layout | None, recorder: RerunRecording | None
) -> Place:
    with scan_errors(entry.name, "exported"):
        try:
            if recorder is not None:
                recorder.add(entry, found.scan)
            return writer.add(entry, found) if writer is not None else Place("")
        except OSError as error:
            refusal = error
    # By the disk, which is no fault of the scan: it ends the export.
    raise refusal


@contextmanager
def _folder(place: Path | None, force: bool) -> Iterator[FolderInMaking | None]:
    with nullcontext() if place is None else folder_written_whole(place, replace=force) as folder:
        yield folder


@contextmanager
def _recorder(
    path: Path | None, model: ShapeConceptModel, catalogue: Catalogue
) -> Iterator[RerunRecording | None]:
    if path is None:
        yield None
        return
    # Who exports without a recording needs no rerun-sdk.
    from shapeconcepts.export.rerun_recording import rerun_recording

    with rerun_recording(path, model, catalogue) as recorder:
        yield recorder


def _layout(name: str, folder: FolderInMaking, catalogue: Catalogue) -> Layout:
    module, kind = _FOLDERS[name]
    made: Callable[[FolderInMaking, Catalogue], Layout]
    made = getattr(import_module(f"shapeconcepts.export.{module}"), kind)
    return made(folder, catalogue)
