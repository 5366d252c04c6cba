"""Reads a recording with rosbags while that goes well, and otherwise what there is without its index."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from shapeconcepts.recordings.bag_records import BagRecords
from shapeconcepts.recordings.database_storage import DatabaseStorage
from shapeconcepts.recordings.library_storage import LibraryStorage
from shapeconcepts.recordings.mcap_records import McapRecords
from shapeconcepts.recordings.recording_path import BAG, DATABASE, MCAP, storage_files
from shapeconcepts.recordings.scanned_storage import ScannedStorage
from shapeconcepts.recordings.storage import Channel, Message, Storage
from shapeconcepts.scan import ScanError


class TolerantStorage:
    """A file or a folder, whole or damaged.

    Raises
    ------
    ScanError
        If it holds no messages; without the path.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._is_sound = True
        self._damage = ""
        try:
            self._storage: Storage = LibraryStorage(path)
        except Exception:  # rosbags, and what it is made from, have many
            self._is_sound = False
            self._storage = _salvaged(path)

    @property
    def channels(self) -> list[Channel]:
        """As `Storage.channels`; others once `messages` found damage."""
        return self._storage.channels

    @property
    def start(self) -> int:
        """As `Storage.start`."""
        return self._storage.start

    @property
    def damage(self) -> str:
        """As `Storage.damage`; reading may find some."""
        return self._storage.damage or self._damage

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """As `Storage.messages`, each once, also where the way of reading changes in between.

        ScanError, without the path, where nothing of the rest can be read.
        """
        wanted = {_what(channel) for channel in channels}
        last = -1
        at_last: set[str] = set()
        if self._is_sound:
            try:
                for message in self._storage.messages(self._own(wanted), start, stop):
                    if message.time != last:
                        last, at_last = message.time, set()
                    at_last.add(message.channel.topic)
                    yield message
                return
            except Exception as error:  # as above
                broken, self._storage = self._storage, _salvaged(self._path)
                broken.close()
                self._is_sound, self._damage = False, str(error)
        begin = max(last, 0 if start is None else start)
        for message in self._storage.messages(self._own(wanted), begin, stop):
            if message.time != last or message.channel.topic not in at_last:
                yield message

    def close(self) -> None:
        """As `Storage.close`."""
        self._storage.close()

    def _own(self, wanted: set[tuple[str, str]]) -> list[Channel]:
        return [channel for channel in self._storage.channels if _what(channel) in wanted]


class _Folder:
    """The files in the folder of a rosbag2, one after the other, without its metadata."""

    def __init__(self, folder: Path) -> None:
        self._storages: dict[str, TolerantStorage] = {}
        self._damage = ""
        for file in storage_files(folder):
            try:
                self._storages[file.name] = TolerantStorage(file)
            except (ScanError, OSError) as error:
                self._damage = self._damage or f"{file.name} {error}"
        if not self._storages:
            raise ScanError(self._damage or "holds no file with messages")
        self.start = min(storage.start for storage in self._storages.values())
        counts: dict[tuple[str, str, str], int] = {}
        for channel in (channel for storage in self._storages.values() for channel in storage.channels):
            key = (*_what(channel), channel.encoding)
            counts[key] = counts.get(key, 0) + channel.n_messages
        self.channels = [Channel(index, *key, count) for index, (key, count) in enumerate(counts.items())]

    @property
    def damage(self) -> str:
        """As `Storage.damage`, of the first file that has some."""
        damages = (f"{name} {one.damage}" for name, one in self._storages.items() if one.damage)
        return next(damages, "") or self._damage

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """As `Storage.messages`."""
        wanted = {_what(channel) for channel in channels}
        for name, storage in self._storages.items():
            own = [channel for channel in storage.channels if _what(channel) in wanted]
            try:
                yield from storage.messages(own, start, stop)
            except ScanError as error:
                self._damage = self._damage or f"{name} {error}"

    def close(self) -> None:
        """As `Storage.close`."""
        for storage in self._storages.values():
            storage.close()


def _salvaged(path: Path) -> Storage:
    """A recording without the help of its index; ScanError, without the path, where it holds nothing."""
    if path.is_dir():
        return _Folder(path)
    suffix = path.suffix.lower()
    if suffix == BAG:
        return ScannedStorage(path, BagRecords())
    if suffix == MCAP:
        return ScannedStorage(path, McapRecords())
    if suffix == DATABASE:
        return DatabaseStorage(path)
    raise ScanError("is compressed as a whole, and cannot be unpacked in part")


def _what(channel: Channel) -> tuple[str, str]:
    """What a channel is in whichever way it is read."""
    return channel.topic, channel.type
