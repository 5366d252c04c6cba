"""The records of an MCAP file, one after the other: as it was cut off, or has no index.

The format is described at https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import BinaryIO

from shapeconcepts.recordings.blocks import Block, Definition, Entry
from shapeconcepts.recordings.storage import normal_type

MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 2, 3, 4, 5, 6, 15
# Those of later versions, and of others, begin here.
_PRIVATE = 128
# Records outside of chunks are taken together up to this many bytes.
_MOST_TOGETHER = 2**20
_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQII")
_MESSAGE_HEAD = struct.Struct("<HIQQ")


class McapRecords:
    """Reads the records of one file; knows the schemas seen so far."""

    def __init__(self) -> None:
        self._schemas: dict[int, str] = {}

    def blocks(self, file: BinaryIO, size: int) -> Iterator[Block | str]:
        """As `BlockFormat.blocks`: chunks, and runs of records outside of them."""
        if file.read(len(MAGIC)) != MAGIC:
            yield "does not begin as an MCAP file does"
            return
        run = position = len(MAGIC)
        while True:
            file.seek(position)
            head = file.read(_HEAD.size)
            opcode, length = _HEAD.unpack(head) if len(head) == _HEAD.size else (None, 0)
            content = position + _HEAD.size
            is_whole = opcode is not None and content + length <= size
            is_known = opcode is not None and (0 < opcode <= _DATA_END or opcode >= _PRIVATE)
            is_loose = opcode in (_SCHEMA, _CHANNEL, _MESSAGE) and is_whole
            if run < position and (not is_loose or position - run > _MOST_TOGETHER):
                yield Block(run, position - run)
                run = position
            if opcode in (_FOOTER, _DATA_END):
                return
            if opcode == _CHUNK:
                yield _chunk(file, content, length, size)
            if opcode is None:
                yield f"ends at byte {size} before the recording does"
                return
            if not is_known:
                yield f"holds no record at byte {position}, where one is expected"
                return
            if not is_whole:
                yield f"ends within a record at byte {position}"
                return
            position = content + length
            if not is_loose:
                run = position

    def records(self, data: memoryview) -> Iterator[Definition | Entry | str]:
        """As `BlockFormat.records`."""
        position = 0
        while position < len(data):
            content = position + _HEAD.size
            if content > len(data):
                yield "ends within a record"
                return
            opcode, length = _HEAD.unpack_from(data, position)
            position = content + length
            if position > len(data):
                yield "ends within a record"
                return
            try:
                record = self._record(opcode, data[content:position])
            except (struct.error, UnicodeDecodeError) as error:
                yield f"holds a record that is none ({error})"
                continue
            if record is not None:
                yield record

    def _record(self, opcode: int, content: memoryview) -> Definition | Entry | None:
        if opcode == _MESSAGE:
            channel, _, time, _ = _MESSAGE_HEAD.unpack_from(content)
            return Entry(channel, time, content[_MESSAGE_HEAD.size :])
        if opcode == _SCHEMA:
            (schema,) = struct.unpack_from("<H", content)
            self._schemas[schema] = _string(content, 2)[0]
        if opcode == _CHANNEL:
            channel, schema = struct.unpack_from("<HH", content)
            topic, end = _string(content, 4)
            return Definition(
                channel, topic, normal_type(self._schemas.get(schema, "")), _string(content, end)[0]
            )
        return None


def _chunk(file: BinaryIO, position: int, length: int, size: int) -> Block | str:
    head = file.read(_CHUNK_HEAD.size)
    refusal = f"ends within the head of a chunk at byte {position}"
    if len(head) < _CHUNK_HEAD.size:
        return refusal
    _, _, unpacked, checksum, name_length = _CHUNK_HEAD.unpack(head)
    begin = position + _CHUNK_HEAD.size + name_length + 8
    if begin > min(size, position + length):
        return refusal
    compression = file.read(name_length).decode(errors="replace")
    (packed,) = struct.unpack("<Q", file.read(8))
    if begin + packed > position + length:
        return f"holds a chunk at byte {position} that is longer than its record"
    return Block(begin, min(packed, size - begin), compression, unpacked, checksum, begin + packed <= size)


def _string(content: memoryview, position: int) -> tuple[str, int]:
    """A string, and where it ends."""
    (length,) = struct.unpack_from("<I", content, position)
    begin, end = position + 4, position + 4 + length
    if end > len(content):
        raise struct.error(f"a text of {length} bytes in a record of {len(content)}")
    return bytes(content[begin:end]).decode(), end
