"""A recording without an index, which is made by reading all of it once."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from shapeconcepts.recordings.block_content import block_content
from shapeconcepts.recordings.blocks import Block, BlockFormat, Definition, Entry
from shapeconcepts.recordings.storage import Channel, Message
from shapeconcepts.scan import ScanError


class _Indexed(NamedTuple):
    """A block, the time of its first and last message, and of which channels they are."""

    block: Block
    first: int
    last: int
    ids: frozenset[int]


class ScannedStorage:
    """What a file holds as far as its records go, whether it is whole or not.

    One block at a time is in memory, and of the whole file where each of them stands.

    Raises
    ------
    ScanError
        If there is no message in it; without the path.
    """

    def __init__(self, path: Path, form: BlockFormat) -> None:
        self._form = form
        self._damages: list[str] = []
        self._index: list[_Indexed] = []
        # It stays open as long as the storage.
        self._file = open(path, "rb")  # noqa: SIM115
        try:
            definitions, counts = self._scan(os.fstat(self._file.fileno()).st_size)
        except BaseException:
            self._file.close()
            raise
        self.start = min((indexed.first for indexed in self._index), default=0)
        self.channels = [
            Channel(one.id, one.topic, one.type, one.encoding, counts[one.id]) for one in definitions.values()
        ]
        more = f" (and {len(self._damages) - 1} more)" if len(self._damages) > 1 else ""
        self.damage = self._damages[0] + more if self._damages else ""
        if not counts:
            self._file.close()
            raise ScanError(self.damage or "holds no messages")

    def messages(
        self, channels: Iterable[Channel], start: int | None = None, stop: int | None = None
    ) -> Iterator[Message]:
        """As `Storage.messages`; never raises, as what cannot be read was left out before."""
        wanted = {channel.id: channel for channel in channels}
        for block, first, last, ids in self._index:
            too_early, too_late = start is not None and last < start, stop is not None and first >= stop
            if too_early or too_late or ids.isdisjoint(wanted):
                continue
            found = [
                record
                for record in self._form.records(block_content(self._file, block))
                if isinstance(record, Entry)
                and record.id in wanted
                and (start is None or record.time >= start)
                and (stop is None or record.time < stop)
            ]
            for entry in sorted(found, key=lambda entry: entry.time):
                yield Message(wanted[entry.id], entry.time, entry.data)

    def close(self) -> None:
        """As `Storage.close`."""
        self._file.close()

    def _scan(self, size: int) -> tuple[dict[int, Definition], Counter[int]]:
        """Fill the index; what each channel is, and how many messages it has."""
        definitions: dict[int, Definition] = {}
        counts: Counter[int] = Counter()
        for block in self._form.blocks(self._file, size):
            if isinstance(block, str):
                self._damages.append(block)
                continue
            try:
                content = block_content(self._file, block)
            except ScanError as error:
                self._damages.append(f"has a damaged part at byte {block.position}: {error}")
                continue
            ids, first, last = set(), 2**64, 0
            for record in self._form.records(content):
                if isinstance(record, Definition):
                    definitions[record.id] = record
                elif isinstance(record, Entry):
                    ids.add(record.id)
                    counts[record.id] += 1
                    first, last = min(first, record.time), max(last, record.time)
                elif block.is_whole:  # of others it is said already
                    self._damages.append(f"has a damaged part at byte {block.position}: {record}")
            if ids:
                self._index.append(_Indexed(block, first, last, frozenset(ids)))
        return definitions, counts
