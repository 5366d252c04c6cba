"""The SQLite database of a rosbag2, as far as it is there."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from shapeconcepts.recordings.storage import Channel, Message
from shapeconcepts.scan import ScanError

# Behind a row that cannot be read, rows are tried at distances that double: 2^40 messages are no recording.
_MOST_TRIES = 40


class DatabaseStorage:
    """A database that may be cut off or damaged; messages come as they were recorded.

    Raises
    ------
    ScanError
        If there is no message in it; without the path.
    """

    def __init__(self, path: Path) -> None:
        self.damage = ""
        self._database = sqlite3.connect(f"file:{quote(str(path))}?immutable=1", uri=True)
        try:
            self._database.text_factory = lambda text: text.decode(errors="replace")
            # Without it, SQLite refuses a file that is shorter than it says.
            self._database.execute("PRAGMA writable_schema = ON")
            topics = self._database.execute(
                "SELECT id, name, type, serialization_format FROM topics ORDER BY id"
            ).fetchall()
            counts: Counter[int] = Counter()
            self.start = 2**63 - 1
            for _, topic, time in self._rows():
                counts[topic] += 1
                self.start = min(self.start, time) if isinstance(time, int) else self.start
        except sqlite3.Error as error:
            self._database.close()
            raise ScanError(f"is no database that can be read ({error})") from None
        if not counts:
            self._database.close()
            raise ScanError(self.damage or "holds no messages")
        self.channels = [
            Channel(id_, str(topic), str(kind), str(encoding), counts[id_])
            for id_, topic, kind, encoding in topics
        ]

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """As `Storage.messages`, but in the order in which they were recorded."""
        wanted = {channel.id: channel for channel in channels}
        for number, topic, time in self._rows():
            is_wanted = topic in wanted and isinstance(time, int)
            if is_wanted and (start is None or time >= start) and (stop is None or time < stop):
                data = self._data(number)
                if isinstance(data, bytes):
                    yield Message(wanted[topic], time, data)

    def close(self) -> None:
        """As `Storage.close`."""
        self._database.close()

    def _rows(self) -> Iterator[tuple[int, Any, Any]]:
        """Number, topic and time of messages, without their data, which would be read from other pages."""
        # The index on times may be the part that is damaged.
        query = "SELECT id, topic_id, timestamp FROM messages NOT INDEXED WHERE id > ? ORDER BY id"
        last, step = -1, 1
        while step < 2**_MOST_TRIES:
            try:
                for row in self._database.execute(query, (last,)):
                    if row[0] <= last:
                        # The tree of a damaged database may have circles.
                        raise sqlite3.DatabaseError(f"message {row[0]} stands behind {last}")
                    last, step = row[0], 1
                    yield row
                return
            except sqlite3.Error as error:
                self._say(last, error)
                last += step
                step *= 2

    def _data(self, number: int) -> Any:
        """What a message holds; None where it cannot be read."""
        try:
            query = "SELECT data FROM messages WHERE id = ?"
            row = self._database.execute(query, (number,)).fetchone()
            return row[0] if row else None
        except sqlite3.Error as error:
            self._say(number - 1, error)
            return None

    def _say(self, last: int, error: sqlite3.Error) -> None:
        self.damage = self.damage or f"cannot be read behind message {max(last, 0)} ({error})"
