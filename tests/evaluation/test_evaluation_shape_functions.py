"""Ensemble of Shape Functions, against a slow reference."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy

from shapeconcepts.evaluation import ensemble_of_shape_functions
from shapeconcepts.evaluation.ensemble_of_shape_functions_kernels import (
    occupied_voxels,
    random_index,
    shape_functions,
    trace,
)
from shapeconcepts.topology import jensen_shannon_divergences

MASK = (1 << 64) - 1


def splitmix(counter: int) -> int:
    z = counter * 0x9E3779B97F4A7C15 & MASK
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 & MASK
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB & MASK
    return z ^ (z >> 31)


def line(start: np.ndarray, end: np.ndarray) -> list[tuple[int, ...]]:
    n_steps = int(np.abs(end - start).max())
    return [
        tuple(
            math.floor(a + (b - a) * k / n_steps + 0.5) if n_steps else int(a)
            for a, b in zip(start, end, strict=True)
        )
        for k in range(n_steps + 1)
    ]


def slow_shape_functions(points, voxels, n_triples, smallest_area) -> np.ndarray:
    occupied = {
        (x + i, y + j, z + k)
        for x, y, z in voxels.tolist()
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
        for k in (-1, 0, 1)
    }
    histograms = np.zeros((10, 64))
    areas, sides = [], []
    trial = 0
    while len(areas) < n_triples:
        p = [(splitmix(3 * trial + corner + 1) >> 32) * len(points) >> 32 for corner in range(3)]
        trial += 1
        edges = [(p[1], p[2]), (p[2], p[0]), (p[0], p[1])]
        area = np.linalg.norm(np.cross(points[p[1]] - points[p[0]], points[p[2]] - points[p[0]])) / 2
        if area <= smallest_area:
            continue
        lines = [line(voxels[a], voxels[b]) for a, b in edges]
        inside = [sum(voxel in occupied for voxel in one) for one in lines]
        for (a, b), voxels_of, n in zip(edges, lines, inside, strict=True):
            kind = 0 if n >= len(voxels_of) - 1 else 1 if n <= 7 else 2
            sides.append((6 + kind, np.linalg.norm(points[a] - points[b])))
            if kind == 2:
                histograms[9, round(63 * n / len(voxels_of))] += 1
        total = sum(map(len, lines))
        kind = 1 if sum(inside) <= 21 else 0 if total - sum(inside) < 4 else 2
        areas.append((3 + kind, math.sqrt(area)))
        for corner in range(3):
            one = points[p[(corner + 1) % 3]] - points[p[corner]]
            other = points[p[(corner + 2) % 3]] - points[p[corner]]
            angle = math.acos(min(1, abs(one @ other) / np.linalg.norm(one) / np.linalg.norm(other)))
            histograms[kind, round(63 * angle / (math.pi / 2))] += len(lines[corner]) / 32
    for of_kind in (areas, sides):
        largest = max(value for _, value in of_kind)
        for row, value in of_kind:
            histograms[row, round(63 * value / largest)] += 1
    return histograms


def ball(rng: np.random.Generator, n: int = 600) -> np.ndarray:
    points = rng.normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def box(rng: np.random.Generator, n: int = 600) -> np.ndarray:
    points = rng.uniform(-1, 1, (n, 3))
    points[np.arange(n), rng.integers(0, 3, n)] = rng.choice([-1, 1], n)
    return points * [1, 0.8, 0.5]


def test_kernel_is_the_slow_reference() -> None:
    points = box(np.random.default_rng(0), 200) * 18
    voxels = np.floor(points + 32).astype(np.int64)
    fast = shape_functions(points, voxels, 300, 0.03)
    slow = slow_shape_functions(points, voxels, 300, 0.03)
    # A value on the border of two bins may fall to either side.
    assert np.abs(fast - slow).sum() < 0.005 * slow.sum()
    assert fast.sum(axis=1) == pytest.approx(slow.sum(axis=1))
    assert (fast.sum(axis=1) > 0).sum() >= 8


def test_random_numbers_are_splitmix_and_even() -> None:
    drawn = np.array([random_index(counter, 10) for counter in range(5000)])
    assert drawn.tolist() == [(splitmix(counter) >> 32) * 10 >> 32 for counter in range(5000)]
    assert np.bincount(drawn).min() > 420


def test_lines_run_from_end_to_end() -> None:
    occupied = occupied_voxels(np.array([[5, 5, 5], [63, 0, 5]]))
    assert occupied.sum() == 27 + 2 * 2 * 3
    assert trace(occupied, np.array([5, 5, 5]), np.array([5, 5, 5])) == (1, 1)
    assert trace(occupied, np.array([5, 5, 5]), np.array([15, 5, 5])) == (11, 2)
    assert trace(occupied, np.array([15, 5, 5]), np.array([5, 5, 5])) == (11, 2)


def test_pose_size_and_order_do_not_matter() -> None:
    rng = np.random.default_rng(1)
    points = box(rng) + np.array([0.1, 0.2, 3])
    histogram = ensemble_of_shape_functions(points)
    assert histogram.shape == (640,)
    assert histogram.sum() == pytest.approx(1)
    assert np.array_equal(histogram, ensemble_of_shape_functions(points[rng.permutation(len(points))]))
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    moved = ensemble_of_shape_functions(points @ rotation.T * 7.3 + [1, -2, 5])
    assert jensen_shannon_divergences([histogram], [moved])[0, 0] < 0.02


def test_shapes_differ_more_than_views_of_one() -> None:
    rng = np.random.default_rng(2)
    balls, boxes = ([ensemble_of_shape_functions(make(rng)) for _ in range(3)] for make in (ball, box))
    within = jensen_shannon_divergences(balls, balls)[np.triu_indices(3, 1)].max()
    assert jensen_shannon_divergences(balls, boxes).min() > 2 * within


@settings(deadline=None, max_examples=25)
@given(st_numpy.arrays(float, st.tuples(st.integers(0, 6), st.just(3)), elements=st.integers(-2, 2)))
def test_any_points_give_a_histogram(points) -> None:
    histogram = ensemble_of_shape_functions(points)
    assert (histogram >= 0).all()
    spans_a_triangle = len(points) > 2 and np.linalg.matrix_rank(points - points[0]) >= 2
    assert histogram.sum() == pytest.approx(float(spans_a_triangle))


@pytest.mark.parametrize(
    ("points", "message"),
    [(np.zeros((4, 2)), r"shape \(m, 3\), got \(4, 2\)"), (np.full((4, 3), np.nan), "must be finite")],
)
def test_unsuitable_points_are_refused(points, message) -> None:
    with pytest.raises(ValueError, match=message):
        ensemble_of_shape_functions(points)
