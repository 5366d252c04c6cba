"""FPFH against a slow version written from its definition.

The package computes in single precision: a pair that close to the border of a bin may fall to its other side.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from shapeconcepts.descriptors import FPFH, compute_fpfh
from shapeconcepts.segmentation.segmented_object import SegmentedObject


def pair_feature(p, n, q, m):
    """Theta, alpha, phi of two oriented points (Rusu 2009, equation 1), source by the smaller angle."""
    d = q - p
    distance = np.linalg.norm(d)
    if distance == 0:
        return 0.0, 0.0, 0.0
    d = d / distance
    if abs(n @ d) < abs(m @ d):
        p, n, q, m, d = q, m, p, n, -d
    v = np.cross(d, n)
    if np.linalg.norm(v) < 1e-6:
        return 0.0, 0.0, 0.0
    v = v / np.linalg.norm(v)
    w = np.cross(n, v)
    return math.atan2(w @ m, n @ m), v @ m, n @ d


def bin_of(value, low, high):
    return min(max(math.floor(11 * (value - low) / (high - low)), 0), 10)


def hangs_on_rounding(points, normals):
    """Whether single precision may decide otherwise on the source of a pair, its frame, or its bins."""
    for i in range(len(points)):
        for j in range(len(points)):
            d = points[j] - points[i]
            angles = abs(normals[i] @ d), abs(normals[j] @ d)
            if min(angles) > 0 and abs(angles[0] - angles[1]) < 1e-5 * np.linalg.norm(d):
                return True
            if max(angles) > (1 - 1e-5) * np.linalg.norm(d) > 0:
                return True
            theta, alpha, phi = pair_feature(points[i], normals[i], points[j], normals[j])
            for position in (
                11 * (theta + math.pi) / (2 * math.pi),
                11 * (alpha + 1) / 2,
                11 * (phi + 1) / 2,
            ):
                if 0 < round(position) < 11 and abs(position - round(position)) < 4e-5:
                    return True
    return False


def slow_fpfh(points, normals, radius):
    m = len(points)
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = [[j for j in range(m) if j != i and distances[i, j] <= radius] for i in range(m)]
    simplified = np.zeros((m, 33))
    for i in range(m):
        for j in near[i]:
            theta, alpha, phi = pair_feature(points[i], normals[i], points[j], normals[j])
            simplified[i, bin_of(theta, -math.pi, math.pi)] += 100 / len(near[i])
            simplified[i, 11 + bin_of(alpha, -1, 1)] += 100 / len(near[i])
            simplified[i, 22 + bin_of(phi, -1, 1)] += 100 / len(near[i])
    result = simplified.copy()
    for i in range(m):
        weights = {j: 1 / distances[i, j] ** 2 for j in near[i] if distances[i, j] > 0}
        for j, weight in weights.items():
            result[i] += weight / sum(weights.values()) * simplified[j]
    return result


def random_surface(seed, n):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 0.05, (n, 3))
    normals = rng.normal(size=(n, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.sampled_from([0.012, 0.03, 1.0]))
def test_agrees_with_slow_version(seed, n, radius):
    points, normals = random_surface(seed, n)
    points[::7] = points[0]
    normals[::5] = 0
    assume(not hangs_on_rounding(points, normals))
    np.testing.assert_allclose(
        compute_fpfh(points, normals, radius), slow_fpfh(points, normals, radius), rtol=1e-5, atol=1e-5
    )


def test_every_bin_is_reached():
    points, normals = random_surface(0, 120)
    found = compute_fpfh(points, normals, 0.03)
    np.testing.assert_allclose(found, slow_fpfh(points, normals, 0.03), rtol=1e-5, atol=1e-5)
    assert (found.sum(axis=0)[11:] > 0).all() and (found.sum(axis=0)[:11] > 0).all()
    np.testing.assert_allclose(found.reshape(-1, 3, 11).sum(axis=2), 200, rtol=1e-5)


def test_points_that_are_each_their_own_source():
    # Equal normals at equal angles to the connection: from either end, the other lies in the same direction.
    points = np.array([[0.0, 0, 0], [0.01, 0, 0]])
    normals = np.tile([0.6, 0.8, 0], (2, 1))
    found = compute_fpfh(points, normals, 0.03)
    np.testing.assert_allclose(found, slow_fpfh(points, normals, 0.03), rtol=1e-6)
    np.testing.assert_allclose(found[:, [22 + 2, 22 + 8]], 100, rtol=1e-6)


def test_flat_and_isolated_points():
    grid = np.stack(np.meshgrid(np.arange(6), np.arange(6), [0]), axis=-1).reshape(-1, 3) * 0.005
    points = np.vstack([grid, [[1, 1, 1]]])
    found = compute_fpfh(points, np.tile([0.0, 0, 1], (37, 1)), 0.02)
    expected = np.zeros(33)
    expected[[5, 16, 27]] = 200
    np.testing.assert_allclose(found[:-1], np.tile(expected, (36, 1)), rtol=1e-6)
    assert not found[-1].any()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 150))
def test_segments_sum_the_histograms_of_their_points(seed, n):
    points, normals = random_surface(seed, n)
    labels = np.random.default_rng(seed).integers(-1, 4, n).astype(np.int32)
    segmented = SegmentedObject(
        points, normals, labels, labels, np.empty((0, 2), np.int32), 4, np.arange(n, dtype=np.int32), 0.005
    )
    description = FPFH(0.02).describe(segmented)
    per_point = compute_fpfh(points, normals, 0.02)
    for mask in range(16):
        members = [i for i in range(n) if labels[i] >= 0 and mask >> labels[i] & 1]
        total = per_point[members].sum(axis=0)
        expected = total / total.sum() if total.any() else total
        np.testing.assert_allclose(description.histograms([mask])[0], expected, atol=1e-6)


def test_bad_input():
    points, normals = random_surface(0, 5)
    with pytest.raises(ValueError, match=r"normals must have the shape of points \(5, 3\), got \(4, 3\)"):
        compute_fpfh(points, normals[:4], 0.03)
    with pytest.raises(ValueError, match="radius must be a positive number, got inf"):
        compute_fpfh(points, normals, math.inf)
    with pytest.raises(ValueError, match=r"points must have shape \(m, 3\), got \(5, 2\)"):
        compute_fpfh(points[:, :2], normals[:, :2], 0.03)
