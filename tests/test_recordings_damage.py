"""Recordings that were cut off or are damaged give what they hold, and say so."""

import random
import sqlite3
import struct
import warnings

import numpy as np
import pytest

from recording_examples import BEGIN, STORAGES, clouds, file_in, numbers, split, write
from shapeconcepts.recordings import read_scenes, topics
from shapeconcepts.scan import ScanError

# About five blocks of a megabyte.
N, N_POINTS = 40, 10_000
CUT = [storage for storage in STORAGES if "file" not in storage]


def walk(tmp_path, storage, **changes):
    return write(tmp_path / "walk", storage, clouds(N, n_points=N_POINTS, **changes))


def cut(file, share):
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * share)])


@pytest.mark.parametrize("is_bare", [False, True])
@pytest.mark.parametrize("share", [0.5, 0.97])
@pytest.mark.parametrize("storage", CUT)
def test_a_recording_that_was_cut_off(tmp_path, storage, share, is_bare):
    path = walk(tmp_path, storage)
    cut(file_in(path), share)
    path = file_in(path) if is_bare else path
    scenes, errors = split(read_scenes(path))
    found = numbers(scenes)
    assert found == list(range(len(found)))
    # Of a compressed block, nothing may be left; each holds nearly a fifth of the recording.
    assert N * share - 10 <= len(found) <= N
    (error,) = errors
    assert error.startswith(f"{path}: ")
    assert error.endswith(f": it gave {len(found)} messages on /camera/depth/points")


def test_what_is_said_of_a_bag(tmp_path):
    path = walk(tmp_path, "bag")
    cut(path, 0.5)
    _, (error,) = split(read_scenes(path, topic="/camera/depth/points"))
    assert "ends within a record at byte " in error


def test_a_chunk_without_compression_gives_its_beginning(tmp_path):
    for storage in ("bag", "mcap"):
        path = walk(tmp_path, storage)
        cut(file_in(path), 0.5)
        scenes, _ = split(read_scenes(path))
        assert len(scenes) in (19, 20)


@pytest.mark.parametrize("storage", ["bag", "mcap"])
def test_every_place_to_cut(tmp_path, storage):
    path = write(tmp_path / "walk", storage, clouds(4))
    file = file_in(path)
    data = file.read_bytes()
    found = []
    for end in range(0, len(data), 61):
        file.write_bytes(data[:end])
        try:
            scenes, errors = split(read_scenes(file))
        except ScanError:
            continue
        assert numbers(scenes) == list(range(len(scenes)))
        found.append(len(scenes))
        # Behind the last message, the index may be missing without a loss.
        assert errors or len(scenes) == 4
    assert found == sorted(found)
    assert found[-1] == 4


def test_a_bag_that_was_not_closed(tmp_path):
    path = walk(tmp_path, "bag lz4")
    data = bytearray(path.read_bytes())
    begin = data.index(b"index_pos=") + len(b"index_pos=")
    data[begin : begin + 8] = bytes(8)
    path.write_bytes(data)
    scenes, errors = split(read_scenes(path))
    assert numbers(scenes) == list(range(N))
    assert errors == [f"{path}: was not closed by its recorder: it gave {N} messages on /camera/depth/points"]


def mcap_without_summary(path):
    file = file_in(path)
    data = file.read_bytes()
    # The data end with this record.
    end = data.rindex(b"\x0f\x04" + bytes(11))
    file.write_bytes(data[:end])
    return file


def test_an_mcap_file_without_a_footer(tmp_path):
    file = mcap_without_summary(walk(tmp_path, "mcap chunks"))
    scenes, (error,) = split(read_scenes(file))
    assert numbers(scenes) == list(range(N))
    assert "before the recording does" in error


def test_an_mcap_file_without_chunks_in_no_order(tmp_path):
    path = write(tmp_path / "walk", "mcap", clouds(4))
    data = file_in(path).read_bytes()
    head = 8 + 9 + int.from_bytes(data[9:17], "little")
    chunk = head + 9 + 28 + 4 + 8
    size = int.from_bytes(data[chunk - 8 : chunk], "little")
    records = data[chunk : chunk + size]
    pieces, position = [], 0
    while position < size:
        end = position + 9 + int.from_bytes(records[position + 1 : position + 9], "little")
        pieces.append(records[position:end])
        position = end
    definitions, messages = [p for p in pieces if p[0] != 5], [p for p in pieces if p[0] == 5]
    footer = b"\x02" + struct.pack("<QQQI", 20, 0, 0, 0)
    file = tmp_path / "loose.mcap"
    file.write_bytes(data[:head] + b"".join(definitions + messages[::-1]) + footer + b"\x89MCAP0\r\n")
    scenes, errors = split(read_scenes(file))
    assert errors == []
    assert numbers(scenes) == [0, 1, 2, 3]


# What begins a compressed block or message.
STARTS = {"lz4": b"\x04\x22\x4d\x18", "bz2": b"BZh9", "zstd": b"\x28\xb5\x2f\xfd"}


