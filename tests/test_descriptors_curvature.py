"""Principal curvatures against known surfaces and a slow version, their histograms against pure Python.

The package computes in single precision.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts import Curvature, compute_principal_curvatures
from shapeconcepts.descriptors.curvature_kernels import curvature_histograms
from shapeconcepts.segmentation.segmented_object import SegmentedObject


def slow_curvatures(points, normals, radius):
    """Least squares for both rows of the Weingarten map; NaN where rounding decides whether it is fitted."""
    curvatures = np.zeros((len(points), 2))
    oriented = normals.any(axis=1)
    for i in np.flatnonzero(oriented):
        near = oriented & (np.linalg.norm(points - points[i], axis=1) <= radius)
        plane = np.linalg.svd(normals[[i]])[2][1:]
        offsets = (points[near] - points[i]) / radius @ plane.T
        offsets -= offsets.mean(axis=0)
        _, spread, _ = np.linalg.svd(offsets)
        ratio = np.prod(spread**2) / np.sum(spread**2) ** 2 if len(spread) == 2 and spread[0] > 0 else 0
        if near.sum() < 3 or ratio < 0.9e-3 or np.sum(spread**2) < 1e-11 * near.sum():
            continue
        if ratio < 1.1e-3 or np.sum(spread**2) < 1e-9 * near.sum():
            curvatures[i] = np.nan
            continue
        turns = normals[near] @ plane.T
        weingarten = np.linalg.lstsq(offsets, turns - turns.mean(axis=0), rcond=None)[0]
        curvatures[i] = np.linalg.eigvalsh((weingarten + weingarten.T) / 2)[::-1] / radius
    return curvatures


def slow_histogram(curvatures, size):
    """By the weights of a hat function around every place."""
    histogram = np.zeros(66)
    for pair in curvatures:
        places = [min(max(5 + 2 * math.asinh(2 * size * k), 0), 10) for k in pair]
        for i in range(11):
            for j in range(11):
                weight = math.prod(
                    max(1 - abs(place - p), 0) for place, p in zip(places, (i, j), strict=True)
                )
                a, b = max(i, j), min(i, j)
                histogram[a * (a + 1) // 2 + b] += weight
    return histogram


def random_surface(seed, n, bumpy=0.3):
    """Points on a sheet, with normals that are not quite across it."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 0.05, (n, 3)) * [1, 1, 0.2]
    normals = [0, 0, 1] + bumpy * rng.normal(size=(n, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def as_segmented(points, normals, labels, n_segments, voxel_size=0.005):
    labels = np.asarray(labels, np.int32)
    return SegmentedObject(
        points, normals, labels, labels, np.empty((0, 2), np.int32), n_segments,
        np.arange(len(labels), dtype=np.int32), voxel_size,
    )  # fmt: skip


def directions(n, seed=0):
    found = np.random.default_rng(seed).normal(size=(n, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def test_plane():
    rng = np.random.default_rng(0)
    turn = Rotation.random(random_state=1).as_matrix()
    points = np.c_[rng.uniform(size=(500, 2)), np.zeros(500)] @ turn.T
    found = compute_principal_curvatures(points, np.tile(turn[:, 2], (500, 1)), 0.2)
    np.testing.assert_allclose(found, 0, atol=1e-5)


@pytest.mark.parametrize("radius", [0.03, 0.4])
@pytest.mark.parametrize("side", [1, -1])
def test_sphere(radius, side):
    """The normals of a sphere turn in proportion to the way along it: the fit is exact."""
    normals = directions(2000)
    found = compute_principal_curvatures(radius * normals + 0.7, side * normals, radius / 3)
    np.testing.assert_allclose(found, side / radius, rtol=1e-4)


@pytest.mark.parametrize("side", [1, -1])
def test_cylinder(side):
    rng = np.random.default_rng(2)
    angles = rng.uniform(0, 2 * np.pi, 3000)
    normals = np.c_[np.cos(angles), np.sin(angles), np.zeros(3000)]
    points = 0.05 * normals + np.outer(rng.uniform(0, 0.2, 3000), [0, 0, 1])
    turn = Rotation.random(random_state=3).as_matrix()
    found = compute_principal_curvatures(points @ turn.T, side * normals @ turn.T, 0.02)
    # The larger first, whichever it is.
    np.testing.assert_allclose(found, np.tile([20, 0] if side > 0 else [0, -20], (3000, 1)), atol=1e-3)


def test_saddle():
    """z = (a x^2 + b y^2) / 2 has the curvatures -a and -b at 0, where z is along the normal."""
    rng = np.random.default_rng(4)
    x, y = rng.uniform(-0.01, 0.01, (2, 4000))
    x[0] = y[0] = 0
    normals = np.c_[-4 * x, 7 * y, np.ones(4000)]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = np.c_[x, y, 2 * x**2 - 3.5 * y**2]
    np.testing.assert_allclose(compute_principal_curvatures(points, normals, 0.008)[0], [7, -4], rtol=5e-3)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 120), st.sampled_from([0.004, 0.012, 0.03, 1.0]))
def test_agrees_with_least_squares(seed, n, radius):
    points, normals = random_surface(seed, n)
    points[::7] = points[0]
    normals[::5] = 0
    expected = slow_curvatures(points, normals, radius)
    found = compute_principal_curvatures(points, normals, radius)
    known = ~np.isnan(expected[:, 0])
    scale = 1 / (0.02 * min(radius, 0.05))
    np.testing.assert_allclose(found[known], expected[known], rtol=1e-3, atol=1e-5 * scale)
    assert np.isfinite(found).all() and (found[:, 0] >= found[:, 1]).all()
    assert not found[::5].any()


def test_examples_are_worth_comparing():
    points, normals = random_surface(0, 120)
    found, expected = (f(points, normals, 0.012) for f in (compute_principal_curvatures, slow_curvatures))
    assert (np.abs(found).max(axis=1) > 5).mean() > 0.8 and not np.isnan(expected).all(axis=1).any()
    assert (found.prod(axis=1) < 0).any() and (found.prod(axis=1) > 0).any()


def test_points_without_normal_are_no_neighbours():
    """They know nothing of the surface: what they are not is flat."""
    normals = directions(800)
    unknown = np.random.default_rng(1).random(800) < 0.5
    found = compute_principal_curvatures(normals, np.where(unknown[:, None], 0, normals), 0.4)
    np.testing.assert_allclose(found[~unknown], 1, rtol=1e-4)
    assert not found[unknown].any()


LINE = np.outer(np.arange(30), [0.004, 0.002, 0.001])
TILTED = np.array([0.6, 0.48, 0.64])


@pytest.mark.parametrize(
    ("points", "normals"),
    [
        (np.empty((0, 3)), np.empty((0, 3))),
        (np.ones((1, 3)), TILTED[None]),
        (np.full((30, 3), 0.7), directions(30)),
        (LINE, directions(30)),
        (np.outer(np.arange(30), 0.003 * TILTED), np.tile(TILTED, (30, 1))),
        (np.random.default_rng(0).uniform(size=(30, 3)) * 1e6, directions(30)),
        (directions(30) / 50, np.zeros((30, 3))),
        (np.repeat([[0.1, 0.2, 0.3], [0.11, 0.2, 0.3]], 15, axis=0), directions(30)),
    ],
    ids=[
        "empty", "one", "duplicates", "line", "along the normal", "far apart", "no normals", "two places",
    ],
)  # fmt: skip
def test_nothing_known_is_flat(points, normals):
    assert not compute_principal_curvatures(points, normals, 0.02).any()


@pytest.mark.parametrize("radius", [1e-300, 1e-12, 1e12, 1e300])
def test_extreme_radii(radius):
    points, normals = random_surface(5, 50)
    assert np.isfinite(compute_principal_curvatures(points, normals, radius)).all()


@pytest.mark.parametrize("distance", 10.0 ** np.arange(-30, 0, 3))
def test_points_that_nearly_coincide(distance):
    points, normals = random_surface(6, 50)
    found = compute_principal_curvatures(points * distance, normals, 0.02)
    assert np.isfinite(found).all() and np.isfinite(np.square(found)).all()


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 60), st.integers(0, 4))
def test_histograms_against_pure_python(seed, n, n_segments):
    rng = np.random.default_rng(seed)
    curvatures = -np.sort(-rng.normal(size=(n, 2)) * 10.0 ** rng.integers(-3, 3, (n, 1)), axis=1)
    labels = rng.integers(-1, n_segments, n).astype(np.int32)
    found = curvature_histograms(curvatures, labels, n_segments)
    assert found.shape == (n_segments, 66)
    for segment in range(n_segments):
        expected = slow_histogram(curvatures[labels == segment].tolist(), 1)
        np.testing.assert_allclose(found[segment], expected, atol=1e-12)
        np.testing.assert_allclose(found[segment].sum(), (labels == segment).sum())


