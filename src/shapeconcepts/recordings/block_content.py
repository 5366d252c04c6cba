"""Reads and unpacks a block, as far as it goes and never to more than it says."""

from __future__ import annotations

from binascii import crc32
from bz2 import BZ2Decompressor
from typing import Any, BinaryIO

from backports.zstd import ZstdDecompressor
from lz4.frame import LZ4FrameDecompressor

from shapeconcepts.recordings.blocks import Block
from shapeconcepts.scan import ScanError

# Many times what recorders put into a block or a message.
MOST_BYTES = 2**28
_UNPACKERS: dict[str, Any] = {"lz4": LZ4FrameDecompressor, "bz2": BZ2Decompressor, "zstd": ZstdDecompressor}
_ZSTD_START = b"\x28\xb5\x2f\xfd"


def block_content(file: BinaryIO, block: Block) -> memoryview:
    """Unpacked bytes of a block, fewer than it says where it is cut off; ScanError where there are none."""
    file.seek(block.position)
    data = file.read(block.length)
    if block.compression:
        data = unpacked(data, block.compression, block.size)
    if block.is_whole and block.checksum and crc32(data) != block.checksum:
        raise ScanError("its checksum is another")
    return memoryview(data)


def unpacked(data: bytes | memoryview, compression: str, size: int) -> bytes:
    """Data unpacked to no more than `size` bytes, and less where it ends early; ScanError says why not."""
    if compression not in _UNPACKERS:
        raise ScanError(f"the compression {compression!r} is not known, only {' '.join(_UNPACKERS)}")
    if size > MOST_BYTES:
        raise ScanError(f"unpacks to {size} bytes, at most {MOST_BYTES} are unpacked")
    try:
        return _UNPACKERS[compression]().decompress(bytes(data), size)
    except Exception as error:  # each library has its own
        raise ScanError(f"cannot be unpacked ({error})") from None


def unpacked_message(data: bytes | memoryview) -> bytes | memoryview:
    """A message that was compressed on its own, unpacked; others as they are.

    No serialised message begins as compressed ones do.
    """
    return unpacked(data, "zstd", MOST_BYTES) if data[:4] == _ZSTD_START else data
