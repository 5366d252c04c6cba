"""The layout `parquet`: a row for each scan. Needs the extra `parquet`."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
import pyarrow.parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]

from shapeconcepts.export.table_rows import COLUMNS, Row

_TYPES = {
    str: pyarrow.string(),
    int: pyarrow.int64(),
    float: pyarrow.float64(),
    bool: pyarrow.bool_(),
}


def table_content(rows: Sequence[Row]) -> bytes:
    """A table of `COLUMNS` as Parquet, with null for what is missing."""
    schema = pyarrow.schema([(title, _TYPES[kind]) for title, kind in COLUMNS.items()])
    columns = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in COLUMNS]
    arrays = [pyarrow.array(column, field.type) for column, field in zip(columns, schema, strict=True)]
    content = BytesIO()
    pyarrow.parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=schema), content)
    return content.getvalue()