@pytest.mark.parametrize(
    ("pair", "bins"),
    [
        ((0, 0), {20: 1}),
        ((math.inf, -math.inf), {55: 1}),
        ((math.inf, math.inf), {65: 1}),
        ((-1e9, -1e9), {0: 1}),
        ((math.sinh(0.5) / 2, 0), {26: 1}),
        # Half on the way to the next place on both scales.
        ((math.sinh(0.25) / 2, math.sinh(0.25) / 2), {20: 0.25, 26: 0.5, 27: 0.25}),
    ],
)
def test_places(pair, bins):
    found = curvature_histograms(np.array([pair], float), np.zeros(1, np.int32), 1)[0]
    expected = np.zeros(66)
    expected[list(bins)] = list(bins.values())
    np.testing.assert_allclose(found, expected, atol=1e-12)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 150), st.sampled_from([0.0001, 0.3, 0.8, 1000.0]))
def test_segments_hold_the_histograms_of_their_points(seed, n, share):
    points, normals = random_surface(seed, n)
    labels = np.random.default_rng(seed).integers(-1, 4, n)
    masses = Curvature(share).describe(as_segmented(points, normals, labels, 4)).segment_histograms
    np.testing.assert_allclose(masses.sum(axis=1), np.bincount(labels[labels >= 0], minlength=4))
    # Neighbours count whatever segment they are in; the size is that of what is in segments, and its share
    # is the radius from 2 to 6 voxels.
    inside = points[labels >= 0]
    size = math.sqrt(((inside - inside.mean(axis=0)) ** 2).sum(axis=1).mean()) if len(inside) else 0
    curvatures = compute_principal_curvatures(points, normals, min(max(share * size, 0.01), 0.03))
    for segment in range(4):
        expected = slow_histogram(curvatures[labels == segment].tolist(), size)
        np.testing.assert_allclose(masses[segment], expected, atol=1e-9)


