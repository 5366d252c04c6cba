"""Where the sensor stood and which way was up, by the tree of frames."""

import numpy as np
import pytest

from recording_examples import BEGIN, SECOND, Maker, split, write
from shapeconcepts.recordings import read_scenes
from shapeconcepts.recordings.placement import placement, up_direction
from shapeconcepts.recordings.transforms import Transforms

NONE = (0, 0, 0, 1)
HALF = np.sqrt(0.5)
# An optical frame (x right, y down, z forward) in one with x forward and z up.
OPTICAL = (-0.5, 0.5, -0.5, 0.5)
OPTICAL_FRAME = "camera_depth_optical_frame"
IN_FRONT = np.array([[0.1, 0.1, 1.0], [-0.1, 0.0, 1.2], [0.0, 0.1, 0.9]])
ALL_AROUND = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.3], [0.0, 1.0, -0.2]])
ROBOT = (
    ("map", "odom", (5, 0, 0), NONE),
    ("odom", "base_link", (1, 2, 0), NONE),
    ("base_link", "camera_link", (0.2, 0, 1.5), NONE),
    ("camera_link", OPTICAL_FRAME, (0, 0.02, 0), OPTICAL),
)


def tree(*transforms):
    made = Transforms()
    made.add(Maker(2).tree(*transforms), is_static=True)
    return made


def test_up_is_the_z_axis_of_the_world_in_an_optical_frame():
    assert np.allclose(up_direction(OPTICAL_FRAME, BEGIN, tree(*ROBOT)), (0, -1, 0))


def test_a_tilted_camera():
    # Turned by 30 degrees around the y axis, down to the table.
    down = (0, np.sin(np.pi / 12), 0, np.cos(np.pi / 12))
    transforms = tree(
        ("world", "camera_link", (0, 0, 1), down), ("camera_link", OPTICAL_FRAME, (0,) * 3, OPTICAL)
    )
    expected = (0, -np.cos(np.pi / 6), -np.sin(np.pi / 6))
    assert np.allclose(up_direction(OPTICAL_FRAME, BEGIN, transforms), expected)


def test_the_frame_nearest_the_root_that_is_known_counts():
    # The robot drives up a slope, which the earth-centred frame knows nothing of.
    slope = (0, np.sin(0.1), 0, np.cos(0.1))
    transforms = tree(
        ("earth", "map", (0, 0, 0), (HALF, 0, 0, HALF)),
        ("map", "base_link", (0, 0, 0), slope),
        ("base_link", "lidar", (0, 0, 1), NONE),
    )
    assert np.allclose(up_direction("lidar", BEGIN, transforms), (-np.sin(0.2), 0, np.cos(0.2)))


def test_a_camera_that_is_the_root_of_the_tree():
    transforms = tree((OPTICAL_FRAME, "base_link", (0, 0, 1), (0.5, -0.5, 0.5, 0.5)))
    assert np.allclose(up_direction(OPTICAL_FRAME, BEGIN, transforms), (0, -1, 0))


@pytest.mark.parametrize(
    "transforms",
    [
        Transforms(),
        tree(("camera_link", OPTICAL_FRAME, (0, 0, 0), OPTICAL)),
        tree(("map", "other", (0, 0, 0), NONE)),
    ],
)
def test_without_a_known_frame_above_up_is_not_known(transforms):
    assert up_direction(OPTICAL_FRAME, BEGIN, transforms) is None


def viewpoint(points, frame, transforms=None, topic="/points"):
    return placement(points, frame, topic, BEGIN, transforms or Transforms()).viewpoint


@pytest.mark.parametrize("transforms", [None, tree(*ROBOT)])
@pytest.mark.parametrize("frame", [OPTICAL_FRAME, "camera_link", "velodyne"])
def test_the_frame_of_a_sensor_has_it_in_its_origin(frame, transforms):
    assert np.array_equal(viewpoint(ALL_AROUND, frame, transforms), np.zeros(3))


@pytest.mark.parametrize(
    ("frame", "expected"),
    [("base_link", (0.2, 0.02, 1.5)), ("map", (6.2, 2.02, 1.5)), ("odom", (1.2, 2.02, 1.5))],
)
def test_a_cloud_that_was_turned_has_its_sensor_below_it(frame, expected):
    assert np.allclose(viewpoint(ALL_AROUND, frame, tree(*ROBOT)), expected)


