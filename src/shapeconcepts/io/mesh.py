"""A triangle mesh, as the readers of mesh formats hand it back."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError


class Mesh(NamedTuple):
    """Vertices (v, 3) in the units of the file, and triangles (f, 3) whose indices nobody has checked yet."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


def triangles(polygons: Sequence[Sequence[int]]) -> NDArray[np.int64]:
    """Each polygon as a fan of triangles around its first corner."""
    fans = [(polygon[0], second, third) for polygon in polygons for second, third in pairwise(polygon[1:])]
    try:
        return np.array(fans, dtype=np.int64).reshape(-1, 3)
    except OverflowError:
        raise ScanError("a face has an index that is no 64 bit number") from None
