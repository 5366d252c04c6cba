"""What is written beside the model's file: the corrected data set, and the report of the corrected model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from shapeconcepts.export import LAYOUTS, export_scans
from shapeconcepts.parallel import MOST_THREADS, map_in_order
from shapeconcepts.report.html import ScanPreview, preview, write_report
from shapeconcepts.scan import ScanError, scan_errors

if TYPE_CHECKING:
    from shapeconcepts.explorer.session import Session

_TABLES = ("csv", "parquet")


def write_export(session: Session, layout: object, name: object) -> dict[str, Any]:
    """Export the scans in a layout, into what is not there yet.

    Raises
    ------
    ValueError
        If that cannot be done: what is wrong.
    """
    if layout not in LAYOUTS:
        raise ValueError(f"layout must be one of {', '.join(LAYOUTS)}")
    place = _free_place(session.path, name, f".{layout}" if layout in _TABLES else "")
    try:
        exported = export_scans(session.shown, place, str(layout), scans=session.files, **session.reading)
    except (ScanError, ModuleNotFoundError) as error:
        raise ValueError(str(error)) from None
    except OSError as error:
        raise ValueError(f"{place}: {error.strerror or error}") from None
    skipped = [reason for _, reason in exported.skipped]
    return _told(place, exported.n_written, list(exported.missing), skipped)


def write_report_of(session: Session, name: object) -> dict[str, Any]:
    """Write the report, with a picture of each scan that is there, into a file that is not there yet.

    Raises
    ------
    ValueError
        If that cannot be done: what is wrong.
    """
    place, model = _free_place(session.path, name, ".html"), session.shown
    rows = range(len(model.scan_names_)) if session.places else ()
    found = list(map_in_order(lambda row: _preview(session, row), rows, MOST_THREADS, share_memory=True))
    previews: list[ScanPreview | None] = [None] * len(model.scan_names_)
    missing: list[str] = []
    for row, one in enumerate(found):
        if isinstance(one, ScanPreview):
            previews[row] = one
        elif row not in model.skipped_:
            missing.append(one)
    try:
        write_report(place, model, previews)
    except OSError as error:
        raise ValueError(f"{place}: {error.strerror or error}") from None
    return _told(place, len(found) - len(missing), missing, [])


def _preview(session: Session, row: int) -> ScanPreview | str:
    """The picture of a scan, or why there is none."""
    try:
        with scan_errors(f"scan {row}", "drawn"):
            return preview(session.segmented(row))
    except ScanError as error:
        return str(error)


def _free_place(model: Path, name: object, ending: str) -> Path:
    """Where something new of this name is beside the model's file."""
    if (
        not isinstance(name, str)
        or not name
        or name.startswith(".")
        or len(name.encode("utf-8", "replace")) > 200
    ):
        raise ValueError("name must be that of a new file or folder, and not begin with a dot")
    if not name.isprintable() or any(one in name for one in '/\\:*?"<>|'):
        raise ValueError('name must have neither control characters nor any of / \\ : * ? " < > |')
    place = model.parent / (name if name.endswith(ending) else name + ending)
    if place.exists() or place.is_symlink():
        raise ValueError(f"{place} is there already: nothing is replaced")
    return place


def _told(place: Path, n_written: int, missing: list[str], skipped: list[str]) -> dict[str, Any]:
    return {
        "path": str(place),
        "written": n_written,
        "missing": missing,
        "skipped": skipped,
    }
