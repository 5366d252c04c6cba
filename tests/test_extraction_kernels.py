"""Kernels of the extraction against slow ones and SciPy."""

import numpy as np
import pytest
from scipy import ndimage

from shapeconcepts.extraction.component_kernels import (
    connected_components,
    contacts,
    flying_pixels,
    grow_components,
    grow_downwards,
    hidden_sides,
    near_pairs,
    silhouettes,
)
from shapeconcepts.extraction.height_kernels import (
    block_sums,
    heights_above,
    in_lines,
    window_means,
)
from shapeconcepts.extraction.pixel_kernels import largest_coordinate, measured_points
from shapeconcepts.extraction.planar_cells_kernels import cell_moments, fit_planes


@pytest.fixture
def rng():
    return np.random.default_rng(0)


def test_components_are_those_of_scipy_where_no_jump_parts_them(rng):
    belongs = rng.random((40, 50)) < 0.6
    numbers, n = connected_components(
        belongs, np.ones(belongs.shape, np.float32), np.ones(belongs.shape, np.float32)
    )
    expected, n_expected = ndimage.label(belongs)
    assert n == n_expected
    assert np.array_equal(numbers, expected - 1)


def test_a_jump_parts_components():
    distances = np.array([[1.0, 1.0, 2.0, 2.0]], np.float32)
    numbers, n = connected_components(np.ones((1, 4), bool), distances, np.full((1, 4), 0.5, np.float32))
    assert n == 2
    assert numbers.tolist() == [[0, 0, 1, 1]]


def test_heights_are_above_the_plane_that_a_point_is_over():
    points = np.array([[(0.0, 0.0, 0.1), (0.65, 0.0, 0.0), (0.65, 0.0, 0.1), (0.9, 0.0, 0.0), (np.nan,) * 3]])
    plane = np.array([[0.0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0]])
    outline = np.array([(1.0, 0.0, -0.5), (-1.0, 0.0, -0.5), (0.0, 1.0, -0.5), (0.0, -1.0, -0.5)])
    viewpoint, starts = np.array([0.0, 0.0, 1.0]), np.array([0, 4])
    heights, noises, numbers = heights_above(
        points, viewpoint, plane, outline, starts, np.zeros((1, 6)), 0.02, 0.2, 1.0
    )
    # What is on the plane within 20 cm of its outline may be more of it.
    assert numbers.tolist() == [[0, -2, -1, -1, -1]]
    assert heights[0, 0] == pytest.approx(0.1)
    assert np.isnan(heights[0, 1:]).all()
    assert (noises[0, :4] > 0.0).all()


def test_window_means_are_plain_means(rng):
    values = rng.normal(size=(20, 23)).astype(np.float32)
    values[rng.random(values.shape) < 0.3] = np.nan
    limits = np.full(values.shape, 0.8, np.float32)
    means = window_means(values, limits, 2)
    for i, j in np.ndindex(values.shape):
        window = values[max(i - 2, 0) : i + 3, max(j - 2, 0) : j + 3]
        expected = np.nanmean(np.clip(window, -0.8, 0.8)) if np.isfinite(values[i, j]) else np.nan
        assert means[i, j] == pytest.approx(expected, abs=1e-5, nan_ok=True)


def test_blocks_are_summed_to_the_border(rng):
    values, counts = rng.normal(size=(10, 7)).astype(np.float32), rng.random((10, 7)) < 0.6
    sums, numbers = block_sums(values, counts, 4)
    assert sums.shape == numbers.shape == (3, 2)
    for row, column in np.ndindex(3, 2):
        block = (slice(4 * row, 4 * row + 4), slice(4 * column, 4 * column + 4))
        assert sums[row, column] == pytest.approx(values[block][counts[block]].sum(), abs=1e-5)
        assert numbers[row, column] == counts[block].sum()


def test_planes_of_cells_are_those_of_eigenvectors(rng):
    points = rng.normal(size=(16, 16, 3)) * (1.0, 0.7, 0.1) + (0.3, -0.2, 1.5)
    points[rng.random((16, 16)) < 0.2] = np.nan
    moments = cell_moments(points, 8)
    planes, thickness = fit_planes(moments.reshape(-1, 10))
    for cell, (plane, thick) in enumerate(zip(planes, thickness, strict=True)):
        row, column = divmod(cell, 2)
        own = points[8 * row : 8 * row + 8, 8 * column : 8 * column + 8].reshape(-1, 3)
        own = own[np.isfinite(own[:, 0])]
        values, vectors = np.linalg.eigh(np.cov(own.T, bias=True))
        assert moments[row, column, 0] == len(own)
        assert plane[:3] == pytest.approx(own.mean(axis=0))
        assert abs(plane[3:] @ vectors[:, 0]) == pytest.approx(1.0, abs=1e-6)
        assert thick == pytest.approx(np.sqrt(values[0]), rel=1e-6)


def test_points_between_surfaces_fly():
    distances = np.full((9, 9), 1.0, np.float32)
    distances[:, 5:] = 2.0
    distances[:, 4] = 1.5
    distances[0, 0] = np.nan
    flying = flying_pixels(distances, np.full((9, 9), 0.1, np.float32))
    assert flying[:, 4].all()
    assert not flying[:, 6:-1][1:-1].any()
    assert not flying[1:-1, 1:3].any()


