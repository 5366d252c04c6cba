"""Tells by its path what is a recording, and how what comes from it is named."""

from __future__ import annotations

import os
import re
from os import PathLike
from pathlib import Path

BAG, MCAP, DATABASE = ".bag", ".mcap", ".db3"
RECORDING_SUFFIXES = (BAG, MCAP, DATABASE)
METADATA = "metadata.yaml"
# Of files in a folder that are compressed as a whole.
COMPRESSED_SUFFIX = ".zstd"
# File systems take 255 bytes for a name, and more is put behind it.
_LONGEST_PART = 100


def is_recording(path: str | PathLike[str]) -> bool:
    """Whether a path is that of a recording: a .bag, .mcap or .db3 file, or the folder of a rosbag2.

    Parameters
    ----------
    path : str or path
        Files are told by their suffix and not opened; a folder by its metadata.yaml and the files beside it.
    """
    path = Path(path)
    if not os.path.isdir(path):
        return path.suffix.lower() in RECORDING_SUFFIXES
    return os.path.isfile(path / METADATA) and bool(storage_files(path))


def storage_files(folder: Path) -> list[Path]:
    """Files of a rosbag2 in their order: they are numbered (…_2.mcap before …_10.mcap)."""
    try:
        names = os.listdir(folder)
    except OSError:
        return []
    files = [folder / name for name in names if _storage_suffix(name)]
    return sorted(files, key=lambda file: [_as_number(part) for part in re.split(r"(\d+)", file.name)])


def safe_name(path: Path, topic: str, moment: str) -> str:
    """Name of what was seen at a moment: `recording/topic/moment`, each part fit for any file system."""
    whole = Path(os.path.abspath(path))
    recording = whole.name if os.path.isdir(whole) else whole.stem
    return "/".join(_safe(part) for part in (recording, topic.strip("/"), moment))


def _safe(part: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]|^\.+", "_", part)[:_LONGEST_PART] or "_"


def _storage_suffix(name: str) -> bool:
    return name.lower().removesuffix(COMPRESSED_SUFFIX).endswith((MCAP, DATABASE))


def _as_number(part: str) -> tuple[int, str]:
    return (int(part), "") if part.isdecimal() else (-1, part)
