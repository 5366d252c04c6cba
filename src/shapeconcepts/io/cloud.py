"""What the reader of one format hands back, and the numbers that the formats share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.scan import ScanError

LABEL_NAMES = ("label", "labels")


class Cloud(NamedTuple):
    """The content of a file, row by row as it stands there."""

    points: NDArray[np.float64]
    viewpoint: NDArray[np.float64] | None = None
    point_labels: NDArray[np.int64] | None = None


def whole_numbers(values: ArrayLike) -> NDArray[np.int64]:
    """Labels as int64; ScanError where one is not a whole number or does not fit."""
    labels = np.asarray(values)
    if labels.dtype.kind == "f":
        # 2^63 itself is a float64 but no int64.
        if not (np.isfinite(labels).all() and (np.abs(labels) < 2.0**63).all() and (labels % 1 == 0).all()):
            raise ScanError("a point label is not a whole number")
    elif labels.dtype.kind not in "iub":
        raise ScanError(f"point labels must be numbers, got {labels.dtype}")
    elif labels.dtype == np.uint64 and labels.size and labels.max() >= 2**63:
        raise ScanError("a point label is too large")
    return labels.astype(np.int64)


def decoded_lines(data: bytes) -> list[str]:
    """Lines of a text file; ScanError where the bytes are no text."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScanError(f"is not text (byte {error.start})") from None
    if "\0" in text:
        raise ScanError(f"is not text (byte {data.index(0)})")
    return text.splitlines()


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
