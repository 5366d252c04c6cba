"""Crease kernels against NumPy's least squares and against wedges, cylinders and spheres."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.segmentation.crease_kernels import (
    border_pairs,
    border_voxels,
    crease_angles,
    sharpen_borders,
)
from shapeconcepts.segmentation.super_patches import _unchanged
from shapeconcepts.segmentation.surface_fit_kernels import (
    CURVATURE_RIDGE,
    MIN_FIT_POINTS,
    SLOPE_RIDGE,
    fit_surface,
    gather_surroundings,
)

seeds = st.integers(0, 2**32 - 1)
SCALE = 5.0


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def patch_of_surface(seed: int, n: int = 60) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points on a random quadric, with noisy normals, some labelled 1 and some 0."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.uniform(-0.1, 0.1, 3)
    x, y = rng.uniform(-4, 4, (2, n))
    points = np.column_stack([x, y, a * x * x + b * x * y + c * y * y + rng.normal(0, 0.1, n)])
    normals = unit(
        np.column_stack([-2 * a * x - b * y, -b * x - 2 * c * y, np.ones(n)]) + rng.normal(0, 0.1, (n, 3))
    )
    turn = Rotation.random(random_state=rng).as_matrix()
    return points @ turn.T, normals @ turn.T, rng.integers(0, 3, n).clip(0, 1).astype(np.int32)


def fit(points, normals, labels, region, at, scale=SCALE):
    everyone = np.arange(len(points), dtype=np.int32)
    count, height, *normal = fit_surface(
        points, normals, labels, region, everyone, *at, scale, np.empty((7, 7))
    )
    return count, height, np.array(normal)


def wedge(turn: float, half: int = 14, jitter: float = 0.25, seed: int = 0):
    """Two half planes, one point per unit square, that meet along y at an angle `turn` (convex > 0)."""
    rng = np.random.default_rng(seed)
    s, y = (part.ravel() for part in np.meshgrid(np.arange(half) + 0.5, np.arange(2 * half)))
    points, normals = [], []
    for side in (-1, 1):
        away, along = s + rng.uniform(-jitter, jitter, len(s)), y + rng.uniform(-jitter, jitter, len(s))
        points.append(np.column_stack([side * away * np.cos(turn / 2), along, -away * np.sin(turn / 2)]))
        normals.append(np.tile([side * np.sin(turn / 2), 0.0, np.cos(turn / 2)], (len(s), 1)))
    labels = np.repeat([0, 1], len(s)).astype(np.int32)
    return np.vstack(points), np.vstack(normals), labels


def adjacent(points):
    return radius_neighbours(points, 2.5)


def angle_between(points, normals, labels, max_places=16):
    _, first, second = border_pairs(points, *adjacent(points), labels, np.arange(len(points)))
    whole = np.array([0]), np.array([len(first)])
    angles = crease_angles(
        points, normals, *adjacent(points), labels, first, second, *whole, SCALE, max_places
    )
    return np.degrees(angles[0])


def test_each_border_has_its_own_angle():
    points, normals, labels = wedge(np.radians(60))
    apart = points + np.array([1000.0, 0, 0])
    far_points, far_normals, far_labels = wedge(np.radians(-90))
    points, normals = np.vstack([far_points, apart]), np.vstack([far_normals, normals])
    labels = np.concatenate([far_labels, labels + 2]).astype(np.int32)
    keys, first, second = border_pairs(points, *adjacent(points), labels, np.arange(len(points)))
    starts = np.flatnonzero(np.diff(keys, prepend=-1))
    ends = np.append(starts[1:], len(keys))
    angles = crease_angles(points, normals, *adjacent(points), labels, first, second, starts, ends, SCALE, 16)
    np.testing.assert_allclose(np.degrees(angles), [-90, 60], atol=1.0)


def test_borders_that_merging_does_not_lengthen_keep_their_angles():
    angles = {(0, 1): 0.1, (0, 2): 0.2, (1, 2): 0.3, (1, 3): 0.4, (2, 4): 0.5, (3, 4): 0.6}
    # 0 and 1 become one, so that their borders with 2 do; 3 and 4 likewise.
    merged = np.array([0, 0, 2, 3, 3], np.int32)
    kept = {border: angle for border, angle in _unchanged(angles, merged).items() if border[0] < border[1]}
    assert kept == {(0, 3): 0.4, (2, 3): 0.5}


def cylinder(radius: float):
    turns, heights = np.meshgrid(np.arange(-1.2, 1.2, 1 / radius), np.arange(24.0))
    normals = np.column_stack([np.sin(turns.ravel()), np.zeros(turns.size), np.cos(turns.ravel())])
    return radius * normals + np.column_stack(
        [np.zeros(turns.size), heights.ravel(), np.zeros(turns.size)]
    ), normals


def ball(radius: float):
    n = int(4 * np.pi * radius**2)
    z = 1 - (2 * np.arange(n) + 1) / n
    turn = np.arange(n) * np.pi * (3 - np.sqrt(5))
    normals = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    return radius * normals, normals


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 7), st.floats(0.15, 0.5))
def test_border_pairs_agrees_with_dictionary(seed, n_regions, radius):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (80, 3))
    labels = rng.integers(-1, n_regions, 80).astype(np.int32)
    indptr, indices = radius_neighbours(points, radius)
    expected = {}
    for i in range(80):
        for j in indices[indptr[i] : indptr[i + 1]].tolist():
            if 0 <= labels[i] < labels[j]:
                apart = np.linalg.norm(points[i] - points[j])
                pair = int(labels[i]), int(labels[j]), i
                expected[pair] = min(expected.get(pair, (apart, j)), (apart, j))
    voxels = border_voxels(indptr, indices, labels)
    key, first, second = border_pairs(points, indptr, indices, labels, voxels)
    found = {
        (int(k) // 2**31, int(k) % 2**31, int(i)): int(j) for k, i, j in zip(key, first, second, strict=True)
    }
    assert len(found) == len(key)
    assert found == {pair: j for pair, (_, j) in expected.items()}


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(0.1, 0.6))
def test_surroundings_are_what_two_steps_reach_within_the_radius(seed, radius):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (100, 3)) * [1, 1, 0.1]
    neighbours = radius_neighbours(points, 0.2)
    close = np.zeros((100, 100), bool)
    close[np.repeat(np.arange(100), np.diff(neighbours.indptr)), neighbours.indices] = True
    stamps, surroundings = np.zeros(100, np.int32), np.empty(100, np.int32)
    for stamp, voxel in enumerate(rng.choice(100, 10, replace=False), start=1):
        count = gather_surroundings(points, *neighbours, voxel, radius, stamps, stamp, surroundings)
        reached = close[voxel] @ close
        reached[voxel] = False
        inside = np.linalg.norm(points - points[voxel], axis=1) <= radius
        assert sorted(surroundings[:count].tolist()) == np.flatnonzero(reached & inside).tolist()


@settings(max_examples=60, deadline=None)
@given(seeds, st.sampled_from([1e-3, 1.0, 1e3]))
def test_fit_agrees_with_least_squares(seed, unit_length):
    points, normals, labels = patch_of_surface(seed)
    points *= unit_length
    at, scale = points[0] + 0.3 * unit_length, SCALE * unit_length
    count, height, normal = fit(points, normals, labels, 1, at, scale)

    members = labels == 1
    n = unit(normals[members].sum(axis=0))
    u = unit(np.array([0, n[2], -n[1]]) if abs(n[0]) < 0.6 else np.array([-n[2], 0, n[0]]))
    v = np.cross(n, u)
    x, y, z = ((points[members] - at) @ np.column_stack([u, v, n]) / scale).T
    design = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y])
    # Half for u v: only so does the ridge, like the bending of a surface, not depend on the direction of u.
    ridge = np.sqrt(np.diag([0, *SLOPE_RIDGE * np.ones(2), *CURVATURE_RIDGE * np.array([1, 0.5, 1])]))
    c = np.linalg.lstsq(np.vstack([design, ridge]), np.r_[z, np.zeros(6)], rcond=None)[0]
    slope = n - c[1] * u - c[2] * v
    assert count == members.sum()
    np.testing.assert_allclose(normal, unit(slope), atol=1e-6)
    np.testing.assert_allclose(height, c[0] * scale / np.linalg.norm(slope), atol=1e-6 * scale)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_fit_turns_with_the_object(seed):
    points, normals, labels = patch_of_surface(seed)
    turn = Rotation.random(random_state=np.random.default_rng(seed + 1)).as_matrix()
    at = points[0] + 0.3
    count, height, normal = fit(points, normals, labels, 1, at)
    turned_count, turned_height, turned_normal = fit(points @ turn.T, normals @ turn.T, labels, 1, turn @ at)
    assert turned_count == count
    np.testing.assert_allclose(turned_normal, turn @ normal, atol=1e-9)
    np.testing.assert_allclose(turned_height, height, atol=1e-9)


def test_fit_needs_enough_points():
    points, normals, _ = patch_of_surface(0, 20)
    for n in range(MIN_FIT_POINTS + 2):
        labels = (np.arange(20) < n).astype(np.int32)
        assert fit(points, normals, labels, 1, points[0])[0] == (n if n >= MIN_FIT_POINTS else 0)


def test_fit_of_equal_or_lined_up_points_is_finite():
    normals = np.tile([0.0, 0.6, 0.8], (12, 1))
    labels = np.zeros(12, np.int32)
    for points in (np.ones((12, 3)), np.outer(np.arange(12.0), [1, 0, 0])):
        count, height, normal = fit(points, normals, labels, 0, points[0])
        assert count == 12 and height == pytest.approx(0.0, abs=1e-9)
        np.testing.assert_allclose(normal, [0, 0.6, 0.8], atol=1e-9)


def test_fit_of_normals_that_cancel_gives_none():
    points, _, _ = patch_of_surface(0, 20)
    normals = np.tile([[0.0, 0, 1], [0, 0, -1]], (10, 1))
    assert fit(points, normals, np.zeros(20, np.int32), 0, points[0])[0] == 0


@pytest.mark.parametrize("turn", [-120, -90, -60, -30, -5, 0, 5, 30, 60, 90, 120, 150])
def test_crease_angle_of_a_wedge(turn):
    assert angle_between(*wedge(np.radians(turn))) == pytest.approx(turn, abs=1.0)


def test_crease_angle_does_not_need_all_places():
    for max_places in (1, 3, 1000):
        assert angle_between(*wedge(np.radians(70)), max_places) == pytest.approx(70, abs=2.0)


@pytest.mark.parametrize("radius", [6.0, 8.0, 12.0, 30.0])
@pytest.mark.parametrize("make", [cylinder, ball])
def test_smooth_surface_has_no_crease(make, radius):
    points, normals = make(radius)
    for axis in range(2):
        labels = (points[:, axis] > np.median(points[:, axis]) + 0.2).astype(np.int32)
        assert abs(angle_between(points, normals, labels)) < 20.0 * 6.0 / radius


def test_border_without_surface_has_no_angle():
    points = np.array([[0.0, 0, 0], [1, 0, 0]])
    normals = np.tile([0.0, 0.0, 1.0], (2, 1))
    assert angle_between(points, normals, np.array([0, 1], np.int32)) == np.inf


@pytest.mark.parametrize("turn", [60, 90, -90, 110])
def test_jagged_border_moves_to_the_edge(turn):
    points, normals, truth = wedge(np.radians(turn), half=14)
    rng = np.random.default_rng(turn + 200)
    wave = 1.6 * np.sin(points[:, 1]) + rng.uniform(-0.5, 0.5, len(points))
    from_edge = np.where(truth == 1, 1, -1) * np.hypot(points[:, 0], points[:, 2])
    jagged = (from_edge > wave).astype(np.int32)
    assert (jagged != truth).sum() > 20
    # PCA normals near the edge know no better than the jagged border.
    neighbours = radius_neighbours(points, 3.0)
    blurred = unit(
        np.array(
            [normals[near].mean(axis=0) for near in np.split(neighbours.indices, neighbours.indptr[1:-1])]
        )
    )
    sharp = sharpen_borders(points, blurred, *adjacent(points), jagged, SCALE, 0.6, 6)
    wrong = sharp != truth
    assert wrong.sum() <= 0.2 * (jagged != truth).sum()
    assert np.abs(from_edge[wrong]).max(initial=0) < 0.8


def test_sharp_border_stays():
    points, normals, truth = wedge(np.radians(90), jitter=0.1)
    sharp = sharpen_borders(points, normals, *adjacent(points), truth, SCALE, 0.6, 3)
    np.testing.assert_array_equal(sharp, truth)


def test_voxels_without_a_region_stay_without():
    points, normals, labels = wedge(np.radians(90))
    labels[::7] = -1
    sharp = sharpen_borders(points, normals, *adjacent(points), labels, SCALE, 0.6, 3)
    np.testing.assert_array_equal(sharp == -1, labels == -1)
