"""Object Shape Category Dataset: category folders, with or without a split."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from shapeconcepts.datasets import CATEGORIES, load_oscd, split_of
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan, ScanError, ScanWarning

POINTS = np.random.default_rng(0).normal(size=(20, 3)) * 0.02 + (0, 0, 0.8)


def write(folder, *names):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, Scan(POINTS, viewpoint=np.zeros(3)))


@pytest.mark.parametrize(
    ("name", "label", "split"),
    [
        ("can/0.pcd", "can", None),
        ("Cans/0.PCD", "can", None),
        ("boxes/0.pcd", "box", None),
        ("Teddies/0.pcd", "teddy", None),
        ("amphorae/0.pcd", "amphora", None),
        ("barrel/0.pcd", "can", None),
        ("parcels/0.pcd", "box", None),
        ("training/sack/0.pcd", "sack", "training"),
        ("Test_set/plate/0.pcd", "plate", "testing"),
        ("ball/train/0.pcd", "ball", "training"),
        ("ball/testing/0.pcd", "ball", "testing"),
        ("oscd-v01/data/train/amphora/0.pcd", "amphora", "training"),
        ("trainbarrel/0.pcd", "can", "training"),
        ("testparcel/0.pcd", "box", "testing"),
        ("training-sacks/0.pcd", "sack", "training"),
        ("training/can12.pcd", "can", "training"),
        ("testing/box_3.pcd", "box", "testing"),
        ("teddy_07.pcd", "teddy", None),
    ],
)
def test_label_and_split(tmp_path, name, label, split):
    write(tmp_path, name)
    [scan] = load_oscd(tmp_path)
    assert (scan.name, scan.label, split_of(scan)) == (name, label, split)
    assert scan.instance is None
    np.testing.assert_allclose(scan.points, POINTS, rtol=1e-6)
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


def test_natural_order_and_other_files(tmp_path):
    write(tmp_path, "can/can_10.pcd", "can/can_9.pcd", "ball/b.pcd")
    (tmp_path / "readme.txt").write_text("about the data")
    (tmp_path / "can" / "can_9.png").write_text("a picture")
    scans = load_oscd(tmp_path)
    assert [scan.name for scan in scans] == ["ball/b.pcd", "can/can_9.pcd", "can/can_10.pcd"]
    assert scans.skipped == []


@pytest.mark.parametrize(
    "name", ["mug/0.pcd", "kitchen/box_1.pcd", "trains/can.pcd", "0.pcd", "testcan2/0.pcd"]
)
def test_no_category(tmp_path, name):
    write(tmp_path, "can/0.pcd", name)
    with pytest.warns(ScanWarning, match="1 of 2"):
        scans = load_oscd(tmp_path)
    assert [scan.label for scan in scans] == ["can"]
    [error] = scans.skipped
    assert str(error).startswith(f"{tmp_path / name}: is in no folder named after one of sack, can, box, ")


def test_damaged_file_is_left_out(tmp_path):
    write(tmp_path, "can/0.pcd", "can/1.pcd")
    damaged = tmp_path / "can" / "1.pcd"
    damaged.write_bytes(damaged.read_bytes()[:-1])
    with pytest.warns(ScanWarning, match="1 of 2"):
        scans = load_oscd(tmp_path)
    assert [scan.name for scan in scans] == ["can/0.pcd"]
    assert str(scans.skipped[0]).startswith(f"{damaged}: is truncated")


def test_nothing_to_read(tmp_path):
    with pytest.raises(ScanError, match="there is no such folder"):
        load_oscd(tmp_path / "absent")
    with pytest.raises(ScanError, match="holds no scans"):
        load_oscd(tmp_path)
    (tmp_path / "points.xyz").write_text("0 0 1\n")
    with pytest.raises(ScanError, match=r"holds no point cloud \(.pcd\)"):
        load_oscd(tmp_path)
    write(tmp_path, "mug/0.pcd")
    with pytest.raises(ScanError, match="is in no folder named after one of"):
        load_oscd(tmp_path)


@given(
    category=st.sampled_from(CATEGORIES),
    upper=st.booleans(),
    word=st.sampled_from(["train", "training", "training_set", "Train-Data", "test", "testing", "TEST set"]),
    way=st.sampled_from(["above", "below", "joined"]),
)
def test_any_way_to_name_a_split(category, upper, word, way):
    folder = category.upper() if upper else category
    path = {"above": f"{word}/{folder}", "below": f"{folder}/{word}", "joined": f"{word}{folder}"}[way]
    scan = Scan(POINTS, name=f"{path}/0.pcd")
    assert split_of(scan) == ("training" if word.lower().startswith("train") else "testing")


@given(st.text(alphabet=st.characters(codec="utf-8"), max_size=12))
def test_other_names_tell_no_split(name):
    known = not name.lower().startswith(("train", "test")) and "/" not in name
    if known:
        assert split_of(Scan(POINTS, name=f"{name}/0.pcd")) is None
