"""Writes files that appear complete or not at all."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path


def write_atomically(path: Path, content: bytes) -> None:
    """Write beside the file first, and take its place and permissions once all is on disk.

    Nobody ever reads half of it, and no failure costs the old one. A writer that is killed leaves a file
    ``.shapeconcepts-...`` behind.

    Parameters
    ----------
    path : Path
        The file; its folder must exist. Where it is a link, the file that it leads to is written.
    content : bytes

    Raises
    ------
    OSError
        If the file cannot be written, is write-protected, or is something else than a file.
    """
    path = Path(os.path.realpath(path))
    mode = stat.S_IMODE(path.stat().st_mode) if path.exists() else None
    if mode is not None:
        if not path.is_file():
            raise OSError(f"{path}: is not a regular file")
        if not os.access(path, os.W_OK):
            raise PermissionError(f"{path}: is write-protected")
    temporary = path.parent / f".shapeconcepts-{secrets.token_hex(8)}"
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            temporary.chmod(mode)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
