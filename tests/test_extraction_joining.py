"""Parts of one object that a jump in distance parts in the image."""

import numpy as np
import pytest

from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.interlocking import interlocked_pairs
from shapeconcepts.extraction.pixel_grid import PixelGrid

SHAPE = (60, 80)
PIXEL = 0.004


def seen_from_above(height):
    """A surface whose points are so high, pixels four millimetres apart, from two metres above."""
    rows, columns = np.indices(SHAPE)
    points = np.stack([columns * PIXEL, -rows * PIXEL, height], axis=2)
    distances = (2.0 - height).astype(np.float32)
    up = np.array([0.0, 0.0, 1.0])
    jumps = np.full(SHAPE, 0.01, np.float32)
    grid = PixelGrid(points, np.zeros(3), 2.0 * up, 0.002, distances, jumps, False, up)
    heights = Heights(*(height.astype(np.float32),) * 3, *(height > 0.0,) * 2, *(height,) * 2)
    return grid, heights


def pairs_of(parts):
    """Which of some parts, given as places and heights, are joined."""
    numbers, height = np.full(SHAPE, -1, np.int32), np.zeros(SHAPE)
    for number, (place, high) in enumerate(parts):
        numbers[place], height[place] = number, high
    grid, heights = seen_from_above(height)
    found = interlocked_pairs(numbers, len(parts), np.ones(len(parts), bool), grid, heights)
    assert np.array_equal(found, found.T)
    return {(int(one), int(other)) for one, other in np.argwhere(np.triu(found))}


BODY = np.zeros(SHAPE, bool)
BODY[10:40, 10:40] = True
BODY[20:40, 18:32] = False


def test_a_limb_within_the_outline_of_a_body_is_its_own():
    limb = (slice(24, 38), slice(19, 31))
    assert pairs_of([(BODY, 0.1), (limb, 0.03)]) == {(0, 1)}


@pytest.mark.parametrize("height", [0.01, 0.1])
def test_what_stands_apart_or_is_low_is_not(height):
    place = (slice(12, 30), slice(50, 56)) if height > 0.05 else (slice(24, 38), slice(19, 31))
    assert pairs_of([(BODY, 0.1), (place, height)]) == set()


def test_what_stands_on_top_is_not():
    top = (slice(12, 24), slice(12, 22))
    block = np.zeros(SHAPE, bool)
    block[10:40, 10:40] = True
    block[top] = False
    assert pairs_of([(block, 0.1), (top, 0.2)]) == set()
