"""Slender low things, such as cutlery: they go on along their line where noise hides a part of them."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.heights import LOW, WINDOW_PIXELS, Heights
from shapeconcepts.extraction.pixel_grid import PixelGrid

# Times as long as it is wide, metres of its width and length.
_SLENDER, _WIDEST, _SHORTEST = 2.5, 0.06, 0.04
# Shares of its pixels between which it is so long and so wide.
_ENDS = (0.02, 0.98)
# Metres of one step along the line, beside its edges, and of all steps past an end.
_STEP, _EDGE, _FARTHEST = 0.008, 0.001, 0.25
# Pixels of what has a line.
_FEWEST_PIXELS = 12
# Share of its own height that is expected where it goes on, with gaps such as those between the tines of a
# fork; log-likelihood ratio to the bare surface from which on it does; and share at which it ends sideways.
_EXPECTED, _CERTAIN, _SHARE = 0.6, 3.0, 0.0
# Metres of what is tall.
_TALL = 0.02


class _Line(NamedTuple):
    """Coordinates along and across the line of a thing."""

    middle: NDArray[np.float64]
    along: NDArray[np.float64]
    across: NDArray[np.float64]
    start: float
    stop: float
    width: float

    def coordinates(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of points, (n,) each: metres."""
        offsets = points - self.middle
        return offsets @ self.along, offsets @ self.across


def go_on_along_lines(
    numbers: NDArray[np.int32], first: int, stop: int, grid: PixelGrid, heights: Heights
) -> None:
    """Give slender things, in place, what is in line with them and as wide, as far as it is high on average.

    Parameters
    ----------
    numbers : (h, w) int32
        Thing of each pixel, -1 for none.
    first, stop : int
        The low ones.
    grid : PixelGrid
    heights : Heights
    """
    flat = numbers.ravel()
    low = np.flatnonzero(flat >= first)
    of_thing = flat[low]
    order = np.argsort(of_thing, kind="stable")
    ends = np.searchsorted(of_thing[order], np.arange(first, stop + 1))
    points = grid.points.reshape(-1, 3)
    for number, (start, end) in enumerate(pairwise(ends), first):
        members = low[order[start:end]]
        if len(members) < _FEWEST_PIXELS:
            continue
        line = _line(points[members], grid.up)
        if line is not None:
            others = _free_beside(numbers, members, grid, heights)
            height = float(np.median(heights.smooth.ravel()[members]))
            flat[_going_on(line, others, points[others], heights, height)] = number


def _line(points: NDArray[np.float64], up: NDArray[np.float64]) -> _Line | None:
    """The line of a thing, if it is slender."""
    middle = points.mean(axis=0)
    offsets = points - middle
    offsets -= np.outer(offsets @ up, up)
    along = np.linalg.eigh(offsets.T @ offsets)[1][:, -1]
    across = np.cross(up, along)
    start, stop = np.quantile(offsets @ along, _ENDS)
    sides = np.quantile(offsets @ across, _ENDS)
    width = float(sides[1] - sides[0])
    if stop - start < max(_SLENDER * width, _SHORTEST) or width > _WIDEST:
        return None
    return _Line(middle + across * sides.mean(), along, across, float(start), float(stop), width)


def _free_beside(
    numbers: NDArray[np.int32], members: NDArray[np.int64], grid: PixelGrid, heights: Heights
) -> NDArray[np.int64]:
    """Pixels of nothing else around a thing."""
    rows, columns = np.divmod(members, numbers.shape[1])
    distance = float(np.median(grid.distances.ravel()[members]))
    reach = int(_FARTHEST / (grid.pitch * distance)) + 1
    top, left = max(int(rows.min()) - reach, 0), max(int(columns.min()) - reach, 0)
    window = (slice(top, int(rows.max()) + reach + 1), slice(left, int(columns.max()) + reach + 1))
    is_free = heights.is_above[window] & (numbers[window] < 0) & (heights.height[window] < _TALL)
    row, column = np.nonzero(is_free)
    return (row + top) * numbers.shape[1] + column + left


def _going_on(
    line: _Line,
    pixels: NDArray[np.int64],
    points: NDArray[np.float64],
    heights: Heights,
    height: float,
) -> NDArray[np.int64]:
    """Pixels into which a thing of a mean height goes on."""
    along, across = line.coordinates(points)
    is_near = np.abs(across) < 0.5 * line.width + _EDGE
    expected, n_steps = _EXPECTED * height, int(_FARTHEST / _STEP) + 1
    found = [np.empty(0, np.int64)]
    for past in (along - line.stop, line.start - along):
        inside = np.flatnonzero(is_near & (past > 0.0) & (past < _FARTHEST))
        own, step = pixels[inside], (past[inside] / _STEP).astype(np.int64)
        noise = heights.low.ravel()[own] / LOW * np.sqrt(WINDOW_PIXELS)
        evidence = expected * (heights.height.ravel()[own] - 0.5 * expected) / noise**2
        so_far = np.cumsum(np.bincount(step, evidence, n_steps))
        last = int(so_far.argmax())
        if so_far[last] > _CERTAIN:
            found.append(own[(step <= last) & (heights.smooth.ravel()[own] > _SHARE * height)])
    return np.concatenate(found)
