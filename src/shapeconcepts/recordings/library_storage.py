"""A sound recording, as rosbags reads it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Reader as Bag
from rosbags.rosbag2 import Reader as Bag2
from rosbags.rosbag2.storage_mcap import McapReader

from shapeconcepts.recordings.recording_path import BAG
from shapeconcepts.recordings.storage import ROS1, Channel, Message


class LibraryStorage:
    """A recording that rosbags can read: with an index, and of ROS.

    Raises
    ------
    Exception
        Of any kind, where it cannot.
    """

    def __init__(self, path: Path) -> None:
        is_bag = path.suffix.lower() == BAG and path.is_file()
        self._reader: Any = Bag(path) if is_bag else Bag2(path)
        self._reader.open()
        try:
            if not is_bag:
                _check_index(self._reader)
            self.damage = ""
            self.start: int = self._reader.start_time
            self._connections: list[Any] = list(self._reader.connections)
            self.channels = [
                Channel(
                    index,
                    str(one.topic),
                    str(one.msgtype),
                    ROS1 if is_bag else one.ext.serialization_format,
                    int(one.msgcount),
                )
                for index, one in enumerate(self._connections)
            ]
        except BaseException:
            self._reader.close()
            raise

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """As `Storage.messages`."""
        wanted = {self._connections[channel.id].id: channel for channel in channels}
        if not wanted:  # rosbags takes none for all
            return
        connections = [self._connections[channel.id] for channel in wanted.values()]
        for connection, time, data in self._reader.messages(connections, start, stop):
            yield Message(wanted[connection.id], time, data)

    def close(self) -> None:
        """As `Storage.close`."""
        self._reader.close()


def _check_index(reader: Any) -> None:
    """Raise ValueError where an MCAP file has no index: rosbags stops where its messages are out of order."""
    for storage in getattr(reader.storage, "storages", [reader.storage]):
        if isinstance(storage, McapReader) and storage.metadata.message_count and not storage.chunks:
            raise ValueError("has no index")
