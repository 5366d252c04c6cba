"""Point-NN, against a slow version without arrays."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy

from shapeconcepts.evaluation import point_nn
from shapeconcepts.evaluation.point_nn import farthest_points, position_encoding


def waves(position: list[float], width: int) -> list[float]:
    """Every axis by itself: sine and cosine of each wave in turn."""
    n = width // 6
    return [
        wave(100 * coordinate / 1000 ** (i / n))
        for coordinate in position
        for i in range(n)
        for wave in (math.sin, math.cos)
    ]


def minus(one: list[float], other: list[float]) -> list[float]:
    return [a - b for a, b in zip(one, other, strict=True)]


def squared(one: list[float], other: list[float]) -> float:
    return sum(d * d for d in minus(one, other))


def deviation(numbers: list[float]) -> float:
    mean = sum(numbers) / len(numbers)
    return math.sqrt(sum((one - mean) ** 2 for one in numbers) / (len(numbers) - 1)) + 1e-5


def sample(points: list[list[float]], n: int) -> list[int]:
    chosen = [max(range(len(points)), key=lambda i: squared(points[i], [0, 0, 0]))]
    while len(chosen) < min(n, len(points)):
        left = [i for i in range(len(points)) if i not in chosen]
        chosen.append(max(left, key=lambda i: min(squared(points[i], points[j]) for j in chosen)))
    return chosen


def pooled(rows: list[list[float]]) -> list[float]:
    return [max(column) + sum(column) / len(column) for column in zip(*rows, strict=True)]


def slow_features(points: list[list[float]], n_points: int, n_stages: int, width: int, k: int) -> list[float]:
    points = [points[i] for i in sample(points, n_points)]
    features = [waves(point, width) for point in points]
    for _ in range(n_stages):
        centres = sample(points, len(points) // 2)
        near = [sorted(range(len(points)), key=lambda j: squared(points[i], points[j]))[:k] for i in centres]
        pairs = [(i, j) for i, row in zip(centres, near, strict=True) for j in row]
        of_points = deviation([d for i, j in pairs for d in minus(points[j], points[i])])
        of_features = deviation([d for i, j in pairs for d in minus(features[j], features[i])])
        width *= 2
        collected = []
        for i, row in zip(centres, near, strict=True):
            weighed = []
            for j in row:
                weights = waves([d / of_points for d in minus(points[j], points[i])], width)
                relative = [d / of_features for d in minus(features[j], features[i])]
                held = [*relative, *features[i]]
                weighed.append([(h + w) * w for h, w in zip(held, weights, strict=True)])
            collected.append([x / 2 * (1 + math.erf(x / math.sqrt(2))) for x in pooled(weighed)])
        points, features = [points[i] for i in centres], collected
    return pooled(features)


def box(rng: np.random.Generator, n: int = 600) -> np.ndarray:
    points = rng.uniform(-1, 1, (n, 3))
    points[np.arange(n), rng.integers(0, 3, n)] = rng.choice([-1, 1], n)
    return points * [1, 0.8, 0.5] + rng.normal(0, 0.02, (n, 3))


def can(rng: np.random.Generator, n: int = 600) -> np.ndarray:
    angle, height = rng.uniform(0, 2 * np.pi, n), rng.uniform(-1, 1, n)
    return np.column_stack([0.4 * np.cos(angle), 0.4 * np.sin(angle), height])


def cosine(one: np.ndarray, other: np.ndarray) -> float:
    """Of the features, as the rows are squares of them at length 1."""
    return float(np.sqrt(one) @ np.sqrt(other))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_features_are_those_of_the_slow_version(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    module = sys.modules["shapeconcepts.evaluation.point_nn"]
    sizes = {"N_POINTS": 24, "N_STAGES": 2, "WIDTH": 12, "N_NEIGHBOURS": 5}
    for name, size in sizes.items():
        monkeypatch.setattr(module, name, size)
    points = np.random.default_rng(seed).uniform(-0.6, 0.6, (30, 3)).astype(np.float32)
    expected = slow_features(points.astype(float).tolist(), 24, 2, 12, 5)
    assert module._features(points) == pytest.approx(expected, rel=1e-3, abs=1e-3)


def test_rows_are_squares_of_features_at_length_1() -> None:
    row = point_nn(box(np.random.default_rng(0)))
    assert row.shape == (1152,)
    assert (row >= 0).all() and row.sum() == pytest.approx(1)
    assert cosine(row, row) == pytest.approx(1)


def test_encoding_of_one_position() -> None:
    position = [0.1, -0.2, 0.3]
    assert position_encoding(np.array([position], np.float32), 12)[0] == pytest.approx(
        waves(position, 12), abs=1e-4
    )


def test_farthest_points_are_all_of_them_before_any_twice() -> None:
    points = np.array([[0, 0, 0], [3, 0, 0], [3, 0, 0], [1, 0, 0]], np.float32)
    assert farthest_points(points, 9).tolist() == [1, 0, 3, 2]
    assert farthest_points(points, 2).tolist() == [1, 0]


def test_order_place_and_size_do_not_matter() -> None:
    rng = np.random.default_rng(1)
    points = box(rng)
    row = point_nn(points)
    assert np.array_equal(row, point_nn(points[rng.permutation(len(points))]))
    assert cosine(row, point_nn(7.3 * points + [1, -2, 5])) > 0.999


def test_pose_matters_little_and_shape_more() -> None:
    rng = np.random.default_rng(2)
    points = box(rng)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    turned = cosine(point_nn(points), point_nn(points @ rotation.T))
    assert turned > 0.999
    boxes, cans = ([point_nn(make(rng)) for _ in range(3)] for make in (box, can))
    within = min(cosine(cans[0], one) for one in cans[1:])
    assert within > max(cosine(one, other) for one in boxes for other in cans)


@pytest.mark.parametrize(
    "points",
    [
        np.array([[1.0, 2.0, 3.0]]),
        np.zeros((5, 3)),
        np.arange(12.0)[:, None] * [1, 2, 3],
        np.repeat([[0.0, 0, 0], [1, 0, 0]], 200, axis=0),
        np.array([[0.0, 0, 0], [1e-300, 0, 0]]),
    ],
    ids=["one", "one place", "on a line", "two places", "tiny"],
)
def test_degenerate_objects_have_rows_too(points: np.ndarray) -> None:
    row = point_nn(points)
    assert np.isfinite(row).all() and (row >= 0).all()
    assert row.sum() == pytest.approx(1)


def test_no_points_are_a_row_of_zeros() -> None:
    assert not point_nn(np.empty((0, 3))).any()


@settings(deadline=None, max_examples=20)
@given(st_numpy.arrays(float, st.tuples(st.integers(1, 6), st.just(3)), elements=st.integers(-2, 2)))
def test_any_points_give_a_row(points: np.ndarray) -> None:
    row = point_nn(points)
    assert (row >= 0).all()
    assert row.sum() == pytest.approx(1)


@pytest.mark.parametrize(
    ("points", "message"),
    [(np.zeros((4, 2)), r"shape \(m, 3\), got \(4, 2\)"), (np.full((4, 3), np.nan), "must be finite")],
)
def test_unsuitable_points_are_refused(points: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        point_nn(points)
