"""The inside of a vessel belongs to its outside."""

import numpy as np
import pytest

from shapeconcepts.extraction.component_kernels import near_pairs
from shapeconcepts.extraction.heights import Heights
from shapeconcepts.extraction.hollow import hollow_pairs
from shapeconcepts.extraction.pixel_grid import PixelGrid

SHAPE = (120, 160)
EYE, PITCH = np.array([0.0, -0.7, 0.6]), 0.002
UP = np.array([0.0, 0.0, 1.0])


def rays():
    """Directions (h, w, 3) of a camera that looks at the origin."""
    ahead = -EYE / np.linalg.norm(EYE)
    right = np.cross(ahead, UP) / np.linalg.norm(np.cross(ahead, UP))
    rows, columns = np.indices(SHAPE) - np.array(SHAPE)[:, None, None] / 2
    return ahead + PITCH * (columns[..., None] * right + rows[..., None] * np.cross(ahead, right))


def tube(x, y, radius, height, leans=0.0):
    """Where the rays meet the outside and the inside of an open wall, (2, h, w, 3); NaN where they do not."""
    along, start = rays(), EYE - (x, y, 0.0)
    # A cone, whose radius grows with the height.
    base = radius - leans * height
    a = (along[..., :2] ** 2).sum(axis=-1) - (leans * along[..., 2]) ** 2
    b = (along[..., :2] * start[:2]).sum(axis=-1) - leans * along[..., 2] * (base + leans * start[2])
    c = (start[:2] ** 2).sum() - (base + leans * start[2]) ** 2
    root = np.sqrt(np.where(b * b >= a * c, b * b - a * c, np.nan))
    hits = np.stack([EYE + along * ((-b + sign * root) / a)[..., None] for sign in (-1.0, 1.0)])
    is_on = (hits[..., 2] >= 0.0) & (hits[..., 2] <= height)
    is_on[1] &= ~is_on[0]
    return np.where(is_on[..., None], hits, np.nan)


def pairs_of(*surfaces, hidden=0, noise=0.0):
    """Which surfaces are joined, where some columns at the right are hidden."""
    points, numbers = np.full((*SHAPE, 3), np.nan), np.full(SHAPE, -1, np.int32)
    nearest = np.full(SHAPE, np.inf)
    for number, surface in enumerate(surfaces):
        distance = np.linalg.norm(surface - EYE, axis=-1)
        is_nearer = distance < nearest
        points[is_nearer], numbers[is_nearer], nearest[is_nearer] = (
            surface[is_nearer],
            number,
            distance[is_nearer],
        )
    if hidden:
        points[:, -hidden:], numbers[:, -hidden:] = np.nan, -1
    sight = (points - EYE) / np.linalg.norm(points - EYE, axis=-1, keepdims=True)
    points = points + sight * noise * np.random.default_rng(0).normal(size=(*SHAPE, 1))
    distances = np.linalg.norm(points - EYE, axis=-1).astype(np.float32)
    grid = PixelGrid(points, np.zeros(3), EYE, PITCH, distances, np.full(SHAPE, 0.02, np.float32), False, UP)
    height = points[..., 2].astype(np.float32)
    is_there = numbers >= 0
    heights = Heights(
        height, height, np.zeros_like(height), is_there, is_there, np.zeros_like(height), ~is_there
    )
    n = len(surfaces)
    adjacent = near_pairs(numbers, n, points, np.full(SHAPE, np.inf, np.float32), 2)
    found = hollow_pairs(numbers, n, adjacent, grid, heights)
    assert np.array_equal(found, found.T)
    return {(int(one), int(other)) for one, other in np.argwhere(np.triu(found))}


@pytest.mark.parametrize("radius", [0.035, 0.09])
@pytest.mark.parametrize("leans", [0.0, 0.3])
@pytest.mark.parametrize("hidden", [0, 70])
def test_inside_and_outside_of_a_vessel_are_one(radius, leans, hidden):
    assert pairs_of(*tube(0.0, 0.0, radius, 0.08, leans), hidden=hidden, noise=0.0015) == {(0, 1)}


def test_two_cans_are_two_whether_beside_or_behind():
    first, second = tube(-0.03, 0.0, 0.04, 0.1)[0], tube(0.05, 0.03, 0.04, 0.1)[0]
    behind = tube(0.0, 0.12, 0.04, 0.1)[0]
    assert pairs_of(first, second) == set()
    assert pairs_of(first, behind) == set()


def test_the_inside_of_another_height_is_another_vessel():
    assert pairs_of(tube(0.0, 0.0, 0.05, 0.06)[0], tube(0.0, 0.0, 0.05, 0.1)[1]) == set()


def test_a_wall_behind_a_can_is_not_its_inside():
    can = tube(0.0, 0.0, 0.04, 0.1)[0]
    along = rays()
    wall = EYE + along * ((0.05 - EYE[1]) / along[..., 1])[..., None]
    wall = np.where(((wall[..., 2] >= 0.0) & (wall[..., 2] <= 0.1))[..., None], wall, np.nan)
    assert pairs_of(can, wall) == set()
