"""Which labelled data lie in a folder."""

import numpy as np
import pytest
from washington_files import write_cloud

from shapeconcepts.datasets import load_labelled, split_of
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan, ScanError, ScanWarning

POINTS = np.random.default_rng(0).normal(size=(20, 3)) * 0.02 + (0, 0, 0.8)
SCENE = Scan(POINTS, point_labels=[1] * 8 + [20] * 6 + [30] * 6)


def write(folder, *names, scan=None):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan or Scan(POINTS, viewpoint=np.zeros(3)))


def labels(scans):
    return {scan.name: scan.label for scan in scans}


def test_scenes(tmp_path):
    write(tmp_path, "learn0.pcd", "learn33.pcd", "learn20.pcd", scan=SCENE)
    scans = load_labelled(tmp_path)
    assert labels(scans) == {"learn0/2": "box", "learn0/3": "box", "learn33/2": "can", "learn33/3": "can"}
    assert [str(error) for error in scans.skipped] == ["learn20/2: has no label", "learn20/3: has no label"]


def test_scenes_as_published(tmp_path):
    write(tmp_path, "learn/learn0.pcd", "learn/learn17.pcd", "test/test31.pcd", scan=SCENE)
    (tmp_path / "README.md").write_text("about the data")
    scans = load_labelled(tmp_path)
    assert labels(scans) == {"learn0/2": "box", "learn0/3": "box", "test31/2": "can", "test31/3": "can"}
    assert len(scans.skipped) == 2


def test_scans_of_one_object_that_are_named_like_scenes(tmp_path):
    write(tmp_path, "mug/test0.pcd", "bowl/test1.pcd")
    assert labels(load_labelled(tmp_path)) == {"mug/test0.pcd": "mug", "bowl/test1.pcd": "bowl"}


def test_scenes_without_a_category(tmp_path):
    write(tmp_path, "learn20.pcd", scan=SCENE)
    with pytest.raises(ScanError, match=f"^{tmp_path}: holds no labelled scans"):
        load_labelled(tmp_path)


def test_washington(tmp_path):
    for frame in range(1, 8):
        write_cloud(tmp_path / "rgbd-dataset", "food_bag", 1, 1, frame)
    scans = load_labelled(tmp_path)
    assert labels(scans) == {f"food_bag_1_1_{frame}": "sack" for frame in range(1, 6)}
    assert {scan.instance for scan in scans} == {"food_bag_1"}


def test_paper_categories(tmp_path):
    write(tmp_path, "training/barrel/0.pcd", "testing/parcel/0.pcd")
    (tmp_path / "readme.txt").write_text("about the data")
    scans = load_labelled(tmp_path)
    assert labels(scans) == {"testing/parcel/0.pcd": "box", "training/barrel/0.pcd": "can"}
    assert [split_of(scan) for scan in scans] == ["testing", "training"]


def test_point_labels_do_not_make_a_scene_of_parts(tmp_path):
    write(tmp_path, "can/0.pcd", "box/0.pcd", scan=SCENE)
    assert labels(load_labelled(tmp_path)) == {"can/0.pcd": "can", "box/0.pcd": "box"}


def test_any_category_folders(tmp_path):
    write(tmp_path, "can/0.pcd", "barrel/0.pcd", "mug/a/0.pcd", "mug_1_1_1/mug_1_1_1.pcd")
    (tmp_path / "mug" / "1.xyz").write_text("0 0 1\n0.1 0 1\n" * 6)
    assert labels(load_labelled(tmp_path)) == {
        "can/0.pcd": "can",
        "barrel/0.pcd": "barrel",
        "mug/a/0.pcd": "mug",
        "mug/1.xyz": "mug",
        "mug_1_1_1/mug_1_1_1.pcd": "mug_1_1_1",
    }


def test_a_file_of_another_format_beside_the_papers_categories_counts(tmp_path):
    write(tmp_path, "can/0.pcd")
    (tmp_path / "can" / "1.xyz").write_text("0 0 1\n0.1 0 1\n" * 6)
    assert labels(load_labelled(tmp_path)) == {"can/0.pcd": "can", "can/1.xyz": "can"}


def test_split_of_any_categories(tmp_path):
    write(tmp_path, "train/mug/0.pcd", "test/mug/0.pcd", "bowl/train/0.pcd")
    scans = load_labelled(tmp_path)
    assert labels(scans) == {"train/mug/0.pcd": "mug", "test/mug/0.pcd": "mug", "bowl/train/0.pcd": "bowl"}
    assert [split_of(scan) for scan in scans] == ["training", "testing", "training"]


def test_category_that_is_called_like_a_split(tmp_path):
    write(tmp_path, "train/0.pcd", "car/0.pcd")
    assert labels(load_labelled(tmp_path)) == {"train/0.pcd": "train", "car/0.pcd": "car"}


def test_files_outside_the_folders_have_no_label(tmp_path):
    write(tmp_path, "loose.pcd", "mug/0.pcd")
    scans = load_labelled(tmp_path)
    assert labels(scans) == {"mug/0.pcd": "mug"}
    assert [str(error) for error in scans.skipped] == ["loose.pcd: has no label"]


def test_damaged_file(tmp_path):
    write(tmp_path, "mug/0.pcd")
    (tmp_path / "mug" / "1.pcd").write_text("")
    (tmp_path / "0.pcd").write_text("")
    with pytest.warns(ScanWarning, match="2 of 3"):
        scans = load_labelled(tmp_path)
    assert labels(scans) == {"mug/0.pcd": "mug"}


@pytest.mark.parametrize("names", [["a.pcd", "b.pcd"], ["train/0.pcd", "test/0.pcd"]])
def test_nothing_is_labelled(tmp_path, names):
    write(tmp_path, *names)
    with pytest.raises(ScanError, match=f"^{tmp_path}: holds no labelled scans"):
        load_labelled(tmp_path)


def test_no_scan_and_no_folder(tmp_path):
    with pytest.raises(ScanError, match="holds no scans"):
        load_labelled(tmp_path)
    with pytest.raises(ScanError, match="there is no such folder"):
        load_labelled(tmp_path / "absent")


@pytest.mark.parametrize(
    ("data_set", "n_scans", "n_labels"),
    [("osd_learn", 76, 2), ("seven_shapes", 462, 7), ("restaurant_views", 480, 8)],
)
def test_real_folders(shared_data, data_set, n_scans, n_labels):
    scans = load_labelled(shared_data / data_set)
    assert len(scans) == n_scans
    assert len({scan.label for scan in scans}) == n_labels
    assert scans.skipped == []
