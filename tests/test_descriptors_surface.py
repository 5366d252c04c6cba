"""Normals fitted within a radius, against NumPy's eigenvectors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts.geometry.surface import normals_within


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def slow_normals(points, normals, radius):
    """The given ones where less than four points are near; NaN where rounding decides about the direction."""
    fitted = normals.copy()
    for i in range(len(points)):
        near = points[np.linalg.norm(points - points[i], axis=1) <= radius]
        if len(near) < 4 or not normals[i].any():
            continue
        variances, axes = np.linalg.eigh(np.cov(near.T))
        side = axes[:, 0] @ normals[i]
        is_clear = variances[1] - variances[0] > 0.05 * variances[2] and abs(side) > 1e-3
        fitted[i] = np.sign(side) * axes[:, 0] if is_clear else np.nan
    return fitted


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 150), st.sampled_from([0.006, 0.02, 0.05]))
def test_agrees_with_eigenvectors(seed, n, radius):
    rng = np.random.default_rng(seed)
    points = (
        rng.uniform(0, 0.08, (n, 3)) * [1, 1, 0.1] @ Rotation.random(random_state=seed % 1000).as_matrix()
    )
    points[::9] = points[:1]
    normals = unit(rng.normal(size=(n, 3)))
    normals[::7] = 0
    expected = slow_normals(points, normals, radius)
    found = normals_within(points, normals, radius)
    known = ~np.isnan(expected).any(axis=1)
    np.testing.assert_allclose(found[known], expected[known], atol=2e-4)
    assert not found[::7].any()
    np.testing.assert_allclose(np.linalg.norm(found[normals.any(axis=1)], axis=1), 1)
    assert (np.einsum("ij,ij->i", found, normals) >= 0).all()


def test_examples_are_worth_comparing():
    rng = np.random.default_rng(0)
    points, normals = rng.uniform(0, 0.08, (150, 3)) * [1, 1, 0.1], unit(rng.normal(size=(150, 3)))
    expected = slow_normals(points, normals, 0.02)
    assert (~np.isnan(expected).any(axis=1) & (expected != normals).any(axis=1)).mean() > 0.5


def test_fitting_again_changes_nothing():
    rng = np.random.default_rng(1)
    points, normals = rng.uniform(0, 0.08, (300, 3)) * [1, 1, 0.1], unit(rng.normal(size=(300, 3)))
    once = normals_within(points, normals, 0.02)
    np.testing.assert_array_equal(normals_within(points, once, 0.02), once)


def test_a_plane_and_its_sparse_half_have_the_same_normals():
    rng = np.random.default_rng(2)
    axes = Rotation.random(random_state=3).as_matrix()
    points = np.c_[rng.uniform(0, 0.1, (2000, 2)), np.zeros(2000)] @ axes.T
    normals = unit(axes[:, 2] + 0.1 * rng.normal(size=(2000, 3)))
    for half in (slice(None), slice(None, None, 2)):
        found = normals_within(points[half], normals[half], 0.02)
        np.testing.assert_allclose(found, np.tile(axes[:, 2], (len(found), 1)), atol=1e-5)


@pytest.mark.parametrize(
    "points",
    [
        np.empty((0, 3)),
        np.ones((1, 3)),
        np.full((20, 3), 0.3),
        np.outer(np.arange(20), [0.004, 0.002, 0.001]),
        np.random.default_rng(0).uniform(size=(20, 3)) * 1e6,
    ],
    ids=["empty", "one", "duplicates", "line", "far apart"],
)
def test_degenerate(points):
    normals = unit(np.random.default_rng(1).normal(size=(len(points), 3)))
    found = normals_within(points, normals, 0.02)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1)
    assert (np.einsum("ij,ij->i", found, normals) >= 0).all()


def test_bad_input():
    points, normals = np.zeros((3, 3)), np.tile([0.0, 0, 1], (3, 1))
    points[1, 2] = np.nan
    with pytest.raises(ValueError, match=r"points must be finite, got \[0.0, 0.0, nan\] at row 1"):
        normals_within(points, normals, 0.02)
    with pytest.raises(ValueError, match=r"normals must be unit vectors \(or zero\), got .* at row 0"):
        normals_within(np.zeros((3, 3)), 2 * normals, 0.02)
    with pytest.raises(ValueError, match="radius must be a positive number, got 0"):
        normals_within(np.zeros((3, 3)), normals, 0)
