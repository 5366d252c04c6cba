"""The kernel that lays borders along creases, against a slow version and against wedges."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.segmentation.border_settling_kernels import INVOLVED_SHARE, settle_borders
from shapeconcepts.segmentation.crease_kernels import sharpen_borders
from shapeconcepts.segmentation.surface_fit_kernels import fit_surface

SCALE = 5.0
SMOOTHNESS = 0.6
REACH = 1.0


def wedge(turn: float, seed: int, noise: float = 0.0, half: int = 14):
    """Two half planes, one point per unit square, that meet along y at an angle `turn` (convex > 0)."""
    rng = np.random.default_rng(seed)
    s, y = (part.ravel() for part in np.meshgrid(np.arange(half) + 0.5, np.arange(2.0 * half)))
    points, normals = [], []
    for side in (-1, 1):
        away, along = s + rng.uniform(-0.25, 0.25, len(s)), y + rng.uniform(-0.25, 0.25, len(s))
        normal = np.array([side * np.sin(turn / 2), 0.0, np.cos(turn / 2)])
        flat = np.column_stack([side * away * np.cos(turn / 2), along, -away * np.sin(turn / 2)])
        points.append(flat + rng.normal(0, noise, (len(s), 1)) * normal)
        normals.append(np.tile(normal, (len(s), 1)))
    return np.vstack(points), np.vstack(normals), np.repeat([0, 1], len(s)).astype(np.int32)


def settle(points, normals, labels):
    neighbours = radius_neighbours(points, 2.5)
    return settle_borders(points, normals, *neighbours, labels, SCALE, SMOOTHNESS, REACH)


def slowly(points, normals, labels):
    """The same, with distances between all points and one voxel and region after the other."""
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    adjacent = (apart <= 2.5) & ~np.eye(len(points), dtype=bool)
    settled = labels.copy()
    for i in np.flatnonzero(labels >= 0):
        near = np.flatnonzero(adjacent[i])
        around = np.flatnonzero(adjacent[near].any(axis=0) & (apart[i] <= SCALE)) if len(near) else near
        around = around[around != i].astype(np.int32)
        fits = {}
        for region in {int(labels[i]), *labels[near].tolist()} - {-1}:
            count, height, *normal = fit_surface(
                points, normals, labels, region, around, *points[i], SCALE, np.empty((7, 7))
            )
            if count > 0:
                fits[region] = height, np.array(normal)
        gains = {}
        for region in fits.keys() - {int(labels[i])}:
            if labels[i] not in fits:
                continue
            (own_height, own_normal), (height, normal) = fits[labels[i]], fits[region]
            own, other = near[labels[near] == labels[i]], near[labels[near] == region]
            own_mean = points[own].mean(axis=0) if len(own) else points[i]
            convex = (own_normal - normal) @ (own_mean - points[other].mean(axis=0)) >= 0
            gains[region] = (1 if convex else -1) * (own_height - height)
            gains[region] += SMOOTHNESS * (len(other) - len(own)) / len(near)
            if abs(height) - abs(own_height) > REACH or len(other) < INVOLVED_SHARE * len(near):
                del gains[region]
        if gains and max(gains.values()) > 0:
            settled[i] = max(gains, key=gains.get)
    return settled


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.booleans())
def test_agrees_with_a_slow_version(seed, n_regions, scattered):
    rng = np.random.default_rng(seed)
    points, normals, labels = wedge(rng.uniform(-2, 2), seed, noise=0.2, half=7)
    if scattered:
        labels = rng.integers(-1, n_regions, len(points)).astype(np.int32)
    else:
        labels = np.where(rng.uniform(size=len(points)) < 0.1, 1 - labels, labels).astype(np.int32)
    np.testing.assert_array_equal(settle(points, normals, labels), slowly(points, normals, labels))


@pytest.mark.parametrize("turn", [50, 70, 90, 110, -50, -70, -90, -110])
def test_noisy_border_is_laid_better_than_by_the_nearest_surface(turn):
    wrong = np.zeros(2, int)
    for seed in range(5):
        points, normals, truth = wedge(np.radians(turn), seed, noise=0.3)
        neighbours = radius_neighbours(points, 2.5)
        nearest = sharpen_borders(points, normals, *neighbours, truth, SCALE, SMOOTHNESS, 3)
        wrong += [(nearest != truth).sum(), (settle(points, normals, nearest) != truth).sum()]
    assert wrong[1] < wrong[0]


def test_lifted_voxel_at_a_convex_edge_goes_to_its_own_side():
    points, normals, truth = wedge(np.radians(90), 0)
    beside = np.flatnonzero((truth == 0) & (points[:, 1] > 8) & (points[:, 1] < 20))
    voxel = beside[np.argmax(points[beside, 0])]
    points[voxel] += 1.2 * normals[voxel]
    neighbours = radius_neighbours(points, 2.5)
    given = truth.copy()
    given[voxel] = 1
    nearest = sharpen_borders(points, normals, *neighbours, given, SCALE, 0.0, 1)
    settled = settle_borders(points, normals, *neighbours, given, SCALE, 0.0, REACH)
    assert nearest[voxel] == 1
    assert settled[voxel] == truth[voxel]


def test_surfaces_one_behind_the_other_keep_their_voxels():
    rng = np.random.default_rng(0)
    x, y = (part.ravel() for part in np.meshgrid(np.arange(20.0), np.arange(12.0)))
    flat = np.column_stack([x, y, np.zeros(len(x))]) + rng.uniform(-0.1, 0.1, (len(x), 3))
    points = np.vstack([flat, flat + np.array([10.0, 0, 2])])
    normals = np.tile([0.0, 0, 1], (len(points), 1))
    labels = np.repeat([0, 1], len(x)).astype(np.int32)
    np.testing.assert_array_equal(settle(points, normals, labels), labels)


def test_does_not_depend_on_pose_or_order():
    points, normals, truth = wedge(np.radians(80), 3, noise=0.3)
    rng = np.random.default_rng(1)
    given = np.where(rng.uniform(size=len(truth)) < 0.1, 1 - truth, truth).astype(np.int32)
    settled = settle(points, normals, given)
    assert (settled != given).any()
    turn, order = Rotation.random(random_state=rng).as_matrix(), rng.permutation(len(points))
    turned = settle((points @ turn.T + 7)[order], (normals @ turn.T)[order], given[order])
    np.testing.assert_array_equal(turned, settled[order])


def test_voxels_that_no_surface_can_be_fitted_beside_stay():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [50, 0, 0]])
    normals = np.tile([0.0, 0, 1], (4, 1))
    for labels in ([0, 1, 1, 0], [-1, 0, 1, 1], [-1, -1, -1, -1]):
        given = np.array(labels, np.int32)
        np.testing.assert_array_equal(settle(points, normals, given), given)


def test_voxels_without_a_region_stay_without():
    points, normals, labels = wedge(np.radians(90), 0, noise=0.3)
    labels[::7] = -1
    settled = settle(points, normals, labels)
    np.testing.assert_array_equal(settled == -1, labels == -1)
