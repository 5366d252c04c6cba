"""Reads tables of numbers as text: XYZ, TXT, CSV, PTS and ASC."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import (
    LABEL_NAMES,
    VIEWPOINT_NAMES,
    Cloud,
    decoded_lines,
    is_number,
    labels_or_notice,
    number_table,
    value_or_notice,
)
from shapeconcepts.io.viewpoint import common_position, unless_default, viewpoint_in_comments
from shapeconcepts.scan import ScanError

COMMENTS = ("#", "//", "%")
# So many lines that number the points are no chance.
_FEWEST_COUNTED = 10
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eE][-+]?\d+)?")
_QUOTED = re.compile(r'"[-+.\d][^"]*"').search
# Rows in which a decimal comma is looked for.
_LOOKED_AT = 100


class _Table(NamedTuple):
    """Lines of points, what stands above them, and how many of them that promises."""

    rows: list[str]
    comments: list[str]
    titles: list[str]
    promised: int | None


class _Columns(NamedTuple):
    """Names of columns; where the last one may stand for several, or none, rows differ in length."""

    names: list[str]
    is_open: bool


def read_text_table(data: bytes) -> Cloud:
    """Cloud from a text file with one point a line; ScanError says what is wrong with it.

    Columns are separated by blanks, commas or semicolons; between blanks and semicolons, a comma is a decimal
    point. Before the first point may stand comments (``#``, ``//``, ``%``), lines without any number, such as
    a title and the names of the columns, and one line with the number of points. Where x, y and z are among
    the names, these columns count, and `label`; otherwise x, y and z are the first three columns. A comment
    may tell the sensor's position: ``# viewpoint 0.1 0 0.5``.
    """
    lines = [line.strip() for line in decoded_lines(data) if line.strip()]
    # Some spreadsheets quote numbers, too.
    table = _table([line.replace('"', "") for line in lines] if any(map(_QUOTED, lines[-1:])) else lines)
    rows, delimiter = _separated(table.rows)
    n_columns = len(rows[0].split(delimiter))
    if n_columns < 3:
        raise ScanError(f"has {n_columns} columns, x, y and z are expected")
    names, is_open = _columns([*table.comments, *table.titles], n_columns)
    if table.titles and not names:
        _refuse_other_names(table.titles[-1], delimiter, n_columns)
    points = number_table(rows, [names.index(axis) for axis in "xyz"] if names else [0, 1, 2], delimiter)
    if not names:
        _refuse_counted(points[:, 0])
    if not is_open and len(rows[-1].split(delimiter)) != n_columns:
        raise ScanError(f"is truncated: the first point has {n_columns} columns, the last one another number")
    label = next((names.index(name) for name in LABEL_NAMES if name in names), None)
    labels, of_labels = labels_or_notice(
        lambda: None if label is None else number_table(rows, [label], delimiter).ravel()
    )

    def declared() -> NDArray[np.float64] | None:
        position = viewpoint_in_comments(table.comments)
        if position is None and set(VIEWPOINT_NAMES) <= set(names):
            columns = number_table(rows, [names.index(name) for name in VIEWPOINT_NAMES], delimiter)
            position = unless_default(common_position(columns.T))
        return position

    viewpoint, of_viewpoint = value_or_notice("a viewpoint", declared)
    return Cloud(np.ascontiguousarray(points), viewpoint, labels, of_viewpoint + of_labels)


def _table(lines: list[str]) -> _Table:
    comments: list[str] = []
    titles: list[str] = []
    promised = None
    first = 0
    while first < len(lines):
        line = lines[first]
        words = re.split(r"[\s,;]+", line)
        if line.startswith(COMMENTS):
            comments.append(line.lstrip("#/% "))
        elif not any(is_number(word) for word in words):
            titles.append(line)
        elif promised is None and len(words) == 1 and words[0].isdecimal():
            promised = int(words[0][:18])
        else:
            break
        first += 1
    rows = [line for line in lines[first:] if not line.startswith(COMMENTS)]
    if not rows:
        first_line = f" (its first line is {titles[0]!r:.60})" if titles else ""
        raise ScanError(f"holds no points{first_line}")
    if promised is not None and promised > len(rows):
        raise ScanError(f"is truncated: it promises {promised} points, it has {len(rows)} lines of them")
    return _Table(rows, comments, titles, promised)


def _separated(rows: list[str]) -> tuple[list[str], str | None]:
    """Rows with points for decimal commas, and what stands between columns; None for blanks."""
    first = rows[:_LOOKED_AT]
    if any(";" in row for row in first):
        rows = [row.replace(",", ".") for row in rows] if any("," in row for row in first) else rows
        delimiter = ";"
    elif any(_has_decimal_commas(row) for row in first):
        return [row.replace(",", ".") for row in rows], None
    elif "," in rows[0]:
        delimiter = ","
    else:
        return rows, None
    # Some programs end each row as they end each number.
    return [row.rstrip(f"{delimiter} ") for row in rows] if rows[0].endswith(delimiter) else rows, delimiter


def _has_decimal_commas(row: str) -> bool:
    words = row.split()
    return len(words) >= 3 and any(map(_DECIMAL_COMMA.fullmatch, words))


def _columns(header: list[str], n_columns: int) -> _Columns:
    """Names of the columns in lower case, from the last line that can be such; none where there is none."""
    for line in reversed(header):
        names = [name.strip("\"'") for name in re.split(r"[\s,;]+", line.lower().strip())]
        # COLMAP's points have a list of any length last: "X, Y, Z, ..., TRACK[] as (IMAGE_ID, POINT2D_IDX)".
        ends = [place for place, name in enumerate(names) if name.endswith("[]")]
        names = names[: ends[0]] if ends else names
        fits = len(names) <= n_columns if ends else len(names) == n_columns
        if fits and set("xyz") <= set(names):
            return _Columns(names, bool(ends))
    return _Columns([], False)


def _refuse_counted(column: np.ndarray) -> None:
    """Raise ScanError where the first column numbers the points, and x is another one."""
    if len(column) >= _FEWEST_COUNTED and (np.diff(column) == 1.0).all() and column[0] % 1 == 0:
        raise ScanError(
            f"its first column counts {column[0]:.0f}, {column[1]:.0f}, {column[2]:.0f} and so on: "
            "a line with the names of the columns must say where x, y and z are"
        )


def _refuse_other_names(title: str, delimiter: str | None, n_columns: int) -> None:
    """Raise ScanError where a line names all columns, none of them x, y or z; another title says nothing."""
    names = [name.strip().strip("\"'") for name in title.split(delimiter)]
    # "X [m]", "y(mm)", "z_coord" are what they seem.
    if [name[:1].lower() for name in names[:3]] == ["x", "y", "z"]:
        return
    if len(set(names)) == len(names) == n_columns and all(name[:1].isalpha() for name in names):
        raise ScanError(f"has no columns x, y and z, only {', '.join(names[:10])}")
