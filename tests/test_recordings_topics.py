"""What is in a recording, which topic is read, and which of its scenes."""

import sqlite3
import subprocess
import sys

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import get_types_from_msg

from recording_examples import BEGIN, SECOND, STORES, Maker, clouds, file_in, numbers, split, write
from shapeconcepts import recordings
from shapeconcepts.recordings import Topic, is_recording, read_scenes, topics
from shapeconcepts.recordings import frames as frames_module
from shapeconcepts.recordings.library_storage import LibraryStorage
from shapeconcepts.scan import ScanError

CLOUD = "sensor_msgs/msg/PointCloud2"
DEPTHS = np.full((3, 4), 1000, np.uint16)


def robot(maker):
    """A recording with much in it."""
    yield "/camera/depth/points", BEGIN, maker.cloud(np.ones((4, 3)))
    yield "/lidar/points", BEGIN, maker.cloud(np.ones((4, 3)))
    yield "/lidar/points", BEGIN + SECOND, maker.cloud(np.ones((4, 3)), stamp=BEGIN + SECOND)
    yield "/camera/depth/camera_info", BEGIN, maker.info()
    yield "/camera/depth/image_raw", BEGIN, maker.image(DEPTHS, "16UC1")
    yield "/camera/color/image_raw", BEGIN, maker.image(np.zeros((3, 12), np.uint8), "rgb8", width=4)
    yield "/camera/color/image_raw/compressed", BEGIN, maker.compressed("rgb8; jpeg", b"\xff\xd8")


@pytest.mark.parametrize("storage", ["bag", "db3", "mcap", "mcap file"])
def test_topics_are_listed_with_what_they_are_good_for(tmp_path, storage):
    found = {topic.name: topic for topic in topics(write(tmp_path / "robot", storage, robot))}
    assert list(found) == sorted(found)
    assert found["/lidar/points"] == Topic("/lidar/points", CLOUD, 2, "points")
    assert found["/camera/depth/image_raw"] == Topic(
        "/camera/depth/image_raw", "sensor_msgs/msg/Image", 1, "depth", "/camera/depth/camera_info"
    )
    colour = found["/camera/color/image_raw"]
    assert (colour.kind, colour.count) == ("", 1)
    assert colour.refusal == "holds images of the encoding 'rgb8', expected depths: 16UC1 or mono16 or 32FC1"
    compressed = found["/camera/color/image_raw/compressed"]
    assert compressed.refusal.startswith("holds images of the format 'rgb8', expected depths")
    assert found["/camera/depth/camera_info"].kind == ""


def test_a_choice_is_the_users(tmp_path):
    path = write(tmp_path / "robot", "bag", robot)
    with pytest.raises(ScanError) as error:
        next(read_scenes(path))
    assert str(error.value) == (
        f"{path}: has several topics with scenes, choose one: "
        "/camera/depth/image_raw (Image, 1 message), /camera/depth/points (PointCloud2, 1 message), "
        "/lidar/points (PointCloud2, 2 messages)"
    )
    assert len(list(read_scenes(path, topic="/lidar/points"))) == 2
    assert len(list(read_scenes(path, topic="lidar/points"))) == 2
    (scene,) = read_scenes(path, topic="/camera/depth/image_raw")
    assert scene.points.shape == (3, 4, 3)


@pytest.mark.parametrize(
    ("topic", "told"),
    [
        ("/lidar", "has no topic /lidar, only /camera/depth/image_raw "),
        ("/camera/color/image_raw", "the topic /camera/color/image_raw holds images of the encoding 'rgb8'"),
        ("/camera/depth/camera_info", "holds sensor_msgs/msg/CameraInfo, expected point clouds or depth"),
    ],
)
def test_a_topic_that_cannot_be_read_is_told(tmp_path, topic, told):
    path = write(tmp_path / "robot", "mcap", robot)
    with pytest.raises(ScanError, match=told):
        next(read_scenes(path, topic=topic))


def test_a_recording_without_scenes_is_told(tmp_path):
    path = write(tmp_path / "log", "db3", lambda maker: list(robot(maker))[5:6])
    with pytest.raises(
        ScanError, match=r"has no topic with point clouds or depth images, only /camera/color"
    ):
        next(read_scenes(path))


@pytest.mark.parametrize("storage", ["bag", "db3", "mcap"])
def test_every_start_and_end(tmp_path, storage):
    path = write(tmp_path / "walk", storage, clouds(40))
    assert numbers(read_scenes(path, every=7)) == [0, 7, 14, 21, 28, 35]
    assert numbers(read_scenes(path, start=1.0, end=2.0)) == list(range(10, 20))
    assert numbers(read_scenes(path, every=4, start=3.0)) == [30, 34, 38]
    assert list(read_scenes(path, start=100.0)) == []
    assert numbers(read_scenes(path, end=1e300)) == list(range(40))


def test_what_is_not_wanted_is_not_deserialised(tmp_path, monkeypatch):
    path = write(tmp_path / "walk", "mcap", clouds(40))
    seen = []
    original = frames_module.deserialised
    monkeypatch.setattr(
        frames_module, "deserialised", lambda message: seen.append(message) or original(message)
    )
    assert len(list(read_scenes(path, every=10))) == 4
    assert len(seen) == 4


@pytest.mark.parametrize(
    "options",
    [
        {"every": 0},
        {"start": -1.0},
        {"end": float("nan")},
        {"start": 2.0, "end": 2.0},
    ],
)
def test_parameters_out_of_range(options):
    with pytest.raises(ValueError, match=next(iter(options))):
        read_scenes("walk.bag", **options)


