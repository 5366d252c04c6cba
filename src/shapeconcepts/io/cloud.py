"""What the reader of one format hands back, and how the formats share text and labels."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.scan import ScanError, whole_numbers

Value = TypeVar("Value")

LABEL_NAMES = ("label", "labels")
VIEWPOINT_NAMES = ("vp_x", "vp_y", "vp_z")
# Splitting a line takes 30 times its size.
LONGEST_LINE = 2**20
# Control characters that no text holds.
_NO_TEXT = re.compile(r"[\0-\x08\x0e-\x1a\x1c-\x1f]")
# How C libraries write what is no number: -nan(ind), 1.#QNAN, -1.#IND, 1.#INF.
_NO_NUMBER = re.compile(r"[-+]?nan\(\w*\)|[-+]?1\.#(?:QNAN|SNAN|IND|NAN)\w*", re.I)
_INFINITE = re.compile(r"1\.#INF\w*", re.I)


class Cloud(NamedTuple):
    """The content of a file, row by row as it stands there.

    The viewpoint is what the file declares, None where nobody set it; notices are those of `Scan`. Of an
    image, there are its height and width; and the pixel of each point, row by row, or None where every pixel
    has one.
    """

    points: NDArray[np.float64]
    viewpoint: NDArray[np.float64] | None = None
    point_labels: NDArray[np.int64] | None = None
    notices: tuple[str, ...] = ()
    image_shape: tuple[int, int] | None = None
    pixels: NDArray[np.int64] | None = None


def without_mark(data: bytes) -> bytes:
    """Bytes without the byte order mark that some editors put before a text."""
    return data.removeprefix(b"\xef\xbb\xbf")


def line_end_of(header: bytes) -> bytes:
    """What ends the lines of a header: a line feed, or a carriage return where none comes before one.

    A line feed alone also ends lines with both, up to a carriage return that is blank space.
    """
    first = header.find(b"\r")
    is_alone = first >= 0 and header[first : first + 2] != b"\r\n" and b"\n" not in header[:first]
    return b"\r" if is_alone else b"\n"


def decoded_lines(data: bytes) -> list[str]:
    """Lines of a text file in UTF-8, or else Latin-1; ScanError where the bytes are no text."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if found := _NO_TEXT.search(text):
        raise ScanError(f"is not text (it holds the byte {ord(found[0])})")
    return checked_lines(text)


def checked_lines(text: str) -> list[str]:
    """Lines of a text; ScanError where one is too long for a point or a face."""
    lines = text.splitlines()
    longest = max(map(len, lines), default=0)
    if longest > LONGEST_LINE:
        raise ScanError(f"has a line of {longest} characters, at most {LONGEST_LINE} are supported")
    return lines


def is_number(word: str) -> bool:
    """Whether a word of a text is a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def number_table(
    lines: list[str], columns: Sequence[int] | None = None, delimiter: str | None = None
) -> NDArray[np.float64]:
    """Numbers of the given columns (by default all), one row a line; ScanError where one is missing."""
    if not lines:
        raise ScanError("holds no points")
    try:
        return np.loadtxt(lines, usecols=columns, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError as error:
        plain = [_INFINITE.sub("inf", _NO_NUMBER.sub("nan", line)) for line in lines]
        if plain != lines:
            return number_table(plain, columns, delimiter)
        raise ScanError(f"the table of points cannot be read: {error}") from None


def labels_or_notice(
    read: Callable[[], ArrayLike | None],
) -> tuple[NDArray[np.int64] | None, tuple[str, ...]]:
    """Point labels, see `value_or_notice`."""

    def labels() -> NDArray[np.int64] | None:
        found = read()
        return None if found is None else whole_numbers(found)

    return value_or_notice("labels", labels)


def value_or_notice(what: str, read: Callable[[], Value | None]) -> tuple[Value | None, tuple[str, ...]]:
    """What a cloud may have beside its points; where it cannot be read, why, as a notice."""
    try:
        return read(), ()
    except ScanError as error:
        return None, (f"has {what} that cannot be read ({error}): the points are used without",)