def test_of_several_sensors_the_one_that_shares_a_word_with_the_topic():
    transforms = tree(
        ("base_link", "left_camera", (0, 1, 0), NONE), ("base_link", "right_camera", (0, -1, 0), NONE)
    )
    assert viewpoint(ALL_AROUND, "base_link", transforms) is None
    assert np.allclose(viewpoint(ALL_AROUND, "base_link", transforms, "/right/points"), (0, -1, 0))


@pytest.mark.parametrize(
    ("points", "frame", "transforms", "is_known"),
    [
        (IN_FRONT, "", None, True),
        (IN_FRONT, "eye", None, True),
        (IN_FRONT, "eye", tree(("map", "eye", (0, 0, 0), NONE)), True),
        (ALL_AROUND, "eye", None, False),
        (IN_FRONT, "eye", tree(("eye", "finger", (0, 0, 0), NONE)), False),
        (IN_FRONT, "map", None, False),
        (IN_FRONT, "robot/base_link", None, False),
    ],
)
def test_of_an_unknown_frame_the_points_tell(points, frame, transforms, is_known):
    assert (viewpoint(points, frame, transforms) is not None) == is_known


def test_transforms_that_are_none_are_passed_over():
    bad = [
        ("map", "a", (np.nan, 0, 0), NONE),
        ("map", "b", (0, 0, 0), (0, 0, 0, 0)),
        ("c", "c", (0, 0, 0), NONE),
        ("map", "d", (0, 0, 0), (np.inf, 0, 0, 1)),
    ]
    assert not tree(*bad)


def test_a_circle_of_frames_has_an_end():
    transforms = tree(
        ("a", "b", (0, 0, 0), NONE), ("b", "a", (0, 0, 0), NONE), ("b", "camera", (0, 0, 0), NONE)
    )
    assert up_direction("camera", BEGIN, transforms) is None
    assert viewpoint(ALL_AROUND, "a", transforms) is None


def test_what_moves_stands_where_it_did_last():
    transforms = Transforms()
    for number in (3, 1, 2):
        transforms.add(Maker(2).tree(("map", "lidar", (number, 0, 0), NONE), stamp=number * SECOND), False)
    places = [transforms.pose("lidar", "map", time * SECOND // 2).translation[0] for time in range(1, 8)]
    # Before the first one, that counts.
    assert places == [1, 1, 1, 2, 2, 3, 3]


def test_frames_and_transforms_are_bounded():
    transforms = Transforms()
    for number in range(2000):
        transforms.add(Maker(2).tree(("map", f"frame_{number}", (0, 0, 0), NONE)), False)
        transforms.add(Maker(2).tree(("map", "lidar", (number, 0, 0), NONE), stamp=number), False)
    assert len(transforms.frames()) == 1000
    assert transforms.pose("lidar", "map", 0).translation[0] == 1500


@pytest.mark.parametrize("storage", ["bag", "db3", "mcap", "mcap chunks"])
def test_a_driving_robot_in_a_recording(tmp_path, storage):
    def messages(maker):
        # What holds for the whole recording may be written at its end, and what moves after the first cloud.
        for number in range(4):
            time = BEGIN + 20 * number * SECOND
            yield "/points", time, maker.cloud(IN_FRONT, frame="map", stamp=time)
            transform = ("map", "base_link", (number, 0, 0), NONE)
            yield "/tf", time, maker.tree(transform, stamp=time)
        yield "/tf_static", time + 1, maker.tree(*ROBOT[2:])

    path = write(tmp_path / "drive", storage, messages)
    scenes, errors = split(read_scenes(path))
    assert errors == []
    assert np.allclose([scene.up for scene in scenes], (0, 0, 1))
    # Each message of /tf is recorded after the cloud with its time.
    assert np.allclose([scene.viewpoint[0] for scene in scenes], [0.2, 0.2, 1.2, 2.2])
    (last,), _ = split(read_scenes(path, start=60.0))
    assert last.viewpoint is not None


@pytest.mark.parametrize("storage", ["bag", "mcap"])
def test_depth_images_have_gravity_too(tmp_path, storage):
    def messages(maker):
        yield "/tf_static", BEGIN, maker.tree(*ROBOT)
        yield "/depth/camera_info", BEGIN, maker.info()
        yield "/depth/image", BEGIN, maker.image(np.full((3, 4), 1000, np.uint16), "16UC1")

    (scene,), _ = split(read_scenes(write(tmp_path / "depth", storage, messages)))
    assert np.allclose(scene.up, (0, -1, 0))
    assert np.array_equal(scene.viewpoint, np.zeros(3))
