"""Segments of recorded scans, and of the simulated yardstick, against their true parts."""

from pathlib import Path

import numpy as np
import pytest

from shapeconcepts import Scan, read_scan, segment
from shapeconcepts.datasets import load_osd


def sample(folder: Path, n: int) -> list[Scan]:
    files = sorted(folder.iterdir())
    assert len(files) >= n
    return [read_scan(path) for path in files[:: len(files) // n][:n]]


def near(scan: Scan) -> bool:
    return bool(np.median(scan.points[:, 2]) < 1.0)


def possible_counts(scan: Scan, voxels: np.ndarray) -> range:
    """Numbers of parts, where those between 3.5 % and 6.5 % of the points may count or not."""
    certain = doubtful = 0
    for part in np.unique(scan.point_labels):
        share = (scan.point_labels == part).mean()
        n_voxels = len(np.unique(voxels[(scan.point_labels == part) & (voxels >= 0)]))
        if share > 0.065 and n_voxels >= 30:
            certain += 1
        elif share >= 0.035:
            doubtful += 1
    return range(certain, certain + doubtful + 1)


@pytest.mark.parametrize("category", ["box", "can", "ball"])
def test_seven_shapes_have_their_true_number_of_parts(shared_data, category):
    scans = [scan for scan in sample(shared_data / "seven_shapes" / category, 33) if near(scan)][:10]
    assert len(scans) == 10
    wrong = []
    for scan in scans:
        obj = segment(scan)
        expected = possible_counts(scan, obj.point_to_voxel)
        if obj.n_segments not in expected:
            wrong.append((scan.name, obj.n_segments, expected))
    assert len(wrong) <= 1, wrong


@pytest.mark.parametrize("category", ["amphora", "plate", "sack", "teddy"])
def test_other_shapes_are_segmented(shared_data, category):
    for scan in sample(shared_data / "seven_shapes" / category, 2):
        obj = segment(scan)
        assert 1 <= obj.n_segments <= 12
        assert (obj.segment_labels >= 0).mean() > 0.9, scan.name


def test_recorded_boxes_and_cylinders(shared_data):
    scans = load_osd(shared_data / "osd_learn")
    boxes = [scan for scan in scans if scan.label == "box"][::5]
    cans = [scan for scan in scans if scan.label == "can"][::5]
    assert len(boxes) >= 7 and len(cans) >= 7
    for scan in boxes + cans:
        obj = segment(scan)
        assert (obj.segment_labels >= 0).mean() > 0.9, scan.name
        assert 1 <= obj.n_segments <= (3 if scan.label == "box" else 4), scan.name


@pytest.mark.parametrize("category", ["bowl", "cocacola", "cup", "fork", "milk", "mug", "plate", "yogurt"])
def test_restaurant_views_are_segmented(shared_data, category):
    for scan in sample(shared_data / "restaurant_views" / category, 2):
        assert scan.viewpoint is None
        obj = segment(scan)
        assert 1 <= obj.n_segments <= 12
        assert (obj.segment_labels >= 0).mean() > 0.9, scan.name
        assert obj.viewpoint is None
