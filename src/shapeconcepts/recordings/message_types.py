"""The few types of messages that are read, and how they become objects.

They have been the same in all versions of ROS, so that definitions in a file are not needed. They are not
used either: rosbags makes programs of them, and a recording may come from anywhere.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from shapeconcepts.recordings.block_content import unpacked_message
from shapeconcepts.recordings.storage import CDR, ROS1, Message
from shapeconcepts.scan import ScanError

POINT_CLOUD = "sensor_msgs/msg/PointCloud2"
IMAGE = "sensor_msgs/msg/Image"
COMPRESSED_IMAGE = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
# Before tf2, with the same content.
OLD_TRANSFORMS = "tf/msg/tfMessage"

TYPES = (POINT_CLOUD, IMAGE, COMPRESSED_IMAGE, CAMERA_INFO, TRANSFORMS, OLD_TRANSFORMS)


def deserialised(message: Message) -> Any:
    """A message as rosbags makes it, with its bytes as views; ScanError, without a name, where it is none."""
    kind = TRANSFORMS if message.channel.type == OLD_TRANSFORMS else message.channel.type
    data = unpacked_message(message.data)
    try:
        if message.channel.encoding == ROS1:
            return _typestore(ROS1).deserialize_ros1(data, kind)
        if message.channel.encoding == CDR:
            return _typestore(CDR).deserialize_cdr(data, kind)
    except Exception as error:  # rosbags raises what its generated programs do, too
        raise ScanError(f"is no {kind} message ({error})") from None
    raise ScanError(f"is serialised as {message.channel.encoding!r}, expected {CDR!r} or {ROS1!r}")


def stamp_of(message: Any) -> int:
    """Time in a message's header, ns since 1970; 0 where it was not set."""
    stamp = message.header.stamp
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def frame_of(message: Any) -> str:
    """Frame in a message's header; in ROS 1 it may begin with a slash."""
    return str(message.header.frame_id).strip("/")


@cache
def _typestore(encoding: str) -> Any:
    if encoding == CDR:
        return get_typestore(Stores.ROS2_HUMBLE)
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TRANSFORMS))
    return store
