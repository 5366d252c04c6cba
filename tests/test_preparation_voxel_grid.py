"""Voxel grid, canonical frame and adaptive leaf against a slow dictionary version."""

from collections import defaultdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts.geometry.canonical_frame import canonical_coordinates
from shapeconcepts.preparation.voxel_grid import adaptive_voxel_grid, voxel_grid

seeds = st.integers(0, 2**32 - 1)


def lopsided_cloud(seed: int, n: int = 300) -> np.ndarray:
    """Random points whose principal axes and skewness are unmistakable."""
    return np.random.default_rng(seed).exponential([0.2, 0.09, 0.03], (n, 3))


def slow_frame(points: np.ndarray) -> np.ndarray:
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    coordinates = centred @ axes.T
    return coordinates * np.sign((coordinates**3).sum(axis=0))


def slow_cells(coordinates: np.ndarray, size: float) -> dict[tuple[int, ...], list[int]]:
    cells = defaultdict(list)
    for i, row in enumerate(coordinates):
        cells[tuple(round(x / size) for x in row)].append(i)
    return cells


def assert_same_grid(grid, points: np.ndarray, cells: dict[tuple[int, ...], list[int]]) -> None:
    assert grid.point_to_voxel.dtype == np.int32 and grid.points.dtype == np.float64
    assert len(grid.points) == len(cells)
    scale = np.abs(points).max() + 1e-300
    for voxel, cell in enumerate(sorted(cells)):
        assert np.flatnonzero(grid.point_to_voxel == voxel).tolist() == cells[cell]
        np.testing.assert_allclose(grid.points[voxel], points[cells[cell]].mean(axis=0), atol=1e-13 * scale)


def patch(spacing: float, side: float = 0.2) -> np.ndarray:
    """A bent sheet of points, so many metres apart."""
    x, y = np.meshgrid(np.arange(0, side, spacing), np.arange(0, 0.8 * side, spacing))
    return np.column_stack([x.ravel(), y.ravel(), 2.0 * x.ravel() ** 2])


def rigid(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return Rotation.random(random_state=rng).as_matrix(), rng.uniform(-2, 2, 3)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(3, 300), st.floats(0.002, 0.5))
def test_agrees_with_dictionary(seed, n, size):
    points = lopsided_cloud(seed, n)
    assert_same_grid(voxel_grid(points, size), points, slow_cells(slow_frame(points), size))


@settings(max_examples=40, deadline=None)
@given(seeds, st.sampled_from([0, 1, 2, 3]), st.floats(-9, 8))
def test_agrees_with_dictionary_on_flat_and_lined_up_and_equal_points(seed, rank, exponent):
    rng = np.random.default_rng(seed)
    points = 10.0**exponent * np.hstack([rng.integers(-4, 5, (50, rank)), np.full((50, 3 - rank), 3.0)])
    size = 1.37 * 10.0**exponent
    assert_same_grid(voxel_grid(points, size), points, slow_cells(canonical_coordinates(points), size))


@pytest.mark.parametrize("size", [1e-6, 1e-8, 1e-12])
def test_cells_that_no_integer_can_number(size):
    points = lopsided_cloud(5) * [1e3, 1e3, 1e3]
    points = np.vstack([points, points])
    grid = voxel_grid(points, size)
    assert_same_grid(grid, points, slow_cells(slow_frame(points), size))
    assert len(grid.points) == 300


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_canonical_frame_agrees_with_singular_vectors(seed):
    points = lopsided_cloud(seed)
    np.testing.assert_allclose(canonical_coordinates(points), slow_frame(points), atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(0.01, 0.1))
def test_rigid_motion_and_order_leave_the_cells(seed, size):
    points = lopsided_cloud(seed)
    rotation, shift = rigid(seed)
    order = np.random.default_rng(seed + 1).permutation(len(points))
    still = voxel_grid(points, size)
    moved = voxel_grid((points @ rotation.T + shift)[order], size)
    np.testing.assert_array_equal(moved.point_to_voxel, still.point_to_voxel[order])
    np.testing.assert_allclose(moved.points, still.points @ rotation.T + shift, atol=1e-13)


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_rigid_motion_and_order_leave_the_adaptive_cells(seed):
    points = lopsided_cloud(seed)
    rotation, shift = rigid(seed)
    order = np.random.default_rng(seed + 1).permutation(len(points))
    still = adaptive_voxel_grid(points)
    moved = adaptive_voxel_grid((points @ rotation.T + shift)[order])
    assert moved.voxel_size == pytest.approx(still.voxel_size)
    np.testing.assert_array_equal(moved.point_to_voxel, still.point_to_voxel[order])


@pytest.mark.parametrize("spacing", [0.0007, 0.0013, 0.0022])
def test_leaf_is_5_mm_at_the_density_of_a_near_kinect(spacing):
    assert adaptive_voxel_grid(patch(spacing)).voxel_size == 0.005


@pytest.mark.parametrize("spacing", [0.004, 0.008, 0.012])
def test_leaf_grows_for_sparse_clouds(spacing):
    points = patch(spacing)
    grid = adaptive_voxel_grid(points)
    assert 1.2 * spacing < grid.voxel_size < 3.0 * spacing
    assert 0.9 * 3.5 <= len(points) / len(grid.points) < 8.0
    assert_same_grid(grid, points, slow_cells(slow_frame(points), grid.voxel_size))


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e8])
def test_leaf_follows_the_unit(unit):
    points = lopsided_cloud(2, 20000)
    grid = adaptive_voxel_grid(unit * points)
    low, high = np.quantile(slow_frame(unit * points), [0.02, 0.98], axis=0)
    extent = np.linalg.norm(high - low)
    assert 0.99 * extent / 60 <= grid.voxel_size * (1 + 1e-12) <= extent / 5
    assert len(points) / len(grid.points) >= 0.9 * 3.5
    assert len(grid.points) > 100


@pytest.mark.parametrize("offset", [0.0, 1e-9, 1.0, 1e8])
@pytest.mark.parametrize("n", [1, 2, 40])
def test_points_all_alike(offset, n):
    points = np.full((n, 3), offset)
    grid = adaptive_voxel_grid(points)
    np.testing.assert_allclose(grid.points, [[offset] * 3])
    assert grid.point_to_voxel.tolist() == [0] * n
    assert grid.voxel_size == 0.005


@pytest.mark.parametrize("distance", [1e-9, 1.0, 1e8])
def test_two_points_become_two_voxels(distance):
    points = np.array([[0.0, 0, 0], [0, distance, 0]])
    grid = adaptive_voxel_grid(points)
    assert len(grid.points) == 2 and sorted(grid.point_to_voxel.tolist()) == [0, 1]
    assert 0 < grid.voxel_size < distance
    np.testing.assert_allclose(grid.points[grid.point_to_voxel], points, atol=1e-12 * distance)
