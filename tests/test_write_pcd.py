"""Written PCD files, read back by pypcd4 and by the project's own reader."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from pypcd4 import PointCloud

from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources import read_scan

POINTS = np.random.default_rng(0).normal(size=(50, 3))


def test_pypcd4_reads_what_was_written(tmp_path):
    labels = np.arange(50) % 7
    write_pcd(tmp_path / "mug.pcd", Scan(POINTS, viewpoint=[0.25, -1.5, 3.0], point_labels=labels))
    cloud = PointCloud.from_path(tmp_path / "mug.pcd")
    assert tuple(cloud.fields) == ("x", "y", "z", "label")
    assert_array_equal(cloud.numpy(("x", "y", "z")), POINTS.astype(np.float32))
    assert_array_equal(cloud.pc_data["label"], labels)
    assert tuple(cloud.metadata.viewpoint) == (0.25, -1.5, 3.0, 1.0, 0.0, 0.0, 0.0)


def test_own_reader_reads_what_was_written(tmp_path):
    points = np.abs(POINTS) + 1.0
    write_pcd(tmp_path / "mug.pcd", Scan(points, viewpoint=np.zeros(3), point_labels=np.arange(50)))
    scan = read_scan(tmp_path / "mug.pcd")
    assert_array_equal(scan.points, points.astype(np.float32))
    assert_array_equal(scan.point_labels, np.arange(50))


def test_labels_and_viewpoint_may_be_missing(tmp_path):
    write_pcd(tmp_path / "mug.pcd", Scan(POINTS))
    cloud = PointCloud.from_path(tmp_path / "mug.pcd")
    assert tuple(cloud.fields) == ("x", "y", "z")
    assert tuple(cloud.metadata.viewpoint) == (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("label", [-1, 2**32])
def test_labels_that_do_not_fit_are_refused(tmp_path, label):
    with pytest.raises(ScanError, match=f"mug.pcd: point labels must be 0 to .* got .*{label}"):
        write_pcd(
            tmp_path / "mug.pcd", Scan(POINTS[:2], point_labels=[0, label] if label > 0 else [label, 0])
        )
    assert list(tmp_path.iterdir()) == []


def test_file_is_replaced_and_nothing_is_left_behind(tmp_path):
    path = tmp_path / "mug.pcd"
    path.write_text("old")
    write_pcd(path, Scan(POINTS))
    assert list(tmp_path.iterdir()) == [path]
    assert len(PointCloud.from_path(path).pc_data) == 50
    assert path.stat().st_mode & 0o444


def test_failure_leaves_no_file(tmp_path):
    (tmp_path / "mug.pcd").mkdir()
    with pytest.raises(OSError):
        write_pcd(tmp_path / "mug.pcd", Scan(POINTS))
    assert [entry.name for entry in tmp_path.iterdir()] == ["mug.pcd"]
    with pytest.raises(FileNotFoundError):
        write_pcd(tmp_path / "missing" / "mug.pcd", Scan(POINTS))
