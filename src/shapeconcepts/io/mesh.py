"""A triangle mesh, as the readers of mesh formats hand it back."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError

# The end of a finely cut cylinder has a few hundred, an outline cut out of a sheet a few thousand.
MOST_CORNERS = 2**14


# What is held for each triangle takes a hundred times the byte that can stand for it in a file.
MOST_TRIANGLES = 2**18
BYTES_PER_TRIANGLE = 4


def check_triangles(n_triangles: int, file_size: int) -> None:
    """Raise ScanError where a file describes many more triangles than it has bytes for."""
    most = max(MOST_TRIANGLES, file_size // BYTES_PER_TRIANGLE)
    if n_triangles > most:
        raise ScanError(
            f"describes {n_triangles} triangles in {file_size} bytes of file, at most {most} are supported"
        )


class Mesh(NamedTuple):
    """Vertices (v, 3) in the units of the file, and triangles (f, 3) whose indices nobody has checked yet."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


class Polygons:
    """Faces with any number of corners, kept as plain 64 bit numbers: lists take ten times as much."""

    def __init__(self) -> None:
        self._corners = array("q")
        self._sizes = array("q")

    def append(self, corners: Iterable[int]) -> None:
        """Add a face; ScanError where an index cannot be one or there are more corners than any mesh has."""
        before = len(self._corners)
        try:
            self._corners.extend(corners)
        except OverflowError:
            raise ScanError("a face has an index that is no 64 bit number") from None
        size = len(self._corners) - before
        if size > MOST_CORNERS:
            raise ScanError(f"a face has {size} corners, at most {MOST_CORNERS} are supported")
        self._sizes.append(size)

    def __len__(self) -> int:
        return len(self._sizes)

    def triangles(self, file_size: int) -> NDArray[np.int64]:
        """Each face as a fan of triangles around its first corner; ScanError where they are too many."""
        corners, sizes = np.frombuffer(self._corners, np.int64), np.frombuffer(self._sizes, np.int64)
        n_triangles = np.maximum(sizes - 2, 0)
        check_triangles(int(n_triangles.sum()), file_size)
        first = np.repeat(np.cumsum(sizes) - sizes, n_triangles)
        triangles = np.empty((len(first), 3), np.int64)
        triangles[:, 0] = corners[first]
        # The place of each triangle in its face.
        first += np.arange(len(first))
        first -= np.repeat(np.cumsum(n_triangles) - n_triangles, n_triangles)
        triangles[:, 1] = corners[first + 1]
        triangles[:, 2] = corners[first + 2]
        return triangles
