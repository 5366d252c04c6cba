"""Objects whose support is not seen: it is hidden, too narrow, or at a grazing angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.component_kernels import silhouettes
from shapeconcepts.extraction.pixel_grid import PixelGrid
from shapeconcepts.extraction.supporting_planes import HIGHEST, SupportingPlane

# Metres: how long it is at most, how far it reaches up at least, and how far below the lowest plane.
LONGEST, _LEAST_RISE, _BELOW = 0.5, 0.04, 0.02
# Shares of its border: beyond which lies something farther, at least, and where its surface goes on, at most,
# which may be its foot on what it stands on.
IN_FRONT, GOES_ON = 0.5, 0.25


def unsupported_objects(
    numbers: NDArray[np.int32],
    n: int,
    candidates: NDArray[np.bool_],
    grid: PixelGrid,
    planes: list[SupportingPlane],
) -> NDArray[np.bool_]:
    """Which of the candidates are compact and in front of what is around them, at the height of objects.

    Legs of a table are too low, walls and table tops too long; a patch of a wall is behind what is around it.

    Parameters
    ----------
    numbers : (h, w) int32
        Part of each pixel, -1 for none.
    n : int
    candidates : (n,) bool
    grid : PixelGrid
    planes : list of SupportingPlane
        Those that are seen.

    Returns
    -------
    (n,) bool
    """
    found = np.zeros(n, bool)
    if not candidates.any():
        return found
    flat, points = numbers.ravel(), grid.points.reshape(-1, 3)
    axes = np.linalg.svd(grid.up[None])[2][1:]
    lowest = min(float(plane.point @ grid.up) for plane in planes)
    in_front, goes_on, sides = silhouettes(numbers, n, grid.distances, grid.jumps)
    is_apart = (in_front > IN_FRONT * sides) & (goes_on < GOES_ON * sides)
    for number in np.flatnonzero(candidates & is_apart):
        cloud = points[flat == number]
        bottom, top = np.quantile(cloud @ grid.up, (0.02, 0.98)) - lowest
        lengths = np.ptp(np.quantile(cloud @ axes.T, (0.01, 0.99), axis=0), axis=0)
        found[number] = (
            bottom > -_BELOW and top < HIGHEST and top - bottom > _LEAST_RISE and lengths.max() < LONGEST
        )
    return found
