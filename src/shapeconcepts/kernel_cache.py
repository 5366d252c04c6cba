"""Compiled kernels in files, each with a checksum: numba itself runs whatever a damaged file holds."""

from __future__ import annotations

import hashlib
import os
import stat
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

from numba.core.caching import FunctionCache, IndexDataCacheFile

_DIGEST_SIZE = hashlib.sha256().digest_size
_MARK = ".checked"
_NOT_BLOCKING = getattr(os, "O_NONBLOCK", 0)


class KernelCache(FunctionCache):
    """Finds, loads and keeps the compiled code of one kernel.

    Parameters
    ----------
    function : callable
        The kernel before it is compiled.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        # The name tells these files from those that numba alone would write, and could not read.
        self._cache_file = _CheckedFiles(
            self._cache_path, self._impl.filename_base + _MARK, self._impl.locator.get_source_stamp()
        )

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep compiled code; a full disk is no reason to end what it was compiled for."""
        try:
            super().save_overload(signature, compiled)
        except OSError as error:
            warnings.warn(
                f"compiled code cannot be kept in {self.cache_path} ({error.strerror or error}): the next "
                "process compiles it again",
                stacklevel=2,
            )


class _CheckedFiles(IndexDataCacheFile):
    """An index and files of code that end in their checksum; those that do not count as missing."""

    def save(self, key: Any, data: Any) -> None:
        # Two processes that begin an index at the same time give different code the same name.
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        kept_key, data = super().load(key) or (None, None)
        return data if kept_key == key else None

    def _load_index(self) -> dict[Any, str]:
        return super()._load_index() if is_sound(Path(self._index_path)) else {}

    def _load_data(self, name: str) -> Any:
        return super()._load_data(name) if is_sound(Path(self._data_path(name))) else None

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[BinaryIO]:
        with super()._open_for_write(path) as file:
            content = BytesIO()
            yield content
            file.write(content.getvalue() + _digest(path, content.getvalue()))


def kept_files(folder: Path) -> list[Path]:
    """Files of compiled code in a folder, sound or not."""
    return sorted(folder.glob(f"*{_MARK}*.nb[ic]"))


def is_sound(path: Path) -> bool:
    """Whether a file of compiled code is there and holds what was written under its name."""
    try:
        # What is no file, such as a pipe, may never let itself be opened or read to its end.
        descriptor = os.open(path, os.O_RDONLY | _NOT_BLOCKING | getattr(os, "O_BINARY", 0))
        with open(descriptor, "rb") as file:
            content = file.read() if stat.S_ISREG(os.fstat(descriptor).st_mode) else b""
    except OSError:
        return False
    return content[-_DIGEST_SIZE:] == _digest(path, content[:-_DIGEST_SIZE])


def _digest(path: str | Path, content: bytes) -> bytes:
    return hashlib.sha256(Path(path).name.encode() + b"\0" + content).digest()
