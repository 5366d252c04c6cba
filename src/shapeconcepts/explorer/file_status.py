"""Tells that a file was replaced or written."""

from __future__ import annotations

from pathlib import Path


def file_status(path: Path) -> str:
    """What changes with the file; empty where there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ""
    return f"{status.st_mtime_ns:x}-{status.st_size:x}-{status.st_ino:x}"
