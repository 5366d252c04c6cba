"""An open recording."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from shapeconcepts.recordings.recording_path import RECORDING_SUFFIXES, is_recording, storage_files
from shapeconcepts.recordings.salvage import TolerantStorage
from shapeconcepts.recordings.storage import Channel, Message
from shapeconcepts.scan import ScanError


class Recording:
    """A recording, whole or damaged.

    Parameters
    ----------
    path : path
        As for `is_recording`.

    Raises
    ------
    ScanError
        If it holds no messages, or is no recording; the message names the path.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        _check_path(path)
        try:
            self._storage = TolerantStorage(path)
        except ScanError as error:
            raise ScanError(f"{path}: {error}") from None
        except OSError as error:
            raise ScanError(f"{path}: cannot be read ({error.strerror})") from None

    @property
    def channels(self) -> list[Channel]:
        """All that was recorded."""
        return self._storage.channels

    @property
    def start(self) -> int:
        """When the recording begins, ns since 1970."""
        return self._storage.start

    @property
    def damage(self) -> str:
        """What is known to be missing, and why; empty where nothing is. Reading may find more."""
        return self._storage.damage or _unread_log(self.path)

    def messages(
        self, topics: Collection[str], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """Messages on topics recorded from `start` on and before `stop`, ns since 1970, one at a time.

        They come in the order of time, each once. Where the recording is damaged, the rest follows as far as
        it can be read, and `damage` says what is missing. ScanError where nothing of it can be read.
        """
        wanted = [channel for channel in self.channels if channel.topic in topics]
        try:
            yield from self._storage.messages(wanted, start, stop)
        except ScanError as error:
            raise ScanError(f"{self.path}: {error}") from None
        except Exception as error:  # what nobody foresaw in a damaged file
            raise ScanError(
                f"{self.path}: cannot be read any further ({type(error).__name__}: {error})"
            ) from error

    def close(self) -> None:
        """Close the files."""
        self._storage.close()


def _check_path(path: Path) -> None:
    if not path.exists():
        raise ScanError(f"{path}: there is no such file")
    if not is_recording(path):
        raise ScanError(
            f"{path}: is no recording, that is no file {' '.join(RECORDING_SUFFIXES)} and no folder with "
            "metadata.yaml and such files"
        )
    if not (path.is_file() or path.is_dir()):
        raise ScanError(f"{path}: is not a regular file")


def _unread_log(path: Path) -> str:
    """What a recorder left that was ended while it wrote into a database."""
    for file in storage_files(path) if path.is_dir() else [path]:
        log = file.with_name(f"{file.name}-wal")
        if log.is_file() and log.stat().st_size:
            return f"was not closed by its recorder: the latest messages are in {log.name}, which is not read"
    return ""
