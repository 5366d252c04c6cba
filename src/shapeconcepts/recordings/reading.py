"""Reads recordings: what is in them, and the scenes on one of their topics.

What needs rosbags is imported when a recording is read, as it is an extra.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from os import PathLike
from pathlib import Path

from shapeconcepts.recordings.library import check_library
from shapeconcepts.recordings.topic import Topic, chosen, counted
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.scene import Scene


def topics(path: str | PathLike[str]) -> list[Topic]:
    """List what a recording holds.

    Parameters
    ----------
    path : str or path
        A rosbag (.bag), the folder of a rosbag2, an .mcap or a .db3 file.

    Returns
    -------
    list of Topic
        In the order of their names.

    Raises
    ------
    ScanError
        If it cannot be read, holds no messages, or rosbags is not installed (the extra `recordings`).
    """
    path = Path(path)
    check_library(path)
    # The extra's library.
    from shapeconcepts.recordings.recording import Recording
    from shapeconcepts.recordings.topic_list import listed_topics

    with scan_errors(str(path), "read"):
        recording = Recording(path)
        try:
            return listed_topics(recording)
        finally:
            recording.close()


def read_scenes(
    path: str | PathLike[str],
    topic: str | None = None,
    every: int = 1,
    start: float | None = None,
    end: float | None = None,
) -> Iterator[Scene | ScanError]:
    """Read the scenes on one topic of a recording, one at a time.

    Point clouds (`sensor_msgs/PointCloud2`) give their points to the bit, with the field `label` where it is
    of a whole type. Depth images (`sensor_msgs/Image` of 16UC1 in millimetres or 32FC1 in metres, and
    `sensor_msgs/CompressedImage` with PNG) are turned into points by the newest `CameraInfo` until then.
    Points stay in the frame of their message. Where the sensor stood, and which way was up, comes from `/tf`
    and `/tf_static`, see `shapeconcepts.recordings.placement`; without them, up is not known.

    Memory does not grow with the number of scenes. Messages that are not wanted are not deserialised.

    Parameters
    ----------
    path : str or path
        A rosbag (.bag), the folder of a rosbag2, an .mcap or a .db3 file.
    topic : str, optional
        By default the only one with point clouds or depth images.
    every : int
        Only the first of so many scenes, from 1.
    start, end : float, optional
        Seconds since the beginning of the recording, by the time of recording; `end` is not included.

    Yields
    ------
    Scene or ScanError
        One for each scene, its name being `recording/topic/stamp`. A message that cannot be read gives its
        error instead, and reading goes on. A recording that is damaged, or was cut off, gives what it holds,
        and its last error says so.

    Raises
    ------
    ScanError
        With the first scene: if it cannot be read or holds no messages, if there is no such topic, or several
        to choose from, which the message lists; if there is no camera for a depth image; if rosbags is not
        installed (the extra `recordings`).
    ValueError
        If a parameter is out of range.
    """
    if every < 1:
        raise ValueError(f"every must be at least 1, got {every}")
    for name, value in (("start", start), ("end", end)):
        if value is not None and not (isfinite(value) and value >= 0.0):
            raise ValueError(f"{name} must be seconds since the beginning, at least 0, got {value}")
    if start is not None and end is not None and end <= start:
        raise ValueError(f"end must be after start, got {start} and {end}")
    return _scenes(Path(path), topic, every, start, end)


def _scenes(
    path: Path, name: str | None, every: int, start: float | None, end: float | None
) -> Iterator[Scene | ScanError]:
    check_library(path)
    # The extra's library.
    from shapeconcepts.recordings.frames import Frames
    from shapeconcepts.recordings.recording import Recording
    from shapeconcepts.recordings.topic_list import listed_topics

    with scan_errors(str(path), "read"):
        recording = Recording(path)
    try:
        with scan_errors(str(path), "read"):
            topic = chosen(path, listed_topics(recording), name)
            frames = Frames(recording, topic)
        try:
            yield from frames.scenes(every, start, end)
        except ScanError as error:  # from here on, nothing can be read
            yield error
            return
        damage = recording.damage
        if not damage and start is None and end is None and frames.n_messages < topic.count:
            # rosbags passes over what is unknown to it.
            damage = f"has an index with {counted(topic.count)}, of which some are missing"
        if damage:
            yield ScanError(f"{path}: {damage}: it gave {counted(frames.n_messages)} on {topic.name}")
    finally:
        recording.close()
