"""Turns the messages on one topic into scenes, with what the other topics say about them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from itertools import islice

import numpy as np

from shapeconcepts.recordings.camera import Camera, camera_of
from shapeconcepts.recordings.depth_message import compressed_depths, image_depths
from shapeconcepts.recordings.message_types import (
    IMAGE,
    OLD_TRANSFORMS,
    POINT_CLOUD,
    TRANSFORMS,
    deserialised,
    frame_of,
    stamp_of,
)
from shapeconcepts.recordings.placement import placement, up_direction
from shapeconcepts.recordings.point_cloud import cloud_points
from shapeconcepts.recordings.recording import Recording
from shapeconcepts.recordings.recording_path import safe_name
from shapeconcepts.recordings.storage import Message
from shapeconcepts.recordings.topic import Topic
from shapeconcepts.recordings.transforms import Transforms
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.scene import Scene

_SECOND = 10**9
# Messages about the first scene are looked for so long before and after it, ns.
_BEFORE, _AFTER = 10 * _SECOND, _SECOND
_LATEST = 2**63 - 1


class Frames:
    """The scenes on a topic of a recording.

    Attributes
    ----------
    n_messages : int
        Read so far on the topic, those that were left out included.
    """

    def __init__(self, recording: Recording, topic: Topic) -> None:
        self.n_messages = 0
        self._recording = recording
        self._topic = topic
        self._transforms = Transforms()
        self._camera: Camera | None = None
        self._is_rectified = "rect" in topic.name.rpartition("/")[2] or "/image_rect" in topic.name
        self._says_distortion = True
        self._moments: set[int] = set()
        self._trees = {
            channel.topic
            for channel in recording.channels
            if channel.type in (TRANSFORMS, OLD_TRANSFORMS)
            and channel.topic.rpartition("/")[2] in ("tf", "tf_static")
        }
        self._infos = {topic.camera_info} if topic.camera_info else set()

    def scenes(self, every: int, start: float | None, end: float | None) -> Iterator[Scene | ScanError]:
        """Scenes and errors as of `read_scenes`, but for damage of the recording."""
        first = self._recording.start
        begin, stop = (None if seconds is None else _after(first, seconds) for seconds in (start, end))
        self._look_around(first if begin is None else begin)
        topics = {self._topic.name} | self._trees | self._infos
        for message in self._recording.messages(topics, begin, stop):
            try:
                scene = self._taken_in(message, every)
            except ScanError as error:
                yield error
                continue
            if scene is not None:
                yield scene

    def _look_around(self, begin: int) -> None:
        """Take in what was said about the first scene beside it, and what holds for the whole recording."""
        static = {name for name in self._trees if name.endswith("tf_static")}
        for message in self._recording.messages(static):
            self._learn(message)
        for name in self._infos:
            for message in islice(self._recording.messages({name}), 1):
                self._learn(message)
        around = self._recording.messages(
            (self._trees - static) | self._infos, max(begin - _BEFORE, 0), min(begin + _AFTER, _LATEST)
        )
        for message in around:
            # Of cameras, the one after the first scene counts only if there is none before.
            if message.channel.topic not in self._infos or message.time <= begin:
                self._learn(message)

    def _learn(self, message: Message) -> None:
        """As `_taken_in`, of a message that is read once more in its turn."""
        with suppress(ScanError):
            self._taken_in(message, 1)

    def _taken_in(self, message: Message, every: int) -> Scene | None:
        """The scene of a message, if it is the turn of one; ScanError says why there is none."""
        title = f"{self._recording.path}: {message.channel.topic} at {message.time / _SECOND:.3f} s"
        with scan_errors(title, "read"):
            try:
                return self._content(message, every)
            except ScanError as error:
                raise ScanError(f"{title}: {error}") from None

    def _content(self, message: Message, every: int) -> Scene | None:
        topic = message.channel.topic
        if topic in self._trees:
            self._transforms.add(deserialised(message), topic.endswith("tf_static"))
        elif topic in self._infos:
            self._camera = camera_of(deserialised(message), self._is_rectified)
        elif message.channel.type == self._topic.type:
            self.n_messages += 1
            if (self.n_messages - 1) % every == 0:
                return self._scene(message)
        return None

    def _scene(self, message: Message) -> Scene:
        content = deserialised(message)
        time = stamp_of(content) or message.time
        frame = frame_of(content)
        labels, notices = None, tuple[str, ...]()
        if message.channel.type == POINT_CLOUD:
            points, labels, notices = cloud_points(content)
            viewpoint, up = placement(points, frame, self._topic.name, time, self._transforms)
        else:
            depths = image_depths(content) if message.channel.type == IMAGE else compressed_depths(content)
            if self._camera is None:
                raise ScanError(f"has no CameraInfo on {self._topic.camera_info} that can be used")
            points, viewpoint = self._camera.points(depths), np.zeros(3)
            up, notices = up_direction(frame, time, self._transforms), self._distortion()
        if not np.isfinite(points[..., 2]).any():
            raise ScanError("holds no point with finite x, y and z")
        return Scene(points, viewpoint, up, self._name(time), time / _SECOND, labels, notices)

    def _distortion(self) -> tuple[str, ...]:
        """Said once."""
        if self._camera is None or not self._camera.is_distorted or not self._says_distortion:
            return ()
        self._says_distortion = False
        return (
            "has a camera with lens distortion (D is not 0): points near the border are displaced; rectified "
            "images (image_rect) are better",
        )

    def _name(self, time: int) -> str:
        """Unique, as names of files are made from it."""
        moment = f"{time // _SECOND}_{time % _SECOND:09d}"
        if time in self._moments:
            moment += f"_{self.n_messages}"
        self._moments.add(time)
        return safe_name(self._recording.path, self._topic.name, moment)


def _after(begin: int, seconds: float) -> int:
    """A time so many seconds later, ns, or the latest that a recording can have."""
    return min(begin + round(min(seconds, _LATEST / _SECOND) * _SECOND), _LATEST)
