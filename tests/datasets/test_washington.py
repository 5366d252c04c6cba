"""Washington RGB-D Object Dataset: point clouds and depth crops in the layout of its archives."""

import re
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from washington_files import write_cloud, write_crop

from shapeconcepts.datasets import PAPER_CATEGORIES, load_washington
from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.sources import read_scan

DEPTH = np.array([[0, 700, 701], [702, 0, 703]])
MASK = np.array([[True, True, False], [True, True, True]])


def names(scans):
    return [scan.name for scan in scans]


def test_first_frames_of_the_first_video(tmp_path):
    for frame in (11, 2, 9, 100, 30, 21, 7):
        write_cloud(tmp_path, "food_can", 14, 1, frame, depth=frame)
    for frame in (1, 3):
        write_cloud(tmp_path, "food_can", 14, 2, frame)
    write_cloud(tmp_path, "food_can", 2, 1, 5)
    scans = load_washington(tmp_path)
    frames = [2, 7, 9, 11, 21]
    assert names(scans) == ["food_can_2_1_5"] + [f"food_can_14_1_{frame}" for frame in frames]
    assert [scan.points[0, 2] for scan in scans[1:]] == frames
    assert [scan.instance for scan in scans] == ["food_can_2"] + ["food_can_14"] * 5
    assert {scan.label for scan in scans} == {"can"}
    assert scans.skipped == []
    np.testing.assert_allclose(scans[0].points, [[0.01 * i, 0.02 * i, 0.8] for i in range(5)], rtol=1e-6)
    np.testing.assert_array_equal(scans[0].viewpoint, [0, 0, 0])


def test_the_camera_is_at_the_origin_even_of_a_cloud_that_does_not_look_like_it(tmp_path):
    path = write_cloud(tmp_path, "ball", 1, 1, 1, depth=0.1)
    assert read_scan(path).viewpoint is None
    [scan] = load_washington(tmp_path)
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


def test_other_video_and_number(tmp_path):
    for frame in (5, 6, 7):
        write_cloud(tmp_path, "food_can", 1, 4, frame)
    assert names(load_washington(tmp_path, scans_per_instance=2, video=4)) == [
        "food_can_1_4_5",
        "food_can_1_4_6",
    ]


# The table of the paper: instances of each category, scans of each shape.
INSTANCES = {
    "food_bag": 8,
    "food_can": 14,
    "soda_can": 6,
    "cereal_box": 5,
    "food_box": 12,
    "ball": 7,
    "lime": 4,
    "orange": 4,
    "plate": 7,
}


def test_counts_of_the_paper(tmp_path):
    for category, n_instances in {**INSTANCES, "apple": 5}.items():
        for instance in range(1, n_instances + 1):
            for frame in range(1, 8):
                write_cloud(tmp_path / "rgbd-dataset", category, instance, 1, frame)
    scans = load_washington(tmp_path, categories=tuple(PAPER_CATEGORIES))
    assert Counter(scan.label for scan in scans) == {
        "sack": 40,
        "can": 100,
        "box": 85,
        "ball": 75,
        "plate": 35,
    }
    assert len({scan.instance for scan in scans}) == 67
    everything = load_washington(tmp_path)
    assert Counter(scan.label for scan in everything)["apple"] == 25
    assert len(everything) == 335 + 25


def matlab_points(depth, mask, corner):
    """depthToCloud.m of the data set in plain Python, with its counting from 1."""
    points = []
    for row in range(1, depth.shape[0] + 1):
        for column in range(1, depth.shape[1] + 1):
            z = float(depth[row - 1, column - 1])
            if z > 0 and mask[row - 1, column - 1]:
                x = (column + (corner[0] - 1) - 320) * z / 570.3 / 1000
                y = (row + (corner[1] - 1) - 240) * z / 570.3 / 1000
                points.append([x, y, z / 1000])
    return points


