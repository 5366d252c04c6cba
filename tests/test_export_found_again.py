"""Scans of a model that are found again by their names."""

from pathlib import Path

import numpy as np
import pytest

from shapeconcepts.export.training_scans import FoundScan, ScansInFiles, UnusableScan
from shapeconcepts.export.upright_box import upright_box
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan
from shapeconcepts.sources import find_scan_files

CUBE = """OFF
8 12 0
0 0 0
.1 0 0
.1 .1 0
0 .1 0
0 0 .1
.1 0 .1
.1 .1 .1
0 .1 .1
3 0 2 1
3 0 3 2
3 4 5 6
3 4 6 7
3 0 1 5
3 0 5 4
3 1 2 6
3 1 6 5
3 2 3 7
3 2 7 6
3 3 0 4
3 3 4 7
"""


def write_scene(path: Path, labels: list[int], x: float = 0.0) -> None:
    """A scene of three points for each label; their x tells the scenes apart."""
    path.parent.mkdir(parents=True, exist_ok=True)
    points = np.array([[x, label / 100, 1 + k / 10] for label in labels for k in range(3)])
    write_pcd(path, Scan(points, point_labels=np.repeat(labels, 3)))


def same(one: FoundScan | UnusableScan, other: FoundScan | UnusableScan) -> bool:
    """Whether a scan that is read alone is as it is among all."""
    if isinstance(one, UnusableScan) or isinstance(other, UnusableScan):
        return one == other
    of_one, of_other = one.scan, other.scan
    is_same = np.array_equal(of_one.points, of_other.points) and of_one.name == of_other.name
    return is_same and (one.row, one.file, of_one.label) == (other.row, other.file, of_other.label)


def found(names: list[str], folder: Path) -> tuple[dict[int, FoundScan | UnusableScan], list[int]]:
    scans = ScansInFiles(names, range(len(names)), find_scan_files(folder), {})
    results = list(scans.read())
    assert len({one.row for one in results}) == len(results)
    assert {one.row for one in results}.isdisjoint(scans.missing)
    assert len(results) + len(scans.missing) == len(names)
    for one in results:
        assert same(one, scans.read_one(one.row))
    return {one.row: one for one in results}, scans.missing


def test_objects_of_scenes(tmp_path: Path) -> None:
    write_scene(tmp_path / "a/scene.pcd", [1, 20, 30], 0.1)
    write_scene(tmp_path / "b/scene.pcd", [1, 20, 40], 0.2)
    results, missing = found(["scene/2", "scene/3", "scene/2", "scene/4", "scene/5", "other/2"], tmp_path)
    assert missing == [5]
    x = [one.scan.points[0, 0] for one in results.values() if isinstance(one, FoundScan)]
    names = [one.scan.name for one in results.values() if isinstance(one, FoundScan)]
    # Those of the same name in the order of the files.
    assert {row for row, one in results.items() if isinstance(one, UnusableScan)} == {4}
    np.testing.assert_allclose(x, [0.1, 0.1, 0.2, 0.2], atol=1e-6)
    assert names == ["scene/2", "scene/3", "scene/2", "scene/4"]
    assert all(one.file is None for one in results.values() if isinstance(one, FoundScan))
    unusable = results[4]
    assert isinstance(unusable, UnusableScan) and "does not hold scene/5" in unusable.reason


def test_a_scene_as_a_whole(tmp_path: Path) -> None:
    write_scene(tmp_path / "a/scene.pcd", [1, 20, 30])
    results, missing = found(["a/scene.pcd"], tmp_path)
    [one] = results.values()
    assert isinstance(one, FoundScan) and len(one.scan) == 9 and not missing
    assert one.file == tmp_path / "a/scene.pcd"


def test_views_of_meshes(tmp_path: Path) -> None:
    (tmp_path / "cube").mkdir()
    (tmp_path / "cube/a.off").write_text(CUBE)
    names = [f"cube/a.off/view {number} of 2" for number in (2, 1)] + ["cube/a.off", "cube/b.off/view 1 of 2"]
    results, missing = found(names, tmp_path)
    assert missing == [3]
    assert [isinstance(one, FoundScan) and one.scan.name for _, one in sorted(results.items())] == names[:3]


def test_names_of_files_that_were_given_themselves(tmp_path: Path) -> None:
    write_scene(tmp_path / "scans/can/0.pcd", [0], 0.1)
    write_scene(tmp_path / "scans/box/0.pcd", [0], 0.2)
    results, missing = found(["scans/can/0.pcd", str(tmp_path / "scans/box/0.pcd")], tmp_path / "scans")
    assert missing == []
    x = [one.scan.points[0, 0] for _, one in sorted(results.items()) if isinstance(one, FoundScan)]
    np.testing.assert_allclose(x, [0.1, 0.2], atol=1e-6)


def test_names_that_lead_elsewhere(tmp_path: Path) -> None:
    write_scene(tmp_path / "scans/0.pcd", [0])
    write_scene(tmp_path / "1.pcd", [0])
    results, missing = found(["../1.pcd", "", "/", ".."], tmp_path / "scans")
    assert missing == [0, 1, 2, 3] and results == {}


@pytest.mark.parametrize("yaw", [0.0, 0.3, -1.2, 1.5])
def test_the_box_of_a_turned_cuboid(yaw: float) -> None:
    corners = np.array([[x, y, z] for x in (-0.3, 0.3) for y in (-0.1, 0.1) for z in (0, 0.2)])
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    box = upright_box(corners @ turn.T + [5, 6, 7])
    np.testing.assert_allclose(box.centre, [5, 6, 7.1], atol=1e-9)
    np.testing.assert_allclose(box.dimensions, [0.6, 0.2, 0.2], atol=1e-5)
    assert abs((box.yaw - yaw + np.pi / 2) % np.pi - np.pi / 2) < 1e-9


@pytest.mark.parametrize(
    ("points", "dimensions"),
    [
        ([[1, 1, 1]], [0.001, 0.001, 0.001]),
        ([[0, 0, 0], [3, 4, 0]], [5, 0.001, 0.001]),
        ([[0, 0, 0], [0, 0, 2], [0, 0, 1]], [0.001, 0.001, 2]),
        ([[0, 0, 0], [1, 1, 0], [2, 2, 0], [3, 3, 1]], [18**0.5, 0.001, 1]),
    ],
)
def test_boxes_of_flat_things_have_edges(points: list[list[float]], dimensions: list[float]) -> None:
    box = upright_box(np.array(points, float))
    np.testing.assert_allclose(box.dimensions, dimensions, atol=1e-5)
