"""The layout `csv`: a row for each scan."""

from __future__ import annotations

from collections.abc import Sequence

from shapeconcepts.export.table_rows import COLUMNS, Row, csv_content


def table_content(rows: Sequence[Row]) -> bytes:
    """A table of `COLUMNS` as CSV."""
    return csv_content([*COLUMNS], rows)
