"""The records of a rosbag of the first generation, one after the other: as it was not closed, or is damaged.

The format is described at https://wiki.ros.org/Bags/Format/2.0.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import BinaryIO

from shapeconcepts.recordings.blocks import Block, Definition, Entry
from shapeconcepts.recordings.storage import ROS1, normal_type

MAGIC = b"#ROSBAG V2.0\n"
_MESSAGE, _BAG_HEADER, _CHUNK, _CONNECTION = 2, 3, 5, 7
# Recorders write a few hundred bytes.
_LONGEST_HEADER = 2**20
# Records outside of chunks are taken together up to this many bytes.
_MOST_TOGETHER = 2**20


class BagRecords:
    """Reads the records of one file."""

    def blocks(self, file: BinaryIO, size: int) -> Iterator[Block | str]:
        """As `BlockFormat.blocks`: chunks, and runs of records outside of them."""
        if file.read(len(MAGIC)) != MAGIC:
            yield "does not begin as a rosbag of version 2.0 does"
            return
        run = position = len(MAGIC)
        while True:
            fields, content, length = _record_head(file, position)
            is_whole = content + length <= size
            operation = _operation(fields)
            is_loose = operation in (_MESSAGE, _CONNECTION) and is_whole
            if run < position and (not is_loose or position - run > _MOST_TOGETHER):
                yield Block(run, position - run)
                run = position
            if position == size:
                return
            if operation == 0:
                yield f"holds no record at byte {position}, where one is expected"
                return
            if operation == _BAG_HEADER and not any(fields.get("index_pos", b"")):
                yield "was not closed by its recorder"
            if operation == _CHUNK:
                compression = fields.get("compression", b"").decode(errors="replace")
                unpacked = int.from_bytes(fields.get("size", b""), "little")
                yield Block(
                    content,
                    min(length, size - content),
                    "" if compression == "none" else compression,
                    unpacked,
                    is_whole=is_whole,
                )
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
            fields, content, length = _head_in(data, position)
            operation = _operation(fields)
            position = content + length
            if operation == 0 or position > len(data):
                yield "ends within a record"
                return
            try:
                record = _record(operation, fields, data[content:position])
            except (struct.error, KeyError, UnicodeDecodeError) as error:
                yield f"holds a record that is none ({error})"
                continue
            if record is not None:
                yield record


def _record(operation: int, fields: dict[str, bytes], content: memoryview) -> Definition | Entry | None:
    if operation not in (_MESSAGE, _CONNECTION):
        return None
    (connection,) = struct.unpack("<I", fields["conn"])
    if operation == _MESSAGE:
        seconds, nanoseconds = struct.unpack("<II", fields["time"])
        return Entry(connection, seconds * 10**9 + nanoseconds, content)
    kind = _fields(bytes(content))["type"].decode()
    return Definition(connection, fields["topic"].decode(), normal_type(kind), ROS1)


def _operation(fields: dict[str, bytes]) -> int:
    """What a record is; 0 where it is none."""
    return int.from_bytes(fields.get("op", b"")[:1], "little")


def _record_head(file: BinaryIO, position: int) -> tuple[dict[str, bytes], int, int]:
    """Fields of a record's header, where its content begins, and its length; no fields where it is none."""
    file.seek(position)
    head = file.read(4)
    length = int.from_bytes(head, "little")
    if len(head) < 4 or length > _LONGEST_HEADER:
        return {}, position, 0
    fields, content, content_length = _head_in(memoryview(head + file.read(length + 4)), 0)
    return fields, position + content, content_length


def _head_in(data: memoryview, position: int) -> tuple[dict[str, bytes], int, int]:
    """As `_record_head`, of a record in memory."""
    begin = position + 4
    header_length = int.from_bytes(data[position:begin], "little")
    content = begin + header_length + 4
    if content > len(data):
        return {}, position, 0
    fields = _fields(bytes(data[begin : begin + header_length]))
    return fields, content, int.from_bytes(data[content - 4 : content], "little")


def _fields(header: bytes) -> dict[str, bytes]:
    """Fields by name; those behind a broken one are left out."""
    found, position = {}, 0
    while position + 4 <= len(header):
        length = int.from_bytes(header[position : position + 4], "little")
        name, _, value = header[position + 4 : position + 4 + length].partition(b"=")
        found[name.decode(errors="replace")] = value
        position += 4 + length
    return found
