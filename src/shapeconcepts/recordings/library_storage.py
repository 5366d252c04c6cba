"""A sound recording, as rosbags reads it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Reader as Bag
from rosbags.rosbag2 import Reader as Bag2
from rosbags.rosbag2.storage_mcap import McapReader

from shapeconcepts.recordings.message_types import TYPES
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
        reader: Any = _Bag(path) if is_bag else Bag2(path)
        self._reader = reader
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
                    self._reader.count(one) if is_bag else int(one.msgcount),
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


class _Bag(Bag):
    """A rosbag without the index of messages that nobody reads.

    It takes 200 bytes for each of them, which may be thousands a second.
    """

    def read_index_data(self, pos: int, indexes: dict[int, list[Any]]) -> None:
        """Add a part of the index of one connection."""
        found: dict[int, list[Any]] = defaultdict(list)
        super().read_index_data(pos, found)
        for connection, entries in found.items():
            if self._types[connection] in TYPES:
                indexes[connection] += entries

    def count(self, connection: Any) -> int:
        """Number of messages, of which there may be no index."""
        return sum(chunk.connection_counts.get(connection.id, 0) for chunk in self.chunk_infos)

    @cached_property
    def _types(self) -> dict[int, str]:
        return {connection.id: connection.msgtype for connection in self.connections}


def _check_index(reader: Any) -> None:
    """Raise ValueError where an MCAP file has no index: rosbags stops where its messages are out of order."""
    for storage in getattr(reader.storage, "storages", [reader.storage]):
        if isinstance(storage, McapReader) and storage.metadata.message_count and not storage.chunks:
            raise ValueError("has no index")
