"""The report's small version of a scan."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from report_models import ball, segmented, shuffled
from shapeconcepts.report.html import ScanPreview, preview
from shapeconcepts.report.html.object_size import object_sides
from shapeconcepts.report.html.scan_preview import NO_SEGMENT
from shapeconcepts.segmentation import SegmentedObject


def places(shown: ScanPreview) -> np.ndarray:
    """Metres, right, up and towards the sensor."""
    return (shown.positions / 255 - 0.5) * shown.extent


@pytest.mark.parametrize("n_points", [1, 50, 400])
def test_no_more_elements_than_asked_for_and_no_part_of_the_surface_is_lost(n_points):
    scan = ball()
    shown = preview(scan, n_points)
    assert 0.7 * n_points <= len(shown.positions) <= n_points
    # A sensor at the origin of an optical frame: up is -y, towards is -z.
    points = (scan.points - scan.points.mean(axis=0)) * (1, -1, -1)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    distances, _ = cKDTree(places(shown)).query(points - middle)
    assert distances.max() <= 1.8 * shown.spacing
    assert shown.extent == pytest.approx(0.1, rel=0.03)


def test_elements_face_the_sensor_and_keep_their_segment():
    shown = preview(ball())
    where, normals = places(shown), shown.normals / 127.5 - 1
    assert set(shown.segments) == {0, 1}
    # Left and right halves meet at x = 0.
    assert np.all((where[:, 0] > -0.002) == (shown.segments == 1) | (np.abs(where[:, 0]) < 0.002))
    radial = where[:, :2] / 0.05
    # At the rim a normal may lean away, and its disc is seen from behind.
    assert np.minimum(np.abs(normals - radial), np.abs(normals + radial)).max() < 0.03
    assert np.abs(normals - radial)[np.hypot(*radial.T) < 0.97].max() < 0.03


def test_order_of_the_points_does_not_matter():
    first, second = preview(ball()), preview(shuffled(ball(), 3))
    assert len(first.positions) == len(second.positions)
    assert np.abs(first.positions.astype(int) - second.positions).max() <= 1
    assert np.array_equal(first.segments, second.segments)
    assert preview(ball()).to_bytes() == first.to_bytes()


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.zeros((600, 3)),
        np.linspace(0, 1, 900)[:, None] * np.array([[1.0, 2.0, 3.0]]),
        np.stack([*np.divmod(np.arange(900), 30), np.zeros(900)], axis=1),
        np.array([[0, 0, 0.0], [1e6, 0, 0]]).repeat(300, axis=0),
    ],
    ids=["one point", "equal points", "line", "plane", "far apart"],
)
def test_degenerate_scans(points):
    normals = np.tile([0, 0, 1.0], (len(points), 1))
    shown = preview(segmented(points, normals, np.full(len(points), -1)), 400)
    assert 1 <= len(shown.positions) <= 400
    assert set(shown.segments) == {NO_SEGMENT}
    assert np.isfinite([shown.extent, shown.spacing]).all() and shown.spacing > 0
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    assert np.linalg.norm(shown.sides) == pytest.approx(diagonal, rel=1e-6, abs=1e-9)


def test_more_segments_than_elements():
    scan = ball()
    many = segmented(scan.points, scan.normals, np.arange(len(scan.points)) % 40)
    shown = preview(many, 10)
    assert len(shown.positions) <= 10
    assert shown.segments.max() < 12


def test_thinned():
    shown = preview(ball())
    assert shown.thinned(1000) is shown
    few = shown.thinned(100)
    assert len(few.positions) == 100 and len(few.to_bytes()) == 600
    assert few.spacing > shown.spacing
    assert few.sides == shown.sides


def test_no_points_asked_for():
    with pytest.raises(ValueError, match="n_points must be at least 1, got 0"):
        preview(ball(), 0)


def crate(sides: tuple[float, float, float], seed: int) -> SegmentedObject:
    """The three faces of a box that are seen from a corner, lying anyhow."""
    rng = np.random.default_rng(seed)
    points = rng.random((3, 1000, 3)) * sides
    points[range(3), :, range(3)] = np.array(sides)[:, None]
    turn = Rotation.random(random_state=seed)
    normals = np.repeat(np.eye(3), 1000, axis=0)
    return segmented(turn.apply(points.reshape(-1, 3)), turn.apply(normals), np.repeat(np.arange(3), 1000))


@pytest.mark.parametrize(
    "sides", [(0.081, 0.06, 0.022), (0.1, 0.1, 0.1), (81.0, 60.0, 22.0), (0.3, 0.01, 0.01)]
)
@pytest.mark.parametrize("seed", range(3))
def test_size_of_a_box_is_that_of_its_edges(sides, seed):
    assert object_sides(crate(sides, seed)) == pytest.approx(sides, rel=0.05, abs=0.02 * sides[0])


def test_size_without_segments_is_that_of_what_is_there():
    points = np.random.default_rng(0).random((1000, 3)) * (0.2, 0.1, 0.01)
    turned = Rotation.random(random_state=0).apply(points)
    unsegmented = segmented(turned, turned, np.full(1000, -1))
    assert object_sides(unsegmented) == pytest.approx((0.2, 0.1, 0.01), abs=0.003)


@pytest.mark.parametrize("distance", [1.0, 1e6])
def test_a_far_stray_point_does_not_count_for_the_size(distance):
    scan = ball()
    points = scan.points.copy()
    points[:3] += (distance, 0, 0)
    assert object_sides(dataclasses.replace(scan, points=points)) == pytest.approx((0.1, 0.1, 0.05), rel=0.03)
