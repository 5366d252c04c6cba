"""Time and memory of reading recordings, beside what rosbags takes alone.

    python benchmarks/recordings.py [--frames N] [--small N] [--repeats N]

Frames have 640 x 480 points, in the layout of a depth camera (16 bytes a point, organised), or are a depth
image of that size. Of each frame, "rosbags" is the time for reading and deserialising it, "reading" that of
the whole of `read_scenes`, and "ours" the median of the differences; in turns, over the repeats. Then, the
resident memory of a process before it reads a recording of many small frames, or a few hundred large ones,
and the most that it has until the end (Linux only). Needs 2 GB in the folder for temporary files.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore

from common import command, print_table
from shapeconcepts.recordings import read_scenes

HEIGHT, WIDTH = 480, 640
POINTS, DEPTHS, CAMERA = "/depth/points", "/depth/image_raw", "/depth/camera_info"
TYPES = {
    POINTS: "sensor_msgs/msg/PointCloud2",
    DEPTHS: "sensor_msgs/msg/Image",
    CAMERA: "sensor_msgs/msg/CameraInfo",
}
STORAGES = ("bag", "db3", "mcap", "mcap, zstd")
READ = """
import sys, time
from shapeconcepts.recordings import read_scenes
def memory(key):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith(key))
before, start = memory("VmRSS"), time.perf_counter()
n = sum(1 for scene in read_scenes(sys.argv[1], topic=sys.argv[2]))
print(n, time.perf_counter() - start, before, memory("VmHWM"))
"""


class Messages:
    """Messages of one generation of ROS."""

    def __init__(self, generation: int) -> None:
        self.store = get_typestore(Stores.ROS1_NOETIC if generation == 1 else Stores.ROS2_HUMBLE)
        self.types = self.store.types
        self._serialise = self.store.serialize_ros1 if generation == 1 else self.store.serialize_cdr
        self._sequence = (0,) if generation == 1 else ()

    def _header(self, number: int) -> object:
        stamp = self.types["builtin_interfaces/msg/Time"](
            1_700_000_000 + number // 30, number % 30 * 33_000_000
        )
        return self.types["std_msgs/msg/Header"](*self._sequence, stamp, "camera_depth_optical_frame")

    def points(self, number: int, height: int, width: int) -> bytes:
        """A serialised cloud."""
        data = np.random.default_rng(number).random((height, width, 4), np.float32)
        field = self.types["sensor_msgs/msg/PointField"]
        fields = [field(name, 4 * index, 7, 1) for index, name in enumerate("xyz")] + [field("rgb", 12, 7, 1)]
        message = self.types[TYPES[POINTS]](
            self._header(number),
            height,
            width,
            fields,
            False,
            16,
            16 * width,
            data.view(np.uint8).ravel(),
            False,
        )
        return bytes(self._serialise(message, TYPES[POINTS]))

    def depths(self, number: int) -> bytes:
        """A serialised depth image."""
        data = np.random.default_rng(number).integers(400, 4000, (HEIGHT, WIDTH), np.uint16)
        message = self.types[TYPES[DEPTHS]](
            self._header(number), HEIGHT, WIDTH, "16UC1", 0, 2 * WIDTH, data.view(np.uint8).ravel()
        )
        return bytes(self._serialise(message, TYPES[DEPTHS]))

    def camera(self) -> bytes:
        """The serialised camera of the depth images."""
        matrix = np.array([525.0, 0, 319.5, 0, 525.0, 239.5, 0, 0, 1])
        region = self.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        projection = np.zeros(12)
        message = self.types[TYPES[CAMERA]](
            self._header(0),
            HEIGHT,
            WIDTH,
            "plumb_bob",
            np.zeros(5),
            matrix,
            np.eye(3).ravel(),
            projection,
            0,
            0,
            region,
        )
        return bytes(self._serialise(message, TYPES[CAMERA]))


def write(folder: Path, storage: str, n: int, height: int, width: int, topics: tuple[str, ...]) -> Path:
    """A recording of n frames on each topic, 30 a second."""
    path = folder / f"{storage.replace(', ', '_')}_{n}_{height}"
    writer: BagWriter | Bag2Writer
    if storage == "bag":
        path = path.with_suffix(".bag")
        writer = BagWriter(path)
    else:
        plugin = StoragePlugin.SQLITE3 if storage == "db3" else StoragePlugin.MCAP
        writer = Bag2Writer(path, version=9, storage_plugin=plugin)
        if storage.endswith("zstd"):
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    messages = Messages(1 if storage == "bag" else 2)
    with writer:
        connections = {
            topic: writer.add_connection(topic, TYPES[topic], typestore=messages.store) for topic in topics
        }
        for number in range(n):
            moment = 1_700_000_000 * 10**9 + number * 33_333_333
            if CAMERA in topics and number == 0:
                writer.write(connections[CAMERA], moment, messages.camera())
            if POINTS in topics:
                writer.write(connections[POINTS], moment, messages.points(number, height, width))
            if DEPTHS in topics:
                writer.write(connections[DEPTHS], moment, messages.depths(number))
    return path


def library_frames(path: Path, topic: str) -> Iterator[object]:
    """Deserialised messages, without us."""
    with AnyReader([path]) as reader:
        connections = [connection for connection in reader.connections if connection.topic == topic]
        for connection, _, data in reader.messages(connections):
            yield reader.deserialize(data, connection.msgtype)


def milliseconds(frames: Iterator[object]) -> list[float]:
    """Of each frame but the first, which opens the recording."""
    times = []
    start = time.perf_counter()
    for _ in frames:
        times.append(1e3 * (time.perf_counter() - start))
        start = time.perf_counter()
    return times[1:]


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--frames", type=int, default=300, metavar="N", help="large ones, for the memory")
    parser.add_argument("--small", type=int, default=10_000, metavar="N", help="small ones, for the memory")
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for storage in STORAGES:
            path = write(Path(folder), storage, 20, HEIGHT, WIDTH, (POINTS, DEPTHS, CAMERA))
            for topic in (POINTS, DEPTHS):
                library, ours = [], []
                for _ in range(options.repeats):
                    library += milliseconds(library_frames(path, topic))
                    ours += milliseconds(read_scenes(path, topic=topic))
                alone, whole = np.median(library), np.median(ours)
                beyond = np.median(np.subtract(ours, library))
                rows.append((f"{storage} {topic}", f"{alone:.1f}", f"{whole:.1f}", f"{beyond:.1f}"))
    print_table(("ms for a frame of 307,200 points", "rosbags", "reading", "ours"), rows)
    print()
    rows = []
    for storage in STORAGES:
        for n, height, width in ((options.small, 24, 32), (options.frames, HEIGHT, WIDTH)):
            with tempfile.TemporaryDirectory() as folder:
                path = write(Path(folder), storage, n, height, width, (POINTS,))
                program = [sys.executable, "-c", READ, str(path), POINTS]
                done = subprocess.run(program, stdout=subprocess.PIPE, text=True, check=True)
            n_read, seconds, before, highest = done.stdout.split()
            rows.append(
                (
                    f"{storage}, {n_read} frames of {height * width} points",
                    f"{float(seconds):.1f}",
                    f"{float(before):.0f}",
                    f"{float(highest):.0f}",
                )
            )
    print_table(("reading a whole recording", "s", "MB before", "MB at most"), rows)


if __name__ == "__main__":
    main()