@pytest.mark.parametrize("corner", [(1, 1), (320, 240), (638, 479)])
@pytest.mark.parametrize("kind", [bool, np.uint8])
def test_depth_crop(tmp_path, corner, kind):
    mask = MASK if kind is bool else MASK.astype(np.uint8) * 255
    write_crop(tmp_path, "lime", 3, 1, 1, DEPTH, mask, corner)
    [scan] = load_washington(tmp_path)
    assert (scan.name, scan.label, scan.instance) == ("lime_3_1_1", "ball", "lime_3")
    np.testing.assert_allclose(scan.points, matlab_points(DEPTH, MASK, corner), rtol=1e-12)
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_the_window_of_a_crop_does_not_move_the_object(tmp_path_factory, data):
    image = np.zeros((480, 640), int)
    rows, columns = slice(200, 204), slice(310, 316)
    image[rows, columns] = data.draw(
        st.lists(st.integers(400, 3000), min_size=24, max_size=24).map(lambda v: np.reshape(v, (4, 6)))
    )
    left, top = data.draw(st.integers(0, 310)), data.draw(st.integers(0, 200))
    right, bottom = data.draw(st.integers(316, 640)), data.draw(st.integers(204, 480))
    crop = image[top:bottom, left:right]
    folder = tmp_path_factory.mktemp("crop")
    write_crop(folder, "ball", 1, 1, 1, crop, np.full(crop.shape, True), (left + 1, top + 1))
    [scan] = load_washington(folder)
    whole = matlab_points(image[rows, columns], np.full((4, 6), True), (311, 201))
    np.testing.assert_allclose(scan.points, whole, rtol=1e-12)


def test_point_cloud_wins_wherever_it_lies(tmp_path):
    write_crop(tmp_path / "rgbd-dataset", "ball", 1, 1, 1, DEPTH, MASK, (100, 100))
    write_crop(tmp_path / "rgbd-dataset", "ball", 1, 1, 2, DEPTH, MASK, (100, 100))
    write_cloud(tmp_path / "rgbd-dataset_pcd_ascii", "ball", 1, 1, 1, depth=0.5)
    scans = load_washington(tmp_path)
    assert names(scans) == ["ball_1_1_1", "ball_1_1_2"]
    assert scans[0].points[0, 2] == 0.5
    assert len(scans[1]) == 3


def skipped_reason(folder, **options):
    """The one reason for which a scan is left out, beside the scans that are read."""
    with pytest.warns(ScanWarning, match="1 of"):
        scans = load_washington(folder, **options)
    [error] = scans.skipped
    return names(scans), str(error)


def test_damaged_cloud_is_left_out_and_not_replaced(tmp_path):
    for frame in range(1, 8):
        write_cloud(tmp_path, "plate", 1, 1, frame)
    damaged = tmp_path / "plate" / "plate_1" / "plate_1_1_3.pcd"
    damaged.write_text(damaged.read_text()[:250])
    read, reason = skipped_reason(tmp_path)
    assert read == [f"plate_1_1_{frame}" for frame in (1, 2, 4, 5)]
    assert reason.startswith(f"{damaged}: is truncated")


def test_object_without_the_video(tmp_path):
    write_cloud(tmp_path, "plate", 1, 1, 1)
    write_cloud(tmp_path, "plate", 2, 2, 1)
    read, reason = skipped_reason(tmp_path)
    assert read == ["plate_1_1_1"]
    assert reason == f"{tmp_path}: plate_2 has no scan in video 1"


def test_missing_category(tmp_path):
    write_cloud(tmp_path, "plate", 1, 1, 1)
    read, reason = skipped_reason(tmp_path, categories=["plate", "bal"])
    assert read == ["plate_1_1_1"]
    assert reason == f"{tmp_path}: holds no scan of the category bal"


def remove(ending):
    return lambda path: (path.parent / f"{path.name}{ending}").unlink()


def write_location(text):
    return lambda path: (path.parent / f"{path.name}_loc.txt").write_bytes(text)


