"""Finds out what is on the topics of a recording, by the first message of those that may be of use."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os.path import commonpath
from typing import Any, NamedTuple

from shapeconcepts.recordings.depth_message import refusal_of_encoding, refusal_of_format
from shapeconcepts.recordings.message_types import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    POINT_CLOUD,
    deserialised,
    frame_of,
)
from shapeconcepts.recordings.recording import Recording
from shapeconcepts.recordings.topic import Topic
from shapeconcepts.scan import ScanError

# What image_transport appends to the topic of an image.
_TRANSPORTS = ("compressed", "compressedDepth")
# The header of compressed depths, and what tells of an image.
_BYTES_THAT_TELL = 64


class _Info(NamedTuple):
    name: str
    frame: str
    size: tuple[int, int]


def listed_topics(recording: Recording) -> list[Topic]:
    """Topics of a recording in the order of their names, each with what it is good for."""
    counts: dict[tuple[str, str], int] = {}
    for channel in recording.channels:
        what = (channel.topic, channel.type)
        counts[what] = counts.get(what, 0) + channel.n_messages
    infos = [
        _Info(name, frame_of(message), (int(message.width), int(message.height)))
        for name, kind in counts
        if kind == CAMERA_INFO and (message := _first(recording, name, kind)) is not None
    ]
    return [_topic(recording, Topic(*what, count), infos) for what, count in sorted(counts.items())]


def _topic(recording: Recording, topic: Topic, infos: Sequence[_Info]) -> Topic:
    if topic.type == POINT_CLOUD:
        return topic._replace(kind="points")
    if topic.type not in _REFUSALS or not topic.count:
        return topic
    if (message := _first(recording, topic.name, topic.type)) is None:
        return topic._replace(refusal="begins with a message that cannot be read")
    if refusal := _REFUSALS[topic.type](message):
        return topic._replace(refusal=refusal)
    size = (int(message.width), int(message.height)) if topic.type == IMAGE else None
    return topic._replace(kind="depth", camera_info=_camera_info(topic.name, frame_of(message), size, infos))


_REFUSALS: dict[str, Callable[[Any], str]] = {
    IMAGE: lambda message: refusal_of_encoding(str(message.encoding)),
    COMPRESSED_IMAGE: lambda message: refusal_of_format(
        str(message.format), message.data[:_BYTES_THAT_TELL].tobytes()
    ),
}


def _camera_info(topic: str, frame: str, size: tuple[int, int] | None, infos: Sequence[_Info]) -> str:
    """The topic of the CameraInfo in the namespace of an image, or else of those with its frame.

    Of these, first come those with its size, and then those whose name has more of its beginning.
    """
    names = {info.name for info in infos}
    parts = topic.split("/")
    image = parts[:-1] if parts[-1] in _TRANSPORTS else parts
    for namespace in dict.fromkeys(("/".join(image[:-1]), "/".join(parts[:-1]))):
        if (name := f"{namespace}/camera_info" if namespace or topic[:1] == "/" else "camera_info") in names:
            return name
    same_frame = [info for info in infos if info.frame == frame]
    best = max(
        same_frame,
        key=lambda info: (info.size == size, len(commonpath([info.name.strip("/"), topic.strip("/")]))),
        default=None,
    )
    return best.name if best else ""


def _first(recording: Recording, name: str, kind: str) -> Any:
    """The first message on a topic that is one; None where the recording holds none."""
    for message in recording.messages({name}):
        if message.channel.type == kind:
            try:
                return deserialised(message)
            except ScanError:
                continue
    return None
