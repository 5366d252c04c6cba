"""Visible parts of objects, and which of them are one object."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components as components_of_graph

from shapeconcepts.extraction.component_kernels import (
    connected_components,
    contacts,
    grow_components,
    grow_downwards,
    hidden_sides,
    near_pairs,
)
from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.pixel_grid import PixelGrid

# Metres above the surface from which on something is tall: it does not end in the noise of the surface.
TALL = 0.018
# Of something tall, at least such a share is so many times as high.
_WELL_TALL, _SHARE_WELL_TALL = 1.4, 0.1
# Share of the change in distance that parts surfaces, from which on it parts what is tall. What it parts of
# one object is near in space along the edge.
JUMP = 0.6
# Metres between parts of one object, beside their noise.
REACH = 0.012
_FEWEST_NEAR = 6
_NEAR_PIXELS = 3
# Metres sideways by which the foot of something tall is off the wall above it, beside noise.
BASE = 0.01
# Pixels of what is a part at all.
_LEAST_TALL, _LEAST_LOW = 25, 15
# Share of the border of something low along which it goes on as something tall.
CONTACT = 0.2
# Pixels by which a part is larger than what of it is beyond noise.
_GROWTH = 4
# Metres above the surface of what stands on nothing, and the share of its lower border that something hides.
FLOATS = 0.04
HIDDEN = 0.1
_LEAST_BESIDE = 12
# Metres between parts of one object that a jump in distance parts.
APART = 0.08
# Share of the height of something low at which it ends.
TRIM = 0.3
# Square metres of what may be furniture if it is not above any, and rows to the next one that is looked at.
_LARGEST, _ROWS = 0.15, 4
# Pixels, share of its border, and metres of what is the floor of something.
_LEAST_HOLE, _ENCLOSED, _LEAST_FLOOR = 40, 0.5, 0.0015


def find_fragments(
    grid: PixelGrid, heights: Heights, is_free: NDArray[np.bool_], noises: NDArray[np.float32]
) -> tuple[NDArray[np.int32], int]:
    """Number of the object that each pixel belongs to (h, w), -1 for none, and how many there are.

    What is tall is one where its surface is connected, or near in space across a gap, or hollow (see
    `hollow_pairs`), or where it would float without the other. What is low is a part of something tall if it
    goes on as such along much of its border, such as the middle of a plate; else it is an object of its own,
    such as a fork.

    Parameters
    ----------
    grid : PixelGrid
    heights : Heights
    is_free : (h, w) bool
        Points that belong to nothing else, such as a wall, and not to the surface.
    noises : (h, w) float32
        Of the depth, metres.
    """
    points, distances, jumps = grid.points, grid.distances, grid.jumps
    is_tall = is_free & (~heights.is_above | (heights.height > TALL))
    numbers, n_tall = _components(is_tall, grid._replace(jumps=np.float32(JUMP) * jumps), _LEAST_TALL)
    if n_tall:
        is_hardly = _hardly_tall(numbers, n_tall, heights)
        if is_hardly.any():
            is_tall &= ~is_hardly[numbers]
            numbers, n_tall = _kept(numbers, ~is_hardly[:-1])
    if n_tall:
        near = (
            near_pairs(numbers, n_tall, points, np.float32(REACH) + 2.0 * noises, _NEAR_PIXELS)
            >= _FEWEST_NEAR
        )
        near &= _pairs_of_things(numbers, n_tall, grid, heights)
        numbers, n_tall = joined(numbers, n_tall, near)
        beside = near_pairs(numbers, n_tall, points, np.full(distances.shape, APART, np.float32), 2)
        beside *= _pairs_of_things(numbers, n_tall, grid, heights)
        together = _floating_pairs(numbers, n_tall, beside, grid, heights)
        numbers, n_tall = joined(numbers, n_tall, together)
    is_low = is_free & heights.is_high & ~is_tall
    with_foot = numbers.copy()
    grow_downwards(with_foot, is_low, points, grid.up, np.float32(BASE) + 2.0 * noises)
    low, n_low = _components(is_low, grid, _LEAST_LOW)
    if n_low:
        counts, borders = contacts(low, n_low, numbers, max(n_tall, 1), distances, jumps)
        goes_on = counts.max(axis=1) > CONTACT * borders
        becomes = np.where(goes_on, counts.argmax(axis=1), n_tall + np.arange(n_low)).astype(np.int32)
        numbers = np.where(low >= 0, becomes[low], numbers)
        # Something low that reaches from one to another does not have the feet of both.
        numbers = np.where((low >= 0) & (with_foot >= 0), with_foot, numbers)
    grow_components(numbers, is_free & heights.is_above, distances, jumps, _GROWTH)
    _trim(numbers, n_tall, n_tall + n_low, heights)
    _fill(numbers, n_tall + n_low, grid, heights)
    return numbers, n_tall + n_low


def _pairs_of_things(
    numbers: NDArray[np.int32], n: int, grid: PixelGrid, heights: Heights
) -> NDArray[np.bool_]:
    """Pairs of parts of which none is a piece of furniture, (n, n) bool."""
    some = numbers[::_ROWS]
    own = some >= 0
    of_part = some[own]
    areas = _ROWS * np.bincount(of_part, (grid.pitch * grid.distances[::_ROWS][own]) ** 2, n)
    above = np.bincount(of_part, heights.is_above[::_ROWS][own], n)
    is_thing = (areas < _LARGEST) | (above > 0.5 * np.bincount(of_part, minlength=n))
    return is_thing & is_thing[:, None]


def _hardly_tall(numbers: NDArray[np.int32], n: int, heights: Heights) -> NDArray[np.bool_]:
    """Whether noise makes what is as high as the limit tall, (n + 1,) bool; the last one is for -1."""
    own = (numbers >= 0) & heights.is_above
    well_tall = np.bincount(numbers[own], heights.height[own] > _WELL_TALL * TALL, minlength=n)
    others = np.bincount(numbers[(numbers >= 0) & ~heights.is_above], minlength=n)
    sizes = np.bincount(numbers[own], minlength=n)
    return np.append((others == 0) & (well_tall < _SHARE_WELL_TALL * sizes), False)


def _trim(numbers: NDArray[np.int32], first: int, stop: int, heights: Heights) -> None:
    """End low objects, from the first on, in place, where their mean height falls to a share of it."""
    own = (numbers >= first) & heights.is_high
    of_object = numbers[own]
    order = np.argsort(of_object, kind="stable")
    ends = np.searchsorted(of_object[order], np.arange(first, stop + 1))
    smooth = heights.smooth[own][order]
    # The last one is for -1; an object of which nothing is high ends at once.
    least = np.full(stop + 1, -np.inf, np.float32)
    for number, (start, end) in enumerate(pairwise(ends), first):
        least[number] = TRIM * np.median(smooth[start:end]) if end > start else np.inf
    is_low = numbers >= first
    numbers[is_low] = np.where(heights.smooth[is_low] < least[numbers[is_low]], -1, numbers[is_low])


def _fill(numbers: NDArray[np.int32], n: int, grid: PixelGrid, heights: Heights) -> None:
    """Give objects, in place, what is within them and above the surface, such as a plate's floor."""
    is_open = (numbers < 0) & heights.is_above
    holes, n_holes = _components(is_open, grid, _LEAST_HOLE)
    if not n_holes or not n:
        return
    counts, borders = contacts(holes, n_holes, numbers, n, grid.distances, grid.jumps)
    is_enclosed = counts.max(axis=1) > _ENCLOSED * borders
    if not is_enclosed.any():
        return
    holes, n_holes = _kept(holes, is_enclosed)
    own = holes >= 0
    of_hole = holes[own]
    mean = np.bincount(of_hole, heights.height[own] + heights.level[own], n_holes) / np.bincount(of_hole)
    becomes = np.where(mean > _LEAST_FLOOR, counts[is_enclosed].argmax(axis=1), -1).astype(np.int32)
    numbers[own] = becomes[of_hole]


