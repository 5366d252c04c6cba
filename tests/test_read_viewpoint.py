"""When a sensor position is believed."""

import numpy as np
import pytest

from shapeconcepts.io.viewpoint import camera_frame_viewpoint, declared_viewpoint
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources import as_scan, read_scan

BALL = np.random.default_rng(0).normal(size=(300, 3))
BALL *= 0.05 / np.linalg.norm(BALL, axis=1, keepdims=True)


def moved(x, y, z):
    return BALL + np.array([x, y, z])


def believed(points):
    viewpoint = camera_frame_viewpoint(np.asarray(points, dtype=float))
    assert viewpoint is None or not viewpoint.any()
    return viewpoint is not None


def test_camera_frame():
    assert believed(moved(0, 0, 0.8))
    assert believed(moved(0.3, -0.2, 0.8))
    assert believed(BALL * 1000 + np.array([0, 0, 800])), "millimetres"
    assert believed(BALL * 0.2 + np.array([0, 0, 0.1])), "a small thing, close up"
    assert believed([[0, 0, 0.5]])


def test_not_a_camera_frame():
    assert not believed(BALL), "centred"
    assert not believed(moved(0, 0, 0.05)), "standing on the origin"
    assert not believed(moved(0, 0, 0.1)), "nearer than any sensor measures"
    assert not believed(moved(0, 0, -0.8)), "behind the camera"
    assert not believed(moved(3, 2, 0.8)), "in the frame of a map"
    assert not believed(np.vstack([moved(0, 0, 0.8), [[0, 0, -0.1]]])), "one point behind"
    assert not believed([[0, 0, 0.1]])
    assert not believed(np.full((3, 3), np.nan))
    assert not believed(np.zeros((3, 3)))
    assert not believed(np.zeros((0, 3)))


def test_missing_points_do_not_count():
    assert believed(np.vstack([moved(0, 0, 0.8), [[np.nan] * 3, [0, 0, 0], [1, np.inf, 0]]]))


@pytest.mark.filterwarnings("error")
def test_absurd_coordinates():
    assert not believed([[1e300, 1e300, -1e300], [1, 2, 3]])
    assert declared_viewpoint(np.array([[1e308, 0, 0], [-1e308, 0, 0]]), np.array([0, 1.0, 0])) is None


def test_declared_position():
    for position in ([0, 0, 1.0], [1.0, 0, 0], [-0.09, 0.0, 0.0]):
        np.testing.assert_array_equal(declared_viewpoint(BALL, np.array(position)), position)
    for position in ([0, 0, 0], [0.04, 0, 0], [0.055, 0, 0], [0, np.nan, 1], [0, 0, np.inf]):
        assert declared_viewpoint(BALL, np.array(position, dtype=float)) is None
    assert declared_viewpoint(np.full((2, 3), np.nan), np.ones(3)) is None
    with_missing = np.vstack([BALL, [[np.nan] * 3, [np.inf] * 3]])
    assert declared_viewpoint(with_missing, np.ones(3)) is not None


def pcd(tmp_path, points, viewpoint):
    rows = "".join(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points)
    (tmp_path / "scan.pcd").write_text(
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
        f"WIDTH {len(points)}\nVIEWPOINT {viewpoint}\nDATA ascii\n{rows}"
    )
    return tmp_path / "scan.pcd"


@pytest.mark.parametrize(
    ("offset", "header", "expected"),
    [
        ([0, 0, 0], "0 0 0 1 0 0 0", None),
        ([0, 0, 0.8], "0 0 0 1 0 0 0", [0, 0, 0]),
        ([3, 2, 0.8], "0 0 0 1 0 0 0", None),
        ([0, 0, 0], "0 0 -0.8 1 0 0 0", [0, 0, -0.8]),
        ([3, 2, 0.8], "3 2 0 1 0 0 0", [3, 2, 0]),
        ([3, 2, 0.8], "3 2 0.8 1 0 0 0", None),
        ([0, 0, 0.8], "nan 0 0 1 0 0 0", None),
    ],
)
def test_pcd_header(tmp_path, offset, header, expected):
    viewpoint = read_scan(pcd(tmp_path, moved(*offset), header)).viewpoint
    assert (viewpoint is None) if expected is None else np.array_equal(viewpoint, expected)


def test_formats_without_a_viewpoint(tmp_path):
    for offset, expected in (([0, 0, 0.8], True), ([0, 0, 0], False)):
        np.save(tmp_path / "scan.npy", moved(*offset))
        np.savetxt(tmp_path / "scan.xyz", moved(*offset))
        for name in ("scan.npy", "scan.xyz"):
            assert (read_scan(tmp_path / name).viewpoint is not None) == expected


def test_position_from_the_user(tmp_path):
    path = pcd(tmp_path, moved(0, 0, 0.8), "0 0 0 1 0 0 0")
    assert read_scan(path, viewpoint=None).viewpoint is None
    np.testing.assert_array_equal(read_scan(path, viewpoint=[0, 0, 1]).viewpoint, [0, 0, 1])
    for wrong in ("origin", [0, 0], [0, 0, np.nan], ["a", "b", "c"], 5):
        with pytest.raises(ValueError, match="viewpoint"):
            read_scan(path, viewpoint=wrong)


class PointCloudOfAnotherLibrary:
    def __init__(self, points):
        self.points = points


def test_as_scan():
    scan = Scan(BALL, name="a")
    assert as_scan(scan) is scan
    for value in (BALL, BALL.tolist(), BALL.astype(np.float32), PointCloudOfAnotherLibrary(BALL.tolist())):
        np.testing.assert_allclose(as_scan(value).points, BALL, atol=1e-7)
        assert as_scan(value).viewpoint is None
    np.testing.assert_array_equal(as_scan(moved(0, 0, 0.8)).viewpoint, [0, 0, 0])


def test_as_scan_does_not_share_memory():
    points = BALL.copy()
    scan = as_scan(points)
    points[:] = 0
    np.testing.assert_array_equal(scan.points, BALL)


def test_as_scan_takes_open3d():
    open3d = pytest.importorskip("open3d")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(BALL))
    np.testing.assert_array_equal(as_scan(cloud).points, BALL)
    with pytest.raises(ScanError, match="0 points"):
        as_scan(open3d.geometry.PointCloud())


@pytest.mark.parametrize(
    "value",
    [
        "mug.pcd",
        None,
        5,
        np.ones(3),
        np.ones((3, 2)),
        np.full((3, 3), np.nan),
        np.zeros((0, 3)),
        [["a"] * 3],
        object(),
    ],
)
def test_as_scan_refuses(value):
    with pytest.raises(ScanError):
        as_scan(value)
