"""Scans of a data set as the rows of a table."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry
from shapeconcepts.export.layout import Place
from shapeconcepts.printable import encodable

# Each column with the type of its values, of which some are missing.
COLUMNS: dict[str, type] = {
    "name": str,
    "path": str,
    "concept": int,
    "key": int,
    "concept_name": str,
    "class": str,
    "label": str,
    "response": float,
    "p_value": float,
    "is_medoid": bool,
    "rank": int,
}
PLACE_COLUMNS: dict[str, type] = {"file": str, "origin_x": float, "origin_y": float, "origin_z": float}

Row = list[Any]


def row_of(catalogue: Catalogue, entry: CatalogueEntry, path: Path | None) -> Row:
    """Values of `COLUMNS`; text as UTF-8 can hold it, None for what is missing."""
    one = catalogue.class_of(entry)
    return [
        encodable(entry.name),
        None if path is None else encodable(str(path)),
        one.number,
        one.key,
        encodable(one.name) or None,
        encodable(one.title),
        None if entry.label is None else encodable(entry.label),
        entry.response,
        entry.p_value,
        entry.is_medoid,
        entry.rank,
    ]


def index_content(
    catalogue: Catalogue, places: dict[int, Place], path_of: Callable[[int], Path | None]
) -> bytes:
    """A table of the scans that were written as CSV, with their places in front."""
    rows = []
    for entry in catalogue.entries:
        if entry.row in places:
            place = places[entry.row]
            rows.append([place.file, *place.origin, *row_of(catalogue, entry, path_of(entry.row))])
    return csv_content([*PLACE_COLUMNS, *COLUMNS], rows)


def csv_content(titles: Sequence[str], rows: Sequence[Row]) -> bytes:
    """A table as CSV, in UTF-8; nothing where a value is missing."""
    stream = StringIO()
    # What is quoted are the characters of this end of a line; ours is the newline alone.
    writer = csv.writer(stream, lineterminator="\r\n")
    lines = []
    for cells in (titles, *rows):
        stream.seek(0)
        stream.truncate()
        writer.writerow([_cell(cell) for cell in cells])
        lines.append(stream.getvalue().removesuffix("\r\n") + "\n")
    return "".join(lines).encode("utf-8")


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