def test_a_ball_is_one_pair_of_curvatures():
    """Of any size; seen from inside, it is a bowl."""
    normals = directions(1500)
    normals = np.concatenate([normals, -normals])
    for size in (0.02, 3.0):
        for side in (1, -1):
            ball = as_segmented(size * normals, side * normals, np.zeros(3000), 1, size / 12)
            found = Curvature(1 / 3).describe(ball).segment_histograms[0]
            np.testing.assert_allclose(found, slow_histogram([[side, side]] * 3000, 1), atol=0.05)


@pytest.mark.parametrize("scale", [1.0, 0.01, 300.0])
def test_motion_and_scale_do_not_matter(scale):
    points, normals = random_surface(7, 600)
    labels = np.arange(600) % 3 - 1
    turn = Rotation.random(random_state=8).as_matrix()
    voxel_size = 0.002 * scale
    moved = as_segmented(scale * (points @ turn.T + [0.4, -1, 2]), normals @ turn.T, labels, 2, voxel_size)
    before = Curvature().describe(as_segmented(points, normals, labels, 2, 0.002)).segment_histograms
    after = Curvature().describe(moved).segment_histograms
    np.testing.assert_allclose(after, before, atol=2e-3)


def test_again_is_the_same_to_the_last_bit():
    points, normals = random_surface(9, 500)
    first, second = (compute_principal_curvatures(points, normals, 0.01) for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_no_point_in_a_segment():
    points, normals = random_surface(0, 20)
    description = Curvature().describe(as_segmented(points, normals, np.full(20, -1), 2))
    assert description.segment_histograms.shape == (2, 66) and not description.segment_histograms.any()


def test_bad_input():
    points, normals = random_surface(0, 5)
    with pytest.raises(ValueError, match=r"normals must have the shape of points \(5, 3\), got \(4, 3\)"):
        compute_principal_curvatures(points, normals[:4], 0.03)
    for radius in (0, -1, math.nan, math.inf):
        with pytest.raises(ValueError, match=f"radius must be a positive number, got {radius}"):
            compute_principal_curvatures(points, normals, radius)
    with pytest.raises(ValueError, match="radius must be a positive number, got 0"):
        compute_principal_curvatures(points, 0 * normals, 0)
    for share in (0, -1, math.nan, math.inf):
        with pytest.raises(
            ValueError, match=f"'radius' parameter of Curvature must be a float .* Got {share}"
        ):
            Curvature(share).describe(as_segmented(points, normals, np.zeros(5), 1))
    with pytest.raises(ValueError, match=r"points must have shape \(m, 3\), got \(5, 2\)"):
        compute_principal_curvatures(points[:, :2], normals[:, :2], 0.03)
    with pytest.raises(ValueError, match="points must be finite"):
        compute_principal_curvatures(points * np.nan, normals, 0.03)
    with pytest.raises(ValueError, match="normals must be unit vectors"):
        compute_principal_curvatures(points, 2 * normals, 0.03)
