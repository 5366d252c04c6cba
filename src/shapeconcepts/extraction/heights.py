"""How high the points of a scene are above what they stand on, and what that says beside noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.height_kernels import (
    block_sums,
    heights_above,
    in_lines,
    window_means,
)
from shapeconcepts.extraction.supporting_planes import HIGHEST, MARGIN, SupportingPlane

# Standard deviations of the mean height over a window of a bare surface: from so many on there is something,
# and beside something so many are still a part of it.
HIGH, LOW = 3.6, 2.0
# Metres: what is lower is no object to anybody.
_LEAST_HIGH, _LEAST_LOW = 0.0025, 0.0012
# Pixels around the middle one.
_WINDOW = 2
# Lines of so many places, pixels from one to the next, and directions. Standard deviations by which a place
# is high, by which the mean of its line is, and from which on more does not count; metres of what is tall.
_PLACES, _PLACE, _DIRECTIONS = 5, 3, 16
_IN_LINE = (2.5, 3.1, 4.0, 0.02)
# Metres outside of its outline up to which a surface may go on.
_BEYOND = 0.3
# Of the surface's own level: pixels in a block, and blocks around the middle one.
_BLOCK, _BLOCKS = 4, 6
_LEAST_BARE = 0.05
_MOST_ROUNDS = 3
_N_COEFFICIENTS = 6
_FEWEST_POINTS = 100


class Heights(NamedTuple):
    """Heights of the points of a scene; arrays are (h, w).

    Attributes
    ----------
    height, smooth : float32
        Metres above the surface, and the mean over a window; NaN where there is no surface below.
    level : float32
        Of the surface at this place, metres, from which they are measured.
    is_above : bool
        Whether the point is above a surface, not higher than an object on it can be.
    is_high : bool
        Whether what is there cannot be noise.
    low : float32
        Height from which on a point beside it belongs to it; infinite where there is no surface below.
    is_beside : bool
        Whether the point may be one of a surface that is not seen around it.
    """

    height: NDArray[np.float32]
    smooth: NDArray[np.float32]
    level: NDArray[np.float32]
    is_above: NDArray[np.bool_]
    is_high: NDArray[np.bool_]
    low: NDArray[np.float32]
    is_beside: NDArray[np.bool_]


def measure_heights(
    points: NDArray[np.float64],
    viewpoint: NDArray[np.float64],
    planes: list[SupportingPlane],
    noise: float,
) -> Heights:
    """Measure heights above supporting planes.

    What a depth camera sees of a plane is bent by some millimetres, and has dents of a few, which an object
    of half a centimetre does not survive. So the surface is a paraboloid that is fitted to the plane's
    points, and its level at each point is the mean around it of what is not high. What is high beside the
    noise that the bare surface really has at this distance is something, and so is what is only a little high
    if a line of such points goes on from it: the handle of a fork, wherever it points.

    Parameters
    ----------
    points : (h, w, 3) float64
    viewpoint : (3,) float64
    planes : list of SupportingPlane
        One at least, the highest first.
    noise : float
        In parts of `depth_noise`.
    """
    flat = np.array([np.concatenate([one.point, one.normal, *one.axes]) for one in planes])
    outlines = np.concatenate([one.outline for one in planes])
    starts = np.concatenate([[0], np.cumsum([len(one.outline) for one in planes])])
    bends = np.zeros((len(planes), _N_COEFFICIENTS))
    step = (slice(None, None, _BLOCK), slice(None, None, _BLOCK))
    some = np.ascontiguousarray(points[step])
    limits = MARGIN, _BEYOND, noise
    found = heights_above(some, viewpoint, flat, outlines, starts, bends, *limits)
    for number, plane in enumerate(planes):
        bends[number] = _bend(plane, number, some, *found)
    height, noises, numbers = heights_above(points, viewpoint, flat, outlines, starts, bends, *limits)
    is_beside = numbers == -2
    numbers[height > HIGHEST] = -1
    is_above = numbers >= 0
    smooth = window_means(height, 8.0 * noises + np.float32(0.004), _WINDOW)
    high = np.full(height.shape, np.inf, np.float32)
    low = high.copy()
    for number in range(len(planes)):
        own = numbers == number
        is_bare = own & (np.abs(height) < 0.01)
        spread = (
            1.4826 * float(np.median(np.abs(smooth[is_bare] / noises[is_bare]))) if is_bare.any() else 1.0
        )
        high[own] = np.maximum(HIGH * spread * noises[own], _LEAST_HIGH)
        low[own] = np.maximum(LOW * spread * noises[own], _LEAST_LOW)
    is_high = is_above & (smooth > high)
    level = _level(height, is_above & ~is_high & (np.abs(height) < high))
    height, smooth = height - level, smooth - level
    is_high = smooth > high
    is_high |= in_lines(smooth, low / np.float32(LOW), _lines(), *_IN_LINE)
    return Heights(height, smooth, level, is_above, is_above & is_high, low, is_beside)


def _lines() -> NDArray[np.int64]:
    """Rows and columns (d, k, 2) from a pixel to the places of a line in each direction."""
    turns = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    along = np.stack([np.sin(turns), np.cos(turns)], axis=1)
    return np.rint(along[:, None] * _PLACE * np.arange(_PLACES)[:, None]).astype(np.int64)


def _bend(
    plane: SupportingPlane,
    number: int,
    points: NDArray[np.float64],
    heights: NDArray[np.float32],
    noises: NDArray[np.float32],
    numbers: NDArray[np.int8],
) -> NDArray[np.float64]:
    """Coefficients of the paraboloid through the points on a plane."""
    own = (numbers == number) & (np.abs(heights) < 3.0 * noises + 0.004)
    along = (points[own] - plane.point) @ plane.axes.T
    u, v = along.T
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    height, noise = heights[own].astype(np.float64), noises[own]
    bend = np.zeros(_N_COEFFICIENTS)
    kept = np.ones(len(height), bool)
    for _ in range(_MOST_ROUNDS):
        if kept.sum() < _FEWEST_POINTS:
            break
        used = terms[kept]
        bend = np.linalg.lstsq(used.T @ used, used.T @ height[kept], rcond=None)[0]
        kept = np.abs(height - terms @ bend) < 3.0 * noise + 0.001
    return bend


def _level(height: NDArray[np.float32], is_bare: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Mean height of the bare surface around each point; 0 where next to nothing of it is bare."""
    sums, counts = block_sums(height, is_bare, _BLOCK)
    sums, counts = _window_sums(sums), _window_sums(counts)
    enough = counts > _LEAST_BARE * ((2 * _BLOCKS + 1) * _BLOCK) ** 2
    level = np.where(enough, sums / np.maximum(counts, 1.0), 0.0).astype(np.float32)
    return level.repeat(_BLOCK, axis=0).repeat(_BLOCK, axis=1)[: height.shape[0], : height.shape[1]]


def _window_sums(values: NDArray[np.float64]) -> NDArray[np.float64]:
    width = 2 * _BLOCKS + 1
    total = np.pad(values, ((_BLOCKS + 1, _BLOCKS), (_BLOCKS + 1, _BLOCKS))).cumsum(axis=0).cumsum(axis=1)
    return np.asarray(
        total[width:, width:] - total[:-width, width:] - total[width:, :-width] + total[:-width, :-width]
    )
