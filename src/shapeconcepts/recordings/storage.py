"""What every way to read the file of a recording offers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple, Protocol

# How messages are serialised: as ROS 2 does it, and as ROS 1 did.
CDR, ROS1 = "cdr", "ros1"


class Channel(NamedTuple):
    """What one publisher sent on one topic; `id` is that within its storage."""

    id: int
    topic: str
    type: str
    encoding: str
    n_messages: int = 0


class Message(NamedTuple):
    """A serialised message, and when it was recorded, ns since 1970."""

    channel: Channel
    time: int
    data: bytes | memoryview


class Storage(Protocol):
    """An open file of a recording, or several that follow each other."""

    @property
    def channels(self) -> list[Channel]:
        """All that was recorded."""

    @property
    def start(self) -> int:
        """Time of the first message, ns since 1970."""

    @property
    def damage(self) -> str:
        """What is missing and why; empty where nothing is known to be."""

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """Messages of channels from `start` on, and before `stop`, one at a time, in the order of time.

        May raise anything where the file is damaged.
        """

    def close(self) -> None:
        """Close the file."""


def normal_type(name: str) -> str:
    """Name of a message type as ROS 2 has it: `sensor_msgs/msg/Image`, in ROS 1 `sensor_msgs/Image`."""
    package, slash, kind = name.partition("/")
    return f"{package}/msg/{kind}" if slash and "/" not in kind else name