def test_near_pairs_are_counted_both_ways(rng):
    numbers = rng.integers(-1, 4, (12, 13)).astype(np.int32)
    points = rng.random((12, 13, 3))
    counts = near_pairs(numbers, 4, points, np.full((12, 13), 0.5, np.float32), 2)
    expected = np.zeros((4, 4), int)
    pixels = list(np.ndindex(12, 13))
    for number, a in enumerate(pixels):
        for b in pixels[number + 1 :]:
            is_beside = abs(a[0] - b[0]) <= 2 and abs(a[1] - b[1]) <= 2
            if not is_beside or numbers[a] < 0 or numbers[b] < 0 or numbers[a] == numbers[b]:
                continue
            if np.linalg.norm(points[a] - points[b]) < 0.5:
                expected[numbers[a], numbers[b]] += 1
                expected[numbers[b], numbers[a]] += 1
    assert np.array_equal(counts, expected)


def test_contacts_count_sides():
    low = np.array([[0, 0, -1], [-1, 0, -1]], np.int32)
    high = np.array([[-1, -1, 0], [1, -1, 0]], np.int32)
    same = np.ones((2, 3), np.float32)
    counts, borders = contacts(low, 1, high, 2, same, same)
    assert counts.tolist() == [[2, 2]]
    assert borders.tolist() == [4]


def test_components_grow_by_so_many_pixels():
    numbers = np.full((1, 9), -1, np.int32)
    numbers[0, 0], numbers[0, 8] = 0, 1
    same = np.ones((1, 9), np.float32)
    may_grow = np.ones((1, 9), bool)
    may_grow[0, 6] = False
    grow_components(numbers, may_grow, same, same, 3)
    assert numbers.tolist() == [[0, 0, 0, 0, -1, -1, -1, 1, 1]]


def test_measured_points_are_taken_from_an_origin(rng):
    points = rng.normal(size=(50, 3))
    is_measured = rng.random(50) < 0.7
    expected = np.where(is_measured[:, None], points - (1.0, 2.0, 3.0), np.nan)
    np.testing.assert_array_equal(measured_points(points, is_measured, np.array([1.0, 2.0, 3.0])), expected)
    assert largest_coordinate(points, is_measured) == np.abs(points[is_measured]).max()


def test_what_is_straight_below_is_grown_into():
    points = np.zeros((4, 3, 3))
    # A wall in the left column, and a floor that leads away from its foot.
    points[:, 0, 2] = [0.4, 0.2, 0.0, -0.1]
    points[3, 1:, 0] = [0.1, 0.2]
    numbers = np.full((4, 3), -1, np.int32)
    numbers[0, 0] = 0
    may_grow = np.zeros((4, 3), bool)
    may_grow[:, 0] = may_grow[3] = True
    grow_downwards(numbers, may_grow, points, np.array([0.0, 0.0, 1.0]), np.full((4, 3), 0.05, np.float32))
    assert numbers[:, 0].tolist() == [0, 0, 0, 0]
    assert (numbers[:, 1:] == -1).all()


def test_sides_are_hidden_by_what_is_nearer():
    distances = np.array([[1.0], [2.0], [np.nan], [2.0], [1.0]], np.float32)
    numbers = np.array([[-1], [0], [-1], [1], [-1]], np.int32)
    jumps = np.full((5, 1), 0.1, np.float32)
    hidden, sides = hidden_sides(numbers, 2, distances, jumps, 1, 0)
    assert (hidden.tolist(), sides.tolist()) == ([0, 1], [1, 1])
    hidden, sides = hidden_sides(numbers, 2, distances, jumps, -1, 0)
    assert (hidden.tolist(), sides.tolist()) == ([1, 0], [1, 1])


def test_silhouettes_are_before_what_is_farther():
    # A part with something far to its left, nothing measured to its right, and its own surface below it.
    distances = np.full((4, 14), 2.0, np.float32)
    distances[:, 4:] = np.nan
    distances[1:3, 2:4] = 1.0
    distances[3, 2:4] = 1.05
    distances[0, 2:4] = 0.5
    numbers = np.full((4, 14), -1, np.int32)
    numbers[1:3, 2:4] = 0
    in_front, goes_on, sides = silhouettes(numbers, 1, distances, np.full((4, 14), 0.1, np.float32))
    assert (in_front.tolist(), goes_on.tolist(), sides.tolist()) == ([4], [2], [8])


def test_a_hole_without_measurements_is_no_border():
    distances = np.ones((3, 5), np.float32)
    distances[1, 2] = np.nan
    numbers = np.where(np.isnan(distances), -1, 0).astype(np.int32)
    _, _, sides = silhouettes(numbers, 1, distances, np.full((3, 5), 0.1, np.float32))
    assert sides.tolist() == [16]


def test_points_are_in_a_line_where_low_ones_go_on():
    smooth = np.zeros((20, 30), np.float32)
    smooth[10, 5:25] = 3.0
    smooth[3, 3] = 3.0
    low = np.ones(smooth.shape, np.float32)
    offsets = np.array([[(0, k) for k in range(5)], [(0, -k) for k in range(5)], [(k, 0) for k in range(5)]])
    found = in_lines(smooth, low, offsets, 2.0, 2.9, 4.0, 10.0)
    assert np.array_equal(np.argwhere(found), [(10, column) for column in range(5, 25)])
    # What is tall is no line, and one high place is not many.
    smooth[10, 15] = 20.0
    assert found.sum() - in_lines(smooth, low, offsets, 2.0, 2.9, 4.0, 10.0).sum() == 1
    smooth[3, 3] = 9.0
    assert not in_lines(smooth, low, offsets, 2.0, 2.9, 4.0, 10.0)[3].any()
