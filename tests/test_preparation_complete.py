"""Complete clouds, of which only what is visible from one place counts."""

import numpy as np
import pytest

from shapeconcepts import Scan, datasets
from shapeconcepts.preparation import prepare
from shapeconcepts.preparation.closedness import is_seen_from_all_sides, share_seen_through
from shapeconcepts.preparation.hidden_points import visible_points
from shapeconcepts.preparation.unusual import ALL_SIDES
from shapeconcepts.preparation.voxel_grid import VoxelGrid, adaptive_voxel_grid


def ball(n=20_000, radius=0.05):
    directions = np.random.default_rng(0).normal(size=(n, 3))
    return radius * directions / np.linalg.norm(directions, axis=1, keepdims=True)


def is_told(prepared) -> bool:
    return any(notice.endswith(ALL_SIDES) for notice in prepared.notices)


@pytest.mark.parametrize("viewpoint", [(0.0, 0.0, 1.0), (0.7, -0.7, 0.0)])
def test_of_a_ball_the_half_towards_the_sensor_is_left(viewpoint):
    points, direction = ball(), np.array(viewpoint) / np.linalg.norm(viewpoint)
    prepared = prepare(Scan(points, viewpoint))
    assert is_told(prepared)
    heights = prepared.points @ direction
    assert heights.min() > -0.015 and 0.3 < len(heights) / len(adaptive_voxel_grid(points).points) < 0.6
    is_kept = prepared.point_to_voxel >= 0
    assert (points[~is_kept] @ direction).mean() < 0.0 < (points[is_kept] @ direction).mean()
    assert prepared.point_to_voxel.max() == len(prepared.points) - 1
    assert (np.einsum("ij,ij->i", prepared.normals, prepared.points) > 0.0).mean() > 0.95


def test_half_of_it_is_a_scan_as_it_is():
    points = ball()
    half = points[points[:, 2] > 0.0]
    prepared = prepare(Scan(half, (0.0, 0.0, 1.0)))
    assert prepared.notices == () and (prepared.point_to_voxel >= 0).all()


def test_a_position_that_is_wrong_does_not_make_a_scan_complete():
    for scan in datasets.simulate(n_per_category=2, random_state=3):
        size = float(np.linalg.norm(np.ptp(scan.points, axis=0)))
        for direction in np.vstack([np.eye(3), -np.eye(3)]):
            assert not is_told(prepare(Scan(scan.points, scan.points.mean(axis=0) + 4.0 * size * direction)))


def test_points_on_a_line_of_sight():
    points = np.array([[0.0, 0, 0], [0, 0, -1], [0, 0, -2], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    assert visible_points(points, np.array([0.0, 0.0, 5.0])).tolist() == [True, False, False] + [True] * 4


@pytest.mark.parametrize(
    "points",
    [np.zeros((1, 3)), np.zeros((9, 3)), np.eye(3), np.linspace(0, 1, 9)[:, None] * np.ones(3)],
    ids=["one", "copies", "three", "line"],
)
def test_what_spans_no_space_is_visible_and_no_complete_cloud(points):
    for viewpoint in (np.array([3.0, 3.0, 3.0]), points[0], points.mean(axis=0)):
        assert visible_points(points, viewpoint).all()
        assert not is_seen_from_all_sides(
            VoxelGrid(points, np.arange(len(points), dtype=np.int32), 0.1), viewpoint
        )


@pytest.mark.parametrize("voxel_size", [1e-300, 1e-12, 1e300])
def test_absurd_voxels_tell_nothing(voxel_size):
    assert share_seen_through(ball(100), voxel_size, np.array([0.0, 0.0, 1.0])) == 0.0
