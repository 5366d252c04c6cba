"""Where frames stand in each other, by /tf and /tf_static."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.recordings.message_types import stamp_of

# Of each frame, the last so many transforms are known: seconds of what robots send, while messages are late
# by tenths of them.
_MOST_TRANSFORMS = 500
# More than robots have.
_MOST_FRAMES = 1000


class Pose(NamedTuple):
    """Rotation (3, 3) and translation (3,) that take points of one frame into another."""

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


class _Known(NamedTuple):
    time: int
    parent: str
    # x, y, z; and of the quaternion x, y, z, w
    numbers: tuple[float, ...]


class Transforms:
    """The tree of frames as it was at any of the last moments."""

    def __init__(self) -> None:
        self._static: dict[str, _Known] = {}
        self._moving: dict[str, list[_Known]] = {}

    def __bool__(self) -> bool:
        return bool(self._static or self._moving)

    def add(self, message: Any, is_static: bool) -> None:
        """Take in a TFMessage; what is no transform in it is passed over."""
        for one in message.transforms:
            place, turn = one.transform.translation, one.transform.rotation
            numbers = tuple(map(float, (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w)))
            child, parent = str(one.child_frame_id).strip("/"), str(one.header.frame_id).strip("/")
            length = np.linalg.norm(numbers[3:])
            if child == parent or not np.isfinite(numbers).all() or not 0.5 < length < 2.0:
                continue
            if child not in self._static and child not in self._moving and len(self.frames()) >= _MOST_FRAMES:
                continue
            known = _Known(stamp_of(one), parent, numbers)
            if is_static:
                self._static[child] = known
            else:
                _insert(self._moving.setdefault(child, []), known)

    def frames(self) -> set[str]:
        """Frames that stand in another one."""
        return self._static.keys() | self._moving.keys()

    def ancestors(self, frame: str, time: int) -> list[str]:
        """A frame, the one in which it stood, and so on."""
        return [frame, *(known.parent for known in self._way_up(frame, time))]

    def pose(self, frame: str, other: str, time: int) -> Pose | None:
        """What takes points of a frame into another one at a time, ns since 1970; None if nothing does.

        Each transform on the way is the newest until then, or the first that is known.
        """
        up, up_other = self._way_up(frame, time), self._way_up(other, time)
        root = up[-1].parent if up else frame
        if root != (up_other[-1].parent if up_other else other):
            return None
        pose, back = _composed(up), _composed(up_other)
        return Pose(back.rotation.T @ pose.rotation, back.rotation.T @ (pose.translation - back.translation))

    def _way_up(self, frame: str, time: int) -> list[_Known]:
        way: list[_Known] = []
        seen = {frame}
        while (known := self._at(frame, time)) is not None and known.parent not in seen:
            way.append(known)
            frame = known.parent
            seen.add(frame)
        return way

    def _at(self, frame: str, time: int) -> _Known | None:
        if frame in self._static:
            return self._static[frame]
        history = self._moving.get(frame)
        if not history:
            return None
        return history[max(bisect_right(history, time, key=lambda known: known.time) - 1, 0)]


def _insert(history: list[_Known], known: _Known) -> None:
    """Add to a history in the order of time what is not in it yet, and forget the oldest."""
    place = bisect_left(history, known.time, key=lambda other: other.time)
    if place < len(history) and history[place].time == known.time:
        history[place] = known
        return
    history.insert(place, known)
    if len(history) > _MOST_TRANSFORMS:
        del history[0]


def _composed(way: list[_Known]) -> Pose:
    rotation, translation = np.eye(3), np.zeros(3)
    for known in way:
        turn = _rotation(known.numbers[3:])
        rotation, translation = turn @ rotation, turn @ translation + known.numbers[:3]
    return Pose(rotation, translation)


def _rotation(quaternion: tuple[float, ...]) -> NDArray[np.float64]:
    x, y, z, w = np.array(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def words(name: str) -> Iterator[str]:
    """Words in the name of a frame or topic: `camera1_depth_optical` has camera1, depth and optical."""
    return iter(name.lower().replace("/", "_").replace("-", "_").split("_"))