def write_mask(mask):
    return lambda path: write_crop(path.parents[2], "lime", 1, 1, 2, DEPTH, mask, (1, 1))


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (remove("_maskcrop.png"), "has no mask lime_1_1_2_maskcrop.png beside it"),
        (remove("_loc.txt"), "_loc.txt: there is no such file"),
        (write_location(b""), "like 281,209, got ''"),
        (write_location(b"12"), "like 281,209, got '12'"),
        (write_location(b"-1,5"), "like 281,209, got '-1,5'"),
        (write_location(b"\xff\x00,3"), "like 281,209, got"),
        (write_location(b"1,2," * 10_000), "like 281,209, got"),
        (write_location(b"639,1"), "crop of 3 x 2 pixels at 639,1 reaches beyond the image of 640 x 480"),
        (write_location(b"1,480"), "at 1,480 reaches beyond"),
        (write_mask(MASK[:, :2]), "the mask .* is 2 x 2 pixels, the depth image 3 x 2"),
        (write_mask(np.full((2, 3), False)), "no pixel with a depth in its mask"),
        (lambda path: (path.parent / "lime_1_1_2_depthcrop.png").write_bytes(b"none"), "is not a PNG image"),
        (
            lambda path: (path.parent / "lime_1_1_2_maskcrop.png").write_bytes(b"none"),
            "the mask .* is no image",
        ),
    ],
)
def test_damaged_crop(tmp_path, damage, reason):
    write_crop(tmp_path, "lime", 1, 1, 1, DEPTH, MASK, (638, 479))
    damage(write_crop(tmp_path, "lime", 1, 1, 2, DEPTH, MASK, (1, 1)))
    read, message = skipped_reason(tmp_path)
    assert read == ["lime_1_1_1"]
    assert re.search(reason, message)
    assert message.startswith(str(tmp_path / "lime" / "lime_1" / "lime_1_1_2_"))


@pytest.mark.parametrize("text", ["3,4", "3, 4\n", "3 4", " 3\t4 \r\n"])
def test_ways_to_write_the_corner(tmp_path, text):
    path = write_crop(tmp_path, "lime", 1, 1, 1, DEPTH, MASK, (1, 1))
    write_location(text.encode())(path)
    [scan] = load_washington(tmp_path)
    np.testing.assert_allclose(scan.points, matlab_points(DEPTH, MASK, (3, 4)), rtol=1e-12)


@pytest.mark.parametrize(
    "name",
    [
        "apple.pcd",
        "apple_1_1.pcd",
        "1_1_1_1.pcd",
        "apple_1_1_1.ply",
        "apple_1_1_1_crop.png",
        "apple_1_1_1_maskcrop.png",
        "apple_1_1_x.pcd",
        ".apple_1_1_1.pcd",
    ],
)
def test_other_files_are_no_scans(tmp_path, name):
    (tmp_path / name).write_text("")
    with pytest.raises(ScanError, match=f"^{tmp_path}: holds no scan of the Washington"):
        load_washington(tmp_path)


def test_nothing_can_be_read(tmp_path):
    write_cloud(tmp_path, "plate", 1, 1, 1).write_text("")
    write_cloud(tmp_path, "plate", 2, 1, 1).write_text("")
    with pytest.raises(ScanError, match=r"plate_1_1_1.pcd: is empty \(and 1 other files"):
        load_washington(tmp_path)
    with pytest.raises(ScanError, match="there is no such folder"):
        load_washington(tmp_path / "absent")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scans_per_instance": 0}, "scans_per_instance must be an integer of at least 1, got 0"),
        ({"scans_per_instance": 2.5}, "scans_per_instance must be an integer"),
        ({"video": 0}, "video must be an integer of at least 1, got 0"),
        ({"categories": "ball"}, "categories must be one name or more, .*got 'ball'"),
        ({"categories": ()}, "categories must be one name or more"),
    ],
)
def test_parameters_out_of_range(tmp_path, options, message):
    write_cloud(tmp_path, "ball", 1, 1, 1)
    with pytest.raises(ValueError, match=message):
        load_washington(tmp_path, **options)


@settings(max_examples=25, deadline=None)
@given(
    present=st.sets(st.tuples(st.integers(1, 3), st.integers(1, 2), st.integers(1, 120)), min_size=1),
    count=st.integers(1, 6),
)
def test_choice_of_frames(tmp_path_factory, present, count):
    folder = tmp_path_factory.mktemp("frames")
    for instance, video, frame in present:
        write_cloud(folder, "soda_can", instance, video, frame)
    expected, without = [], []
    for instance in sorted({instance for instance, _, _ in present}):
        frames = sorted(frame for i, video, frame in present if i == instance and video == 1)
        expected += [f"soda_can_{instance}_1_{frame}" for frame in frames[:count]]
        without += [] if frames else [instance]
    if not expected:
        with pytest.raises(ScanError, match="has no scan in video 1"):
            load_washington(folder, count)
        return
    if without:
        with pytest.warns(ScanWarning, match="has no scan in video 1"):
            scans = load_washington(folder, count)
    else:
        scans = load_washington(folder, count)
    assert names(scans) == expected
    assert len(scans.skipped) == len(without)
