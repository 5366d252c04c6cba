"""The same scan gives the same segmentation, whatever runs beside it, in any order, in any pose."""

import dataclasses

import numpy as np
import pytest
from joblib import Parallel, delayed
from scipy.spatial.transform import Rotation

from shapeconcepts import Scan, segment
from shapeconcepts.datasets import CATEGORIES, simulate_scan


@pytest.fixture(scope="module")
def scans() -> list[Scan]:
    return [simulate_scan(category, index, random_state=5) for category in CATEGORIES for index in range(2)]


@pytest.fixture(scope="module")
def alone(scans):
    return [segment(scan) for scan in scans]


def moved(scan: Scan, seed: int) -> tuple[Scan, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    turn, shift = Rotation.random(random_state=rng).as_matrix(), rng.uniform(-1, 1, 3)
    return Scan(scan.points @ turn.T + shift, turn @ scan.viewpoint + shift, name=scan.name), turn, shift


def point_labels(obj) -> np.ndarray:
    return np.append(obj.segment_labels, -1)[obj.point_to_voxel]


def assert_same_bits(one, other) -> None:
    for field in dataclasses.fields(one):
        first, second = getattr(one, field.name), getattr(other, field.name)
        if isinstance(first, np.ndarray):
            assert first.dtype == second.dtype and first.tobytes() == second.tobytes(), field.name
        else:
            assert first == second, field.name


def test_scans_are_worth_comparing(alone):
    assert {obj.n_segments for obj in alone} >= {1, 2, 3}


def test_again_and_in_another_order(scans, alone):
    for scan, obj in reversed(list(zip(scans, alone, strict=True))):
        assert_same_bits(segment(scan), obj)


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_in_parallel(scans, alone, n_jobs):
    parallel = Parallel(n_jobs=n_jobs, backend="loky")(delayed(segment)(scan) for scan in scans)
    for one, other in zip(parallel, alone, strict=True):
        assert_same_bits(one, other)


def test_in_threads(scans, alone):
    for one, other in zip(
        Parallel(n_jobs=2, backend="threading")(delayed(segment)(scan) for scan in scans), alone, strict=True
    ):
        assert_same_bits(one, other)


def test_order_of_the_points(scans, alone):
    for seed, (scan, obj) in enumerate(zip(scans, alone, strict=True)):
        order = np.random.default_rng(seed).permutation(len(scan))
        shuffled = segment(Scan(scan.points[order], scan.viewpoint, name=scan.name, label=scan.label))
        assert shuffled.n_segments == obj.n_segments, scan.name
        np.testing.assert_array_equal(shuffled.segment_edges, obj.segment_edges)
        np.testing.assert_array_equal(point_labels(shuffled), point_labels(obj)[order])
        np.testing.assert_array_equal(shuffled.point_to_voxel, obj.point_to_voxel[order])
        np.testing.assert_allclose(shuffled.points, obj.points, atol=1e-12)
        np.testing.assert_allclose(shuffled.normals, obj.normals, atol=1e-6)


def test_order_of_the_points_without_viewpoint(scans):
    for seed, scan in enumerate(scans[::3]):
        order = np.random.default_rng(seed).permutation(len(scan))
        obj, shuffled = segment(Scan(scan.points)), segment(Scan(scan.points[order]))
        np.testing.assert_array_equal(point_labels(shuffled), point_labels(obj)[order])
        np.testing.assert_allclose(shuffled.normals, obj.normals, atol=1e-6)


def test_rigid_motion(scans, alone):
    for seed, (scan, obj) in enumerate(zip(scans, alone, strict=True)):
        other, turn, shift = moved(scan, seed)
        result = segment(other)
        assert result.n_segments == obj.n_segments, scan.name
        np.testing.assert_array_equal(result.segment_edges, obj.segment_edges)
        assert (point_labels(result) == point_labels(obj)).mean() > 0.999, scan.name
        np.testing.assert_allclose(result.points, obj.points @ turn.T + shift, atol=1e-12)
        np.testing.assert_allclose(result.normals, obj.normals @ turn.T, atol=1e-6)