@pytest.mark.parametrize(
    ("storage", "compression"),
    [
        ("bag lz4", "lz4"),
        ("bag bz2", "bz2"),
        ("mcap chunks", "zstd"),
        ("mcap messages", "zstd"),
        ("db3 messages", "zstd"),
    ],
)
def test_what_is_damaged_in_the_middle_is_left_out(tmp_path, storage, compression):
    path = walk(tmp_path, storage)
    data = file_in(path).read_bytes()
    place = data.index(STARTS[compression], len(data) // 2)
    file_in(path).write_bytes(data[:place] + b"\xff" * 8 + data[place + 8 :])
    scenes, errors = split(read_scenes(path))
    found = numbers(scenes)
    assert found == sorted(set(found))
    assert N - 10 <= len(found) < N
    assert {0, 1, N - 2, N - 1} <= set(found)
    assert any("it gave " in error for error in errors)


def test_a_database_with_a_damaged_page(tmp_path):
    path = walk(tmp_path, "db3")
    file = file_in(path)
    data = bytearray(file.read_bytes())
    place = len(data) // 2 // 4096 * 4096
    data[place : place + 4096] = b"\xff" * 4096
    file.write_bytes(data)
    scenes, errors = split(read_scenes(path))
    assert len(scenes) == N - 1
    (error,) = errors
    assert "cannot be read behind message " in error


@pytest.mark.parametrize("storage", list(STORAGES))
def test_one_bad_message_is_said_and_the_others_are_read(tmp_path, storage):
    def messages(maker):
        for number, (topic, time, message) in enumerate(clouds(6)(maker)):
            bad = (message.__msgtype__, b"\0\1\0\0 no message")
            yield topic, time, bad if number == 2 else message

    path = write(tmp_path / "walk", storage, messages)
    results = list(read_scenes(path))
    assert [type(result) for result in results].index(ScanError) == 2
    scenes, errors = split(results)
    assert numbers(scenes) == [0, 1, 3, 4, 5]
    (error,) = errors
    assert error.startswith(
        f"{path}: /camera/depth/points at 1700000000.200 s: is no sensor_msgs/msg/PointCloud2 message ("
    )


def test_bad_transforms_and_cameras_are_said(tmp_path):
    def messages(maker):
        yield "/tf", BEGIN, ("tf2_msgs/msg/TFMessage", b"\0\1\0\0\xff\xff\xff\x7f")
        yield "/points", BEGIN + 1, maker.cloud(np.ones((3, 3)))

    scenes, (error,) = split(read_scenes(write(tmp_path / "walk", "mcap", messages)))
    assert len(scenes) == 1
    assert "/tf at 1700000000.000 s: is no tf2_msgs/msg/TFMessage message" in error


def test_a_split_recording_of_which_one_file_is_damaged(tmp_path):
    first = write(tmp_path / "walk", "mcap", clouds(4))
    whole = file_in(first)
    later = write(tmp_path / "later", "mcap", lambda maker: list(clouds(8)(maker))[4:])
    second = file_in(later).rename(first / "walk_1.mcap")
    whole.rename(first / "walk_0.mcap")
    (first / "metadata.yaml").write_text("nothing: []")
    assert numbers(read_scenes(first)) == list(range(8))
    cut(first / "walk_0.mcap", 0.5)
    scenes, (error,) = split(read_scenes(first))
    assert set(numbers(scenes)) >= {4, 5, 6, 7}
    assert "walk_0.mcap ends within a record" in error
    second.write_bytes(b"")
    _, (error,) = split(read_scenes(first))
    assert "walk_0.mcap ends within a record" in error


def test_a_log_beside_a_database_is_said(tmp_path):
    path = write(tmp_path / "walk", "db3", clouds(3))
    file_in(path).with_name("walk.db3-wal").write_bytes(b"log")
    scenes, (error,) = split(read_scenes(path))
    assert len(scenes) == 3
    assert "the latest messages are in walk.db3-wal, which is not read" in error


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
@pytest.mark.parametrize(
    "content", [b"", b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n", b"version https://git-lfs", bytes(5000)]
)
def test_what_is_no_recording_is_told(tmp_path, suffix, content):
    path = tmp_path / f"walk{suffix}"
    path.write_bytes(content)
    for read in (topics, lambda path: list(read_scenes(path))):
        with pytest.raises(ScanError, match=rf"walk\{suffix}: "):
            read(path)


def test_a_database_of_something_else(tmp_path):
    path = tmp_path / "walk.db3"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE other (id INTEGER)")
    database.close()
    with pytest.raises(ScanError, match=r"walk\.db3: is no database that can be read"):
        topics(path)


@pytest.mark.parametrize("path", ["missing.bag", "missing.mcap", "scan.pcd", "."])
def test_what_is_not_there_is_told(tmp_path, path):
    with pytest.raises(ScanError, match=r"there is no such file|is no recording"):
        topics(tmp_path / path)


@pytest.mark.parametrize("storage", ["bag", "bag lz4", "db3", "mcap", "mcap chunks"])
def test_bytes_that_are_wrong_anywhere_are_never_anything_but_an_error(tmp_path, storage):
    path = write(tmp_path / "walk", storage, clouds(6))
    file = file_in(path)
    data = file.read_bytes()
    generator = random.Random(storage)
    with warnings.catch_warnings():
        # numpy says of bytes that became huge numbers that they are.
        warnings.simplefilter("error")
        for _ in range(150):
            wrong = bytearray(data)
            for _ in range(generator.choice((1, 1, 8, 200))):
                wrong[generator.randrange(len(wrong))] = generator.randrange(256)
            file.write_bytes(wrong)
            try:
                list(read_scenes(file, topic=generator.choice((None, "/camera/depth/points"))))
            except ScanError:
                continue
