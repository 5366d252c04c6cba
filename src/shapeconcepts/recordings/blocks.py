"""Parts of a file of a recording that can be read one after the other, without an index."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, Protocol


class Block(NamedTuple):
    """Bytes of a file with whole records in them, perhaps compressed.

    Parameters
    ----------
    position, length : int
        Where the bytes stand.
    compression : str
        Empty where there is none.
    size : int
        Of what they unpack to.
    checksum : int
        CRC-32 of that; 0 where it is not known.
    is_whole : bool
        Whether the file holds all of it.
    """

    position: int
    length: int
    compression: str = ""
    size: int = 0
    checksum: int = 0
    is_whole: bool = True


class Definition(NamedTuple):
    """A record that says what the messages with this id are."""

    id: int
    topic: str
    type: str
    encoding: str


class Entry(NamedTuple):
    """A record with a message, and when it was recorded, ns since 1970."""

    id: int
    time: int
    data: memoryview


class BlockFormat(Protocol):
    """A format whose files are sequences of records.

    Where something is not as it should be, both give a text that says so, and go on if they can.
    """

    def blocks(self, file: BinaryIO, size: int) -> Iterator[Block | str]:
        """The blocks of a file of so many bytes, from its beginning."""

    def records(self, data: memoryview) -> Iterator[Definition | Entry | str]:
        """The records in an unpacked block; those that are of no interest are left out."""
