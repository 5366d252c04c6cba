"""What is known of an object that was found in a scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import Scan


@dataclass(frozen=True, eq=False)
class ExtractedObject:
    """An object that was found in a scene.

    Attributes
    ----------
    scan : Scan
        Its points, in the frame of the scene, with the scene's viewpoint. `scan.name` is that of the scene
        and the number of the object, from 0: "learn33/2".
    indices : (n,) int64
        Its points among those of the scene, rising: rows of ``scene.points.reshape(-1, 3)``.
    box : (left, top, right, bottom) of int
        Pixels of the image that it is within; right and bottom are those after the last. Of scenes that are
        not organised, pixels of the image that they are seen in again.
    is_cut : bool
        Whether it reaches the border of the image: a part of it may be beyond.
    may_be_several : bool
        Whether it may be several objects that touch.
    time : float or None
        When it was seen, seconds since 1970.
    """

    scan: Scan
    indices: NDArray[np.int64]
    box: tuple[int, int, int, int]
    is_cut: bool
    may_be_several: bool
    time: float | None = None
