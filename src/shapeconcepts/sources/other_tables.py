"""Small tables of numbers that lie beside scans: calibrations, poses, trajectories."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import decoded_lines, is_number
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.scan import ScanError

TEXT_SUFFIXES = (".txt", ".csv", ".xyz", ".asc", ".pts")
# Fewer points are no object that anything can be said of.
FEWEST_POINTS = 10
# Rows and bytes that are enough to tell a list of poses.
_ENOUGH_ROWS, _ENOUGH_BYTES = 200, 2**16
_COMMENTS = ("#", "//", "%")
_TOLERANCE = 1e-3


def what_else_it_is(path: Path) -> str:
    """What a file is that can be read as points, but holds another kind of numbers; empty for points."""
    table = _table(path)
    if table is None:
        return ""
    n_rows, n_columns = table.shape
    if n_rows < FEWEST_POINTS:
        return (
            f"is a table of {n_rows} x {n_columns} numbers and no scan: "
            f"in a folder, those have {FEWEST_POINTS} points or more"
        )
    if n_columns in (12, 16) and _are_poses(table.reshape(n_rows, -1, 4)):
        return "is a list of poses (matrices of 4 columns) and no scan"
    is_rising = bool((np.diff(table[:, 0]) > 0).all())
    if n_columns == 8 and is_rising and _are_quaternions(table[:, 4:]):
        return "is a trajectory (times, positions and quaternions) and no scan"
    if n_columns == 7 and _are_quaternions(table[:, 3:]):
        return "is a list of poses (positions and quaternions) and no scan"
    return ""


def _table(path: Path) -> NDArray[np.float64] | None:
    """The first rows of a table; None where it is none, or has other things than numbers."""
    suffix = path.suffix.lower()
    try:
        if suffix == ".npy":
            array = np.load(path, mmap_mode="r", allow_pickle=False)
            is_table = array.ndim == 2 and array.dtype.kind in "fiu"
            return np.array(array[:_ENOUGH_ROWS], np.float64) if is_table else None
        if suffix not in TEXT_SUFFIXES:
            return None
        content = read_regular_file(path)
        start = content[:_ENOUGH_BYTES]
        if len(start) < len(content):
            # The last line is not whole.
            start = start[: start.rfind(b"\n") + 1]
        lines = [line.strip() for line in decoded_lines(start)]
        rows = [line for line in lines if line and not line.startswith(_COMMENTS)]
        words = [line.replace(",", " ").replace(";", " ").split() for line in rows[:_ENOUGH_ROWS]]
        first = next((i for i, row in enumerate(words) if len(row) > 1 and any(map(is_number, row))), 0)
        return np.array([[float(word) for word in row] for row in words[first:]]).reshape(
            len(words) - first, -1
        )
    except (ScanError, ValueError, OSError):
        # Something else than numbers stands in it.
        return None


def _are_poses(matrices: NDArray[np.float64]) -> bool:
    """Whether the first three columns of matrices (n, 3 or 4, 4) are rotations."""
    rotations = matrices[:, :3, :3]
    products = np.einsum("nij,nkj->nik", rotations, rotations)
    return bool(np.allclose(products, np.eye(3), atol=_TOLERANCE))


def _are_quaternions(rows: NDArray[np.float64]) -> bool:
    """Whether rows of four have length 1, but are no normals with something else behind them."""
    lengths = np.linalg.norm(rows, axis=1)
    of_three = np.linalg.norm(rows[:, :3], axis=1)
    return bool(np.allclose(lengths, 1, atol=_TOLERANCE) and not np.allclose(of_three, 1, atol=_TOLERANCE))
