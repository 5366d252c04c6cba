"""Reads whole files, whatever stands at their place in the file system."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from shapeconcepts.scan import ScanError


def read_regular_file(path: Path) -> bytes:
    """Content of a file; ScanError, without the path, where it is no regular file or cannot be read.

    A pipe, a socket or a device is never opened: that may never end, or do something.
    """
    try:
        _check_kind(os.stat(path))
        with open(path, "rb", opener=_open_at_once) as file:
            # It may have been replaced in between.
            status = os.fstat(file.fileno())
            _check_kind(status)
            # No more than it says: some files of the system never end.
            return file.read(status.st_size)
    except (FileNotFoundError, NotADirectoryError):
        raise ScanError("there is no such file") from None
    except OSError as error:
        raise ScanError(f"cannot be read ({error.strerror})") from None
    except MemoryError:
        raise ScanError("is larger than the memory that there is") from None
    except ScanError:
        raise
    except ValueError as error:  # a name that no file can have
        raise ScanError(f"cannot be read ({error})") from None


def _check_kind(status: os.stat_result) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise ScanError("is a folder")
    if not stat.S_ISREG(status.st_mode):
        raise ScanError("is not a regular file")


def _open_at_once(path: str, flags: int) -> int:
    """Descriptor of a file, without waiting for somebody to write into a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
