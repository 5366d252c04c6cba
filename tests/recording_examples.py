"""Recordings for tests, written by rosbags' own writers."""

from __future__ import annotations

import struct
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("rosbags")

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from shapeconcepts.scan import ScanError
from shapeconcepts.scene import Scene

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
STORES = {1: get_typestore(Stores.ROS1_NOETIC), 2: get_typestore(Stores.ROS2_HUMBLE)}
STORES[1].register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)
# Every storage that rosbags writes, as (generation, plugin, compression).
STORAGES = {
    "bag": (1, None, None),
    "bag lz4": (1, None, Writer1.CompressionFormat.LZ4),
    "bag bz2": (1, None, Writer1.CompressionFormat.BZ2),
    "db3": (2, StoragePlugin.SQLITE3, CompressionMode.NONE),
    "db3 messages": (2, StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
    "db3 file": (2, StoragePlugin.SQLITE3, CompressionMode.FILE),
    "mcap": (2, StoragePlugin.MCAP, CompressionMode.NONE),
    "mcap chunks": (2, StoragePlugin.MCAP, CompressionMode.STORAGE),
    "mcap messages": (2, StoragePlugin.MCAP, CompressionMode.MESSAGE),
    "mcap file": (2, StoragePlugin.MCAP, CompressionMode.FILE),
}
TYPE_NUMBERS = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}


class Maker:
    """Makes messages of one generation of ROS."""

    def __init__(self, generation: int) -> None:
        self.generation = generation
        self._types = STORES[generation].types

    def make(self, kind: str, *values: object, **named: object) -> object:
        return self._types[kind](*values, **named)

    def header(self, stamp: int = BEGIN, frame: str = "camera_depth_optical_frame") -> object:
        time = self.make("builtin_interfaces/msg/Time", stamp // SECOND, stamp % SECOND)
        sequence = (0,) if self.generation == 1 else ()
        return self.make("std_msgs/msg/Header", *sequence, time, frame)

    def cloud(self, points: np.ndarray, fields: list | None = None, **changes: object) -> object:
        """A PointCloud2: of an array (..., 3) as float32, or a structured one with its own layout."""
        header = self.header(changes.pop("stamp", BEGIN), changes.pop("frame", "camera_depth_optical_frame"))
        if points.dtype.names is None:
            plain = np.ascontiguousarray(points, dtype=np.float32)
            points = plain.view([("x", "f4"), ("y", "f4"), ("z", "f4")])[..., 0]
        grid = points if points.ndim == 2 else points[None]
        if fields is None:
            fields = [
                (name, offset, TYPE_NUMBERS[kind.str[1:]], 1)
                for name, (kind, offset) in points.dtype.fields.items()
            ]
        gap = changes.pop("row_gap", 0)
        rows = grid.view(np.uint8).reshape(len(grid), -1) if grid.size else np.zeros((len(grid), 0), np.uint8)
        rows = np.pad(rows, ((0, 0), (0, gap)), constant_values=0xAB)
        values = {
            "header": header,
            "height": grid.shape[0],
            "width": grid.shape[1],
            "fields": [self.make("sensor_msgs/msg/PointField", *field) for field in fields],
            "is_bigendian": False,
            "point_step": points.dtype.itemsize,
            "row_step": rows.shape[1],
            "data": rows.reshape(-1),
            "is_dense": False,
        }
        return self.make("sensor_msgs/msg/PointCloud2", **{**values, **changes})

    def image(self, pixels: np.ndarray, encoding: str, **changes: object) -> object:
        """An Image of an array (h, w)."""
        header = self.header(changes.pop("stamp", BEGIN), changes.pop("frame", "camera_depth_optical_frame"))
        gap = changes.pop("row_gap", 0)
        rows = np.pad(np.ascontiguousarray(pixels).view(np.uint8), ((0, 0), (0, gap)), constant_values=0xAB)
        values = {
            "header": header,
            "height": len(pixels),
            "width": pixels.shape[1],
            "encoding": encoding,
            "is_bigendian": int(pixels.dtype.byteorder == ">"),
            "step": rows.shape[1],
            "data": rows.reshape(-1),
        }
        return self.make("sensor_msgs/msg/Image", **{**values, **changes})

    def compressed(self, form: str, data: bytes) -> object:
        return self.make(
            "sensor_msgs/msg/CompressedImage", self.header(), form, np.frombuffer(data, np.uint8)
        )

    def info(self, size=(4, 3), focal=(500.0, 510.0), centre=(1.5, 1.0), distortion=(), **changes) -> object:
        (fx, fy), (cx, cy) = focal, centre
        matrix = np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1.0])
        frame = changes.pop("frame", "camera_depth_optical_frame")
        region = self.make("sensor_msgs/msg/RegionOfInterest", *changes.pop("region", (0, 0, 0, 0)), False)
        return self.make(
            "sensor_msgs/msg/CameraInfo",
            self.header(frame=frame),
            size[1],
            size[0],
            "plumb_bob",
            np.array(distortion, np.float64),
            matrix,
            np.eye(3).reshape(-1),
            np.array(changes.pop("projection", np.zeros(12)), np.float64),
            *changes.pop("binning", (0, 0)),
            region,
        )

    def tree(self, *transforms: tuple, stamp: int = BEGIN) -> object:
        """A TFMessage of (parent, child, translation, quaternion x y z w)."""
        made = []
        for parent, child, place, turn in transforms:
            translation = self.make("geometry_msgs/msg/Vector3", *map(float, place))
            rotation = self.make("geometry_msgs/msg/Quaternion", *map(float, turn))
            transform = self.make("geometry_msgs/msg/Transform", translation, rotation)
            made.append(
                self.make("geometry_msgs/msg/TransformStamped", self.header(stamp, parent), child, transform)
            )
        return self.make("tf2_msgs/msg/TFMessage", made)


