"""A topic of a recording, and which one is meant."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple

from shapeconcepts.scan import ScanError

Kind = Literal["points", "depth", ""]


class Topic(NamedTuple):
    """What a recording holds under one name.

    Attributes
    ----------
    name : str
        Such as `/camera/depth/points`.
    type : str
        Of its messages, such as `sensor_msgs/msg/PointCloud2`.
    count : int
        Number of messages.
    kind : "points", "depth" or ""
        What scenes are read from; empty where none are.
    camera_info : str
        Of a depth image: the topic with its camera's intrinsics; empty where there is none.
    refusal : str
        Why its images are not read, for example as they are in colour; empty where they are, or where its
        messages are none.
    """

    name: str
    type: str
    # Hides that of tuples, which nobody asks a topic.
    count: int  # type: ignore[assignment]
    kind: Kind = ""
    camera_info: str = ""
    refusal: str = ""


def chosen(path: Path, topics: Sequence[Topic], name: str | None) -> Topic:
    """The topic of this name, with or without its first slash, or the only one that scenes are read from.

    Raises
    ------
    ScanError
        If there is no such topic, or several, with a list; or no camera is known for its depth images.
    """
    usable = [topic for topic in topics if topic.kind and topic.count]
    if name is not None:
        named = [topic for topic in topics if topic.name.strip("/") == name.strip("/")]
        if not named:
            listed = _listed(usable or topics)
            raise ScanError(f"{path}: has no topic {name}, only {listed}")
        topic = next((one for one in named if one in usable), named[0])
        if topic not in usable:
            reason = topic.refusal or (
                "holds no messages"
                if topic.kind
                else f"holds {topic.type}, expected point clouds or depth images"
            )
            raise ScanError(f"{path}: the topic {topic.name} {reason}")
    elif len(usable) == 1:
        topic = usable[0]
    elif usable:
        raise ScanError(f"{path}: has several topics with scenes, choose one: {_listed(usable)}")
    else:
        raise ScanError(
            f"{path}: has no topic with point clouds or depth images, only {_listed(topics) or 'empty ones'}"
        )
    if topic.kind == "depth" and not topic.camera_info:
        raise ScanError(
            f"{path}: the topic {topic.name} has no CameraInfo beside it, in its namespace or with its frame"
        )
    return topic


def counted(n_messages: int) -> str:
    """A number of messages in words."""
    return "1 message" if n_messages == 1 else f"{n_messages} messages"


def _listed(topics: Sequence[Topic]) -> str:
    entries = []
    for topic in topics:
        detail = f" ({topic.refusal})" if topic.refusal else ""
        entries.append(f"{topic.name} ({topic.type.rpartition('/')[2]}, {counted(topic.count)}){detail}")
    return ", ".join(entries)
