"""Normals of neighbourhoods against NumPy's eigenvalue decomposition."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.geometry.normal_kernels import principal_component_normals, smallest_eigenvectors

seeds = st.integers(0, 2**32 - 1)


def normal_of(matrix: np.ndarray) -> np.ndarray:
    upper = matrix[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    return smallest_eigenvectors(upper[:, None].copy())[0]


def assert_smallest(matrix: np.ndarray, tolerance: float = 1e-7) -> None:
    normal = normal_of(matrix)
    values = np.linalg.eigvalsh(matrix)
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
    # Unlike the vector itself, its Rayleigh quotient is defined where eigenvalues coincide.
    excess = (normal @ matrix @ normal - values[0]) / max(np.abs(values).max(), 1e-300)
    assert excess < tolerance


def with_spectrum(seed: int, spectrum: list[float]) -> np.ndarray:
    axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    matrix = axes @ np.diag(spectrum) @ axes.T
    return (matrix + matrix.T) / 2


@settings(max_examples=300, deadline=None)
@given(hnp.arrays(np.float64, (5, 3), elements=st.floats(-1, 1, width=32)), st.floats(-9, 9))
@example(np.array([[0.625, 0.0703125, 0], [0.00179187, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]), 0.0)
def test_scatter_of_any_points(offsets, exponent):
    offsets = 10.0**exponent * offsets
    assert_smallest(offsets.T @ offsets)


@settings(max_examples=300, deadline=None)
@given(seeds, st.floats(0, 0.9), st.floats(0.95, 1), st.floats(-18, 18))
def test_separate_eigenvalue_gives_the_eigenvector(seed, smallest, middle, exponent):
    matrix = 10.0**exponent * with_spectrum(seed, [smallest, middle, 1.0])
    expected = np.linalg.eigh(matrix)[1][:, 0]
    assert abs(normal_of(matrix) @ expected) > 1 - 1e-12


@settings(max_examples=100, deadline=None)
@given(seeds, st.floats(-18, 18))
def test_points_on_a_line_get_a_perpendicular(seed, exponent):
    direction = np.random.default_rng(seed).normal(size=3)
    direction /= np.linalg.norm(direction)
    normal = normal_of(10.0**exponent * np.outer(direction, direction))
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
    assert abs(normal @ direction) < 1e-6


@pytest.mark.parametrize("axis", range(3))
def test_points_on_a_coordinate_axis(axis):
    direction = np.eye(3)[axis]
    normal = normal_of(np.outer(direction, direction))
    assert np.linalg.norm(normal) == 1.0 and normal[axis] == 0.0


@settings(max_examples=100, deadline=None)
@given(seeds, st.floats(-1e-9, 1e-9), st.floats(-18, 18))
def test_nearly_equal_small_eigenvalues(seed, gap, exponent):
    assert_smallest(10.0**exponent * with_spectrum(seed, [0.2, 0.2 + gap, 1.0]))


@pytest.mark.parametrize("scale", [0.0, 1e-300, 1e-20, 1.0, 1e20])
def test_isotropic_matrix_gives_z(scale):
    assert normal_of(scale * np.eye(3)).tolist() == [0.0, 0.0, 1.0]


@settings(max_examples=20, deadline=None)
@given(seeds, st.sampled_from([1e-6, 1.0, 1e6]))
def test_normals_agree_with_decomposition_point_by_point(seed, unit):
    rng = np.random.default_rng(seed)
    flat = rng.uniform(-1, 1, (200, 2))
    points = unit * (
        np.column_stack([flat, 0.4 * flat[:, 0] ** 2 - 0.3 * flat[:, 1]]) + rng.uniform(-5, 5, 3)
    )
    neighbours = radius_neighbours(points, 0.35 * unit)
    normals = principal_component_normals(points, *neighbours)
    assert normals.shape == points.shape and normals.dtype == np.float64
    for i in range(len(points)):
        members = [i, *neighbours.indices[neighbours.indptr[i] : neighbours.indptr[i + 1]]]
        values, vectors = np.linalg.eigh(np.cov(points[members].T, bias=True))
        if len(members) > 3 and values[1] > 5 * values[0]:
            assert abs(normals[i] @ vectors[:, 0]) > 1 - 1e-8
        assert np.linalg.norm(normals[i]) == pytest.approx(1.0, abs=1e-12)


def test_exact_plane_has_its_normal_everywhere():
    x, y = np.meshgrid(np.arange(9.0), np.arange(8.0))
    points = np.column_stack([x.ravel(), y.ravel(), 0.5 * x.ravel() - 2 * y.ravel() + 100])
    normals = principal_component_normals(points, *radius_neighbours(points, 4.0))
    expected = np.array([-0.5, 2, 1]) / np.sqrt(5.25)
    np.testing.assert_allclose(np.abs(normals @ expected), 1.0, atol=1e-12)


def test_lonely_point_gets_a_unit_normal():
    points = np.array([[0.0, 0, 0], [9, 9, 9]])
    normals = principal_component_normals(points, *radius_neighbours(points, 1.0))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
