"""Object crops of the Object Segmentation Database."""

from collections import Counter

import numpy as np
import pytest

from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.sources.osd import load_osd


def write_scene(path, rows, fields="x y z label", types="F F F U"):
    n = len(fields.split())
    path.write_text(
        f"FIELDS {fields}\nSIZE {'4 ' * n}\nTYPE {types}\nWIDTH {len(rows)}\nDATA ascii\n"
        + "".join(" ".join(str(value) for value in row) + "\n" for row in rows)
    )


def test_real_scenes(shared_data):
    scans = load_osd(shared_data / "osd_learn")
    assert Counter(scan.label for scan in scans) == {"box": 38, "can": 38}
    assert len({scan.name for scan in scans}) == 76
    assert [scan.name for scan in scans[:3]] == ["learn0/2", "learn0/3", "learn1/2"]
    assert scans.skipped == []
    for scan in scans:
        decade = int(scan.name.split("/")[1])
        assert set(scan.point_labels // 10) == {decade}
        assert np.isfinite(scan.points).all()
        assert (scan.points[:, 2] > 0.3).all()
        np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


ROWS = [
    (0, 0, 1, 0),
    (0, 0, 1, 5),
    (0.1, 0, 1, 20),
    (0.2, 0, 1, 35),
    (0.3, 0, 1, 21),
    ("nan", 0, 1, 20),
    (0, 0, 0, 20),
    (0, 0, -1, 20),
    ("nan", "nan", "nan", 40),
]


def test_rule_of_the_labels(tmp_path):
    write_scene(tmp_path / "learn33.pcd", ROWS)
    scans = load_osd(tmp_path)
    assert [scan.name for scan in scans] == ["learn33/2", "learn33/3"]
    np.testing.assert_array_equal(scans[0].point_labels, [20, 21])
    np.testing.assert_allclose(scans[0].points, [[0.1, 0, 1], [0.3, 0, 1]], atol=1e-7)
    np.testing.assert_array_equal(scans[1].point_labels, [35])


@pytest.mark.parametrize(
    ("scene", "label"),
    [
        *[(f"learn{i}", "box") for i in (0, 9, 16)],
        *[(f"test{i}", "box") for i in (0, 15)],
        *[(f"learn{i}", "can") for i in (33, 44)],
        *[(f"test{i}", "can") for i in (31, 42)],
        *[
            (name, None)
            for name in (
                "learn17",
                "learn32",
                "learn45",
                "test16",
                "test30",
                "test43",
                "scene1",
                "learn",
                "learn0b",
            )
        ],
    ],
)
def test_category_by_number_of_the_scene(tmp_path, scene, label):
    write_scene(tmp_path / f"{scene}.pcd", ROWS)
    assert {scan.label for scan in load_osd(str(tmp_path))} == {label}


def test_scene_without_labels(tmp_path):
    write_scene(tmp_path / "learn0.pcd", [row[:3] for row in ROWS], "x y z", "F F F")
    with pytest.raises(ScanError, match=r"learn0\.pcd: has no field label"):
        load_osd(tmp_path)


def test_a_scene_that_cannot_be_read_is_skipped(tmp_path):
    write_scene(tmp_path / "learn0.pcd", ROWS)
    (tmp_path / "learn1.pcd").write_text("no scene\n")
    with pytest.warns(ScanWarning, match=r"1 of \d+ scans are left out: .*learn1\.pcd"):
        scans = load_osd(tmp_path)
    assert len(scans) > 0 and "learn1.pcd" in str(scans.skipped[0])


def test_nothing_there(tmp_path):
    with pytest.raises(ScanError, match="no such folder"):
        load_osd(tmp_path / "ghost")
    with pytest.raises(ScanError, match="holds no scan"):
        load_osd(tmp_path)
    (tmp_path / "notes.txt").write_text("0 0 1\n")
    with pytest.raises(ScanError, match="holds no scene"):
        load_osd(tmp_path)
    write_scene(tmp_path / "learn0.pcd", ROWS[:2])
    with pytest.raises(ScanError, match="holds no scene"):
        load_osd(tmp_path)
    (tmp_path / "learn1.pcd").write_text("no scene\n")
    with pytest.raises(ScanError, match=r"learn1\.pcd"):
        load_osd(tmp_path)