def _floating_pairs(
    numbers: NDArray[np.int32], n: int, beside: NDArray[np.int64], grid: PixelGrid, heights: Heights
) -> NDArray[np.bool_]:
    """Parts that stand on nothing, with what they are beside for the most part, (n, n) bool."""
    together = np.zeros((n, n), bool)
    lowest = np.full(n, np.inf, np.float32)
    own = numbers >= 0
    bottoms = np.where(heights.is_above[own], heights.height[own], np.float32(0.0))
    np.minimum.at(lowest, numbers[own], bottoms)
    hidden, sides = hidden_sides(numbers, n, grid.distances, grid.jumps, *_downwards(grid))
    for one in np.flatnonzero((lowest > FLOATS) & (hidden < HIDDEN * sides)):
        other = int(beside[one].argmax())
        together[one, other] = together[other, one] = beside[one, other] >= _LEAST_BESIDE
    return together


def _downwards(grid: PixelGrid) -> tuple[int, int]:
    """The step to a neighbouring pixel, rows and columns, that leads down the most."""
    step = (slice(None, None, 8), slice(None, None, 8))
    some = grid.points[step]
    down = float(np.nanmedian((some[1:] - some[:-1]) @ grid.up))
    right = float(np.nanmedian((some[:, 1:] - some[:, :-1]) @ grid.up))
    return (1 if down < 0 else -1, 0) if abs(down) > abs(right) else (0, 1 if right < 0 else -1)


def _components(belongs: NDArray[np.bool_], grid: PixelGrid, fewest: int) -> tuple[NDArray[np.int32], int]:
    """Connected components of so many pixels, see `connected_components`."""
    numbers, n = connected_components(belongs, grid.distances, grid.jumps)
    return _kept(numbers, np.bincount(numbers[numbers >= 0], minlength=n) >= fewest)


def _kept(numbers: NDArray[np.int32], is_kept: NDArray[np.bool_]) -> tuple[NDArray[np.int32], int]:
    """Numbers without those of parts that are not kept, and how many there are then."""
    # The last one is for -1.
    becomes = np.append(np.where(is_kept, np.cumsum(is_kept) - 1, -1), -1).astype(np.int32)
    return becomes[numbers], int(is_kept.sum())


def joined(numbers: NDArray[np.int32], n: int, together: NDArray[np.bool_]) -> tuple[NDArray[np.int32], int]:
    """Numbers of parts of which some are together (n, n), and how many there are then."""
    if not together.any():
        return numbers, n
    n_joined, becomes = components_of_graph(together, directed=False)
    return np.append(becomes, -1).astype(np.int32)[numbers], int(n_joined)