def write(path, storage, messages):
    """Write (topic, time, message) to a recording: `messages` makes them with a Maker; gives its path."""
    generation, plugin, compression = STORAGES[storage]
    store = STORES[generation]
    if generation == 1:
        path = path.with_suffix(".bag")
        writer = Writer1(path)
        if compression is not None:
            writer.set_compression(compression)
    else:
        writer = Writer2(path, version=9, storage_plugin=plugin)
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, time, message in messages(Maker(generation)):
            kind, data = message if isinstance(message, tuple) else (message.__msgtype__, None)
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            if data is None:
                data = (store.serialize_ros1 if generation == 1 else store.serialize_cdr)(message, kind)
            writer.write(connections[topic], time, data)
    return path


def file_in(path):
    """The file with the messages in the folder of a rosbag2."""
    return path if path.is_file() else next(file for file in path.iterdir() if file.name != "metadata.yaml")


def clouds(n, topic="/camera/depth/points", n_points=5, **changes):
    """Makes n clouds, ten a second, of which each holds its number."""

    def messages(maker):
        for number in range(n):
            points = np.random.default_rng(number).normal(size=(n_points, 3))
            points[0] = number + 1.0
            time = BEGIN + number * SECOND // 10
            yield topic, time, maker.cloud(points, stamp=time, **changes)

    return messages


def split(results):
    """Scenes and errors."""
    results = list(results)
    return (
        [result for result in results if isinstance(result, Scene)],
        [str(result) for result in results if isinstance(result, ScanError)],
    )


def numbers(scenes):
    """Numbers of `clouds`."""
    return [int(scene.points[0, 0]) - 1 for scene in scenes]


def png(pixels):
    stream = BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


def compressed_depth(pixels, factor=0.0, offset=0.0):
    """Data of compressedDepth."""
    return struct.pack("<i2f", 0, factor, offset) + png(pixels)
