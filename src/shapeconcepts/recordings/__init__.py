"""Reads the recordings of robots: ROS bags of both generations, and MCAP, without ROS.

Needs the extra `recordings`; `is_recording` does not.
"""

from shapeconcepts.recordings.reading import read_scenes, topics
from shapeconcepts.recordings.recording_path import is_recording
from shapeconcepts.recordings.topic import Topic

__all__ = ["Topic", "is_recording", "read_scenes", "topics"]
