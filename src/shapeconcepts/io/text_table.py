"""Reads tables of numbers as text: XYZ, TXT and CSV."""

from __future__ import annotations

import re

import numpy as np

from shapeconcepts.io.cloud import LABEL_NAMES, Cloud, decoded_lines, number_table
from shapeconcepts.io.viewpoint import camera_frame_viewpoint
from shapeconcepts.scan import ScanError, whole_numbers

COMMENTS = ("#", "//", "%")


def read_text_table(data: bytes) -> Cloud:
    """Cloud from a text file with one point a line; ScanError says what is wrong with it.

    Columns are separated by blanks, commas or semicolons. Before the first point may stand comments (``#``,
    ``//``, ``%``), one line of column names, and one line with the number of points. Where x, y and z are
    among the names, these columns count, and `label`; otherwise x, y and z are the first three columns.
    """
    lines = [line.strip() for line in decoded_lines(data) if line.strip()]
    header: list[str] = []
    promised = None
    has_names = False
    title = ""
    first = 0
    while first < len(lines):
        line = lines[first]
        if line.startswith(COMMENTS):
            header.append(line.lstrip("#/% "))
            first += 1
            continue
        words = re.split(r"[\s,;]+", line)
        if not has_names and not any(_is_number(word) for word in words):
            header.append(line)
            has_names = True
            title = line
        elif promised is None and len(words) == 1 and words[0].isdecimal():
            promised = int(words[0][:18])
        else:
            break
        first += 1
    rows = [line for line in lines[first:] if not line.startswith(COMMENTS)]
    if not rows:
        raise ScanError("holds no points")
    if promised is not None and promised > len(rows):
        raise ScanError(f"is truncated: it promises {promised} points, it has {len(rows)} lines of them")

    delimiter = next((mark for mark in (";", ",") if mark in rows[0]), None)
    n_columns = len(rows[0].split(delimiter))
    if n_columns < 3:
        raise ScanError(f"has {n_columns} columns, x, y and z are expected")
    names = _column_names(header, n_columns)
    if has_names and not names:
        _refuse_other_names(title, delimiter, n_columns)
    columns = [names.index(axis) for axis in "xyz"] if names else [0, 1, 2]
    label = next((names.index(name) for name in LABEL_NAMES if name in names), None)
    table = number_table(rows, columns if label is None else [*columns, label], delimiter)
    if len(rows[-1].split(delimiter)) != n_columns:
        raise ScanError(f"is truncated: the first point has {n_columns} columns, the last one another number")
    points = np.ascontiguousarray(table[:, :3])
    return Cloud(
        points, camera_frame_viewpoint(points), None if label is None else whole_numbers(table[:, 3])
    )


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _column_names(header: list[str], n_columns: int) -> list[str]:
    """Names of the columns in lower case, from the last line that can be such; empty where there is none."""
    for line in reversed(header):
        names = [name.strip("\"'") for name in re.split(r"[\s,;]+", line.lower().strip())]
        if len(names) == n_columns and set("xyz") <= set(names):
            return names
    return []


def _refuse_other_names(title: str, delimiter: str | None, n_columns: int) -> None:
    """Raise ScanError where a line names all columns, none of them x, y or z; another title says nothing."""
    names = [name.strip().strip("\"'") for name in title.split(delimiter)]
    # "X [m]", "y(mm)", "z_coord" are what they seem.
    if [name[:1].lower() for name in names[:3]] == ["x", "y", "z"]:
        return
    if len(set(names)) == len(names) == n_columns and all(name[:1].isalpha() for name in names):
        raise ScanError(f"has no columns x, y and z, only {', '.join(names[:10])}")
