"""Bounds what a compressed file may unpack to, before anything is allocated for it."""

from __future__ import annotations

import os

from shapeconcepts.scan import ScanError

# An image of most depth cameras. A file that has more bytes may hold as many points.
MOST_POINTS = 1_000_000
MOST_POINTS_VARIABLE = "SHAPECONCEPTS_MOST_POINTS"
# Coordinates, normal and colour, in single precision; or coordinates and a label in double precision.
BYTES_PER_POINT = 32


def check_unpacked(n_bytes: int, file_size: int, n_points: int | None = None) -> None:
    """Raise ScanError where a compressed file would become too many points or bytes.

    It may have a million points, or as many as the file has bytes if these are more, and 32 bytes for each.
    The environment variable SHAPECONCEPTS_MOST_POINTS sets another number instead of the million.

    Parameters
    ----------
    n_bytes, file_size : int
        What the file says it unpacks to, and what it has.
    n_points : int, optional
        Where they are known already.
    """
    limit = max(_most_points(), file_size)
    if n_bytes > BYTES_PER_POINT * limit or (n_points or 0) > limit:
        points = "" if n_points is None else f" with {n_points} points"
        raise ScanError(
            f"unpacks from {file_size} bytes to {n_bytes}{points}, at most {limit} points of "
            f"{BYTES_PER_POINT} bytes are unpacked; the environment variable {MOST_POINTS_VARIABLE} "
            "sets another number of points"
        )


def _most_points() -> int:
    text = os.environ.get(MOST_POINTS_VARIABLE, "")
    if not text:
        return MOST_POINTS
    if not (text.isascii() and text.isdigit() and len(text) <= 18):
        raise ScanError(
            f"the environment variable {MOST_POINTS_VARIABLE} must be a number of points, got {text[:30]!r}"
        )
    return int(text)