@pytest.mark.parametrize("storage", ["bag", "mcap"])
def test_names_are_unique_and_fit_for_files(tmp_path, storage):
    def messages(maker):
        for number, stamp in enumerate((0, BEGIN, BEGIN, BEGIN + 5)):
            yield "/a b/../c", BEGIN + number, maker.cloud(np.ones((2, 3)), stamp=stamp)

    path = write(tmp_path / "my walk", storage, messages)
    scenes, errors = split(read_scenes(path))
    assert errors == []
    topic = "my_walk/a_b_.._c/"
    assert [scene.name for scene in scenes] == [
        # Without a stamp, the time of recording counts.
        f"{topic}1700000000_000000000",
        f"{topic}1700000000_000000000_2",
        f"{topic}1700000000_000000000_3",
        f"{topic}1700000000_000000005",
    ]
    assert scenes[0].time == BEGIN / SECOND


def test_what_is_a_recording(tmp_path):
    folder = write(tmp_path / "walk", "mcap", clouds(1))
    assert is_recording(folder)
    assert is_recording(str(folder / "walk.mcap"))
    assert is_recording("walk.bag")
    assert is_recording("WALK.DB3")
    assert not is_recording(tmp_path)
    assert not is_recording("scan.pcd")
    (folder / "metadata.yaml").unlink()
    assert not is_recording(folder)


@pytest.mark.parametrize("storage", ["db3", "mcap", "mcap chunks", "db3 messages", "mcap messages"])
def test_bare_files(tmp_path, storage):
    folder = write(tmp_path / "walk", storage, clouds(3))
    suffix = ".mcap" if "mcap" in storage else ".db3"
    assert numbers(read_scenes(folder / f"walk{suffix}")) == [0, 1, 2]


def test_types_that_nobody_knows_are_in_nobodys_way(tmp_path):
    STORES[1].register(get_types_from_msg("float64 grip", "robot/msg/Hand"))
    STORES[2].register(get_types_from_msg("float64 grip", "robot/msg/Hand"))

    def messages(maker):
        yield "/hand", BEGIN, maker.make("robot/msg/Hand", 0.5)
        yield from clouds(3)(maker)

    for storage in ("bag", "db3", "mcap"):
        path = write(tmp_path / storage, storage, messages)
        assert numbers(read_scenes(path)) == [0, 1, 2]
        assert ("/hand", "robot/msg/Hand", 1, "") in [topic[:4] for topic in topics(path)]


def test_a_bag_has_no_index_in_memory_of_what_is_not_read(tmp_path):
    def messages(maker):
        for number in range(500):
            yield "/hand", BEGIN + number, maker.make("std_msgs/msg/Float64", 0.5)
        yield from clouds(3)(maker)

    path = write(tmp_path / "walk", "bag", messages)
    storage = LibraryStorage(path)
    assert sum(map(len, storage._reader.indexes.values())) == 3
    storage.close()
    assert [topic.count for topic in topics(path)] == [3, 500]
    assert numbers(read_scenes(path)) == [0, 1, 2]


def test_a_database_of_an_older_ros_2_without_definitions(tmp_path):
    path = file_in(write(tmp_path / "walk", "db3", clouds(3)))
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE schema")
        database.execute("DROP TABLE message_definitions")
        database.execute("ALTER TABLE topics DROP COLUMN type_description_hash")
    database.close()
    scenes, errors = split(read_scenes(path))
    assert numbers(scenes) == [0, 1, 2]
    assert errors == []


def test_an_mcap_file_of_ros_1(tmp_path):
    maker = Maker(1)
    with Writer2(tmp_path / "walk", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/points", CLOUD, typestore=STORES[2], serialization_format="ros1")
        for _, time, message in clouds(3)(maker):
            writer.write(connection, time, STORES[1].serialize_ros1(message, CLOUD))
    path = tmp_path / "walk" / "walk.mcap"
    path.write_bytes(path.read_bytes().replace(b"ros2", b"ros1", 1))
    scenes, errors = split(read_scenes(path))
    assert numbers(scenes) == [0, 1, 2]
    assert errors == []


def test_messages_that_are_serialised_otherwise_are_told(tmp_path):
    with Writer2(tmp_path / "walk", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/points", CLOUD, typestore=STORES[2], serialization_format="json")
        writer.write(connection, BEGIN, b"{}")
    scenes, (error,) = split(read_scenes(tmp_path / "walk" / "walk.mcap"))
    assert scenes == []
    assert "is serialised as 'json', expected 'cdr' or 'ros1'" in error


@pytest.mark.parametrize("storage", ["db3", "mcap"])
def test_the_reader_of_an_upper_case_suffix(tmp_path, storage):
    folder = write(tmp_path / "walk", storage, clouds(3))
    file = next(file for file in folder.iterdir() if file.suffix != ".yaml")
    shouted = file.rename(folder / file.name.upper())
    assert numbers(read_scenes(shouted)) == [0, 1, 2]


def test_without_rosbags_the_extra_is_told(monkeypatch):
    monkeypatch.setattr("shapeconcepts.recordings.library.find_spec", lambda name: None)
    for read in (topics, lambda path: next(read_scenes(path))):
        with pytest.raises(ScanError, match=r'pip install "shapeconcepts\[recordings\]"'):
            read("walk.bag")


def test_rosbags_is_imported_when_it_is_needed():
    program = "import sys; from shapeconcepts.recordings import is_recording; is_recording('a.bag');"
    program += "print('rosbags' in sys.modules, 'numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_the_public_surface():
    assert recordings.__all__ == ["Topic", "is_recording", "read_scenes", "topics"]
