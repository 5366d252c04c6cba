"""Scans: what fits into one and what does not."""

import numpy as np
import pytest

from shapeconcepts.scan import Scan, ScanError

POINTS = [[0, 0, 1], [0, 1, 1]]


@pytest.mark.parametrize(
    "labels", [[3, -4], [3.0, -4.0], np.array([3, -4], np.int8), np.array([3, -4], np.float32)]
)
def test_whole_point_labels(labels):
    scan = Scan(POINTS, point_labels=labels)
    assert scan.point_labels.dtype == np.int64
    np.testing.assert_array_equal(scan.point_labels, [3, -4])


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([0.0, 1.5], "whole numbers, got 1.5"),
        ([0.0, np.nan], "whole numbers, got nan"),
        ([-np.inf, 0.0], "whole numbers, got -inf"),
        ([0.0, 2.0**63], "whole numbers, got 9.2"),
        (np.array([0, 2**63], np.uint64), "less than 2"),
        (["side", "cap"], "be numbers"),
        ([[0], [1, 2]], "be numbers"),
        ([None, 1], "be numbers"),
        ([0, 1, 2], r"shape \(2,\), got \(3,\)"),
    ],
)
def test_other_point_labels(labels, message):
    with pytest.raises(ScanError, match=f"^mug: point_labels must .*{message}"):
        Scan(POINTS, name="mug", point_labels=labels)


def test_a_scan_has_arrays_of_its_own():
    points, viewpoint, labels = np.array(POINTS, float), np.zeros(3), np.array([1, 2])
    scan = Scan(points, viewpoint, point_labels=labels)
    points[:], viewpoint[:], labels[:] = 9, 9, 9
    np.testing.assert_array_equal(scan.points, POINTS)
    assert scan.viewpoint.tolist() == [0, 0, 0] and scan.point_labels.tolist() == [1, 2]
