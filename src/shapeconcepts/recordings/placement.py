"""Where the sensor of a cloud stood, and which way was up, by its frame and the tree of frames.

The rules:

* up is the z axis of the frame nearest the root of the tree that REP 105 says has it upwards: `map`, `odom`,
  `world`, `base_link` or `base_footprint`. Without transforms, or without such a frame, it is not known.
* The sensor stands in the origin of a frame with a sensor's name (`camera_depth_optical_frame`, `velodyne`).
* A cloud in another frame was turned into that one. Its sensor is a frame below it with a sensor's name,
  where there is one, or all of them are close together, or one shares a word with the topic that the others
  lack.
* Where nothing is known of the frame, the origin is taken if the points look as if a camera there had seen
  them (z forward), and no other frame stands in it. Frames that REP 105 knows are no
  sensor's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.viewpoint import camera_frame_viewpoint
from shapeconcepts.recordings.transforms import Transforms, words

_UPRIGHT = ("map", "odom", "world", "base_link", "base_footprint")
_SENSORS = (
    "camera",
    "sensor",
    "optical",
    "depth",
    "lidar",
    "laser",
    "kinect",
    "realsense",
    "velodyne",
    "ouster",
    "livox",
    "zivid",
)
# Frames of one sensor lie this close together, metres.
_ONE_SENSOR = 0.15


class Placement(NamedTuple):
    """Position of the sensor and direction against gravity in the frame of a cloud; None if not known."""

    viewpoint: NDArray[np.float64] | None
    up: NDArray[np.float64] | None


def placement(
    points: NDArray[np.float64], frame: str, topic: str, time: int, transforms: Transforms
) -> Placement:
    """Placement of points (..., 3) in a frame at a time, ns since 1970, sent on a topic."""
    return Placement(
        _viewpoint(points, frame, topic, time, transforms), up_direction(frame, time, transforms)
    )


def up_direction(frame: str, time: int, transforms: Transforms) -> NDArray[np.float64] | None:
    """The direction (3,) against gravity in a frame at a time; None if it is not known."""
    if not transforms:
        return None
    above = transforms.ancestors(frame, time)
    upright = [name for name in above if _is_upright(name)]
    if not upright:
        # The camera may be the root of the tree.
        everywhere = sorted(filter(_is_upright, transforms.frames()))
        beside = [(len(transforms.ancestors(name, time)), name) for name in everywhere]
        upright = [name for _, name in sorted(beside, reverse=True)]
    for name in reversed(upright):
        if pose := transforms.pose(frame, name, time):
            return pose.rotation[2]
    return None


def _viewpoint(
    points: NDArray[np.float64], frame: str, topic: str, time: int, transforms: Transforms
) -> NDArray[np.float64] | None:
    if _is_sensor(frame):
        return np.zeros(3)
    below = [name for name in sorted(transforms.frames()) if frame in transforms.ancestors(name, time)[1:]]
    sensors = {
        name: pose.translation
        for name in filter(_is_sensor, below)
        if (pose := transforms.pose(name, frame, time)) is not None
    }
    if not sensors:
        is_another = bool(below) or _is_upright(frame)
        return None if is_another else camera_frame_viewpoint(points.reshape(-1, 3))
    return _common_place(sensors) if len(sensors) == 1 else _of_topic(sensors, topic)


def _of_topic(sensors: dict[str, NDArray[np.float64]], topic: str) -> NDArray[np.float64] | None:
    """Place of the sensors whose names have most words of a topic; None where these are several sensors."""
    asked = set(words(topic))
    shared = {name: len(asked.intersection(words(name))) for name in sensors}
    most = max(shared.values())
    return _common_place({name: sensors[name] for name in sensors if shared[name] == most})


def _common_place(sensors: dict[str, NDArray[np.float64]]) -> NDArray[np.float64] | None:
    """Where sensors stand that are one; its optical frame is where it looks from."""
    places = np.array(list(sensors.values()))
    if np.linalg.norm(places - places[0], axis=1).max() > _ONE_SENSOR:
        return None
    optical = [place for name, place in sensors.items() if "optical" in name.lower()]
    depth = [place for name, place in sensors.items() if {"optical", "depth"} <= set(words(name))]
    return (depth or optical or list(places))[0]


def _is_upright(frame: str) -> bool:
    return frame.rpartition("/")[2].lower() in _UPRIGHT


def _is_sensor(frame: str) -> bool:
    return not _is_upright(frame) and any(word in frame.lower() for word in _SENSORS)
