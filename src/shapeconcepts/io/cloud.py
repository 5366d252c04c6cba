"""What the reader of one format hands back, and how the formats share text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError

LABEL_NAMES = ("label", "labels")
# Splitting a line takes 30 times its size.
LONGEST_LINE = 2**20


class Cloud(NamedTuple):
    """The content of a file, row by row as it stands there."""

    points: NDArray[np.float64]
    viewpoint: NDArray[np.float64] | None = None
    point_labels: NDArray[np.int64] | None = None


def decoded_lines(data: bytes) -> list[str]:
    """Lines of a text file; ScanError where the bytes are no text."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScanError(f"is not text (byte {error.start})") from None
    if "\0" in text:
        raise ScanError(f"is not text (byte {data.index(0)})")
    return checked_lines(text)


def checked_lines(text: str) -> list[str]:
    """Lines of a text; ScanError where one is too long for a point or a face."""
    lines = text.splitlines()
    longest = max(map(len, lines), default=0)
    if longest > LONGEST_LINE:
        raise ScanError(f"has a line of {longest} characters, at most {LONGEST_LINE} are supported")
    return lines


def number_table(
    lines: list[str], columns: Sequence[int] | None = None, delimiter: str | None = None
) -> NDArray[np.float64]:
    """Numbers of the given columns (by default all), one row a line; ScanError where one is missing."""
    if not lines:
        raise ScanError("holds no points")
    try:
        return np.loadtxt(lines, usecols=columns, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError as error:
        raise ScanError(f"the table of points cannot be read: {error}") from None
