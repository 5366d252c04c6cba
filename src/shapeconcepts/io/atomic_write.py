"""Writes files that appear complete or not at all, alone or several together."""

from __future__ import annotations

import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple

from shapeconcepts.interruption import unfinished, uninterrupted


class _Replacement(NamedTuple):
    """A file that lies, complete, beside the one whose place it is to take."""

    path: Path
    temporary: Path


_waiting: ContextVar[list[_Replacement] | None] = ContextVar("waiting", default=None)


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
    waiting = _waiting.get()
    replacement = _write_beside(Path(os.path.realpath(path)), content)
    if waiting is not None:
        waiting.append(replacement)
    else:
        _put_in_place([replacement])


@contextmanager
def written_together() -> Iterator[None]:
    """Files that are written atomically within appear at its end: all, or none if one of them fails.

    Raises
    ------
    OSError
        If one of them cannot take its place.
    """
    waiting: list[_Replacement] = []
    token = _waiting.set(waiting)
    try:
        yield
    except BaseException:
        for one in waiting:
            _remove(one.temporary)
        raise
    finally:
        _waiting.reset(token)
    _put_in_place(waiting)


def check_replaceable(path: Path) -> None:
    """Complain about a place where nothing can be written, or where something else than a file is.

    Raises
    ------
    OSError
        With the reason.
    """
    if not path.exists():
        return
    if not path.is_file():
        raise OSError(f"{path}: is not a regular file")
    if not os.access(path, os.W_OK):
        raise PermissionError(f"{path}: is write-protected")


def _write_beside(path: Path, content: bytes) -> _Replacement:
    check_replaceable(path)
    temporary = _free_name(path)
    try:
        with uninterrupted():
            unfinished.add(temporary)
            file = temporary.open("xb")
        with file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            temporary.chmod(stat.S_IMODE(path.stat().st_mode))
    except BaseException:
        _remove(temporary)
        raise
    return _Replacement(path, temporary)


def _put_in_place(replacements: list[_Replacement]) -> None:
    """Give all files their places one right after the other; give back what was there if one fails."""
    undo: list[tuple[Path, Path | None]] = []
    with uninterrupted():
        try:
            for number, (path, temporary) in enumerate(replacements, 1):
                # Nothing comes after the last one that could fail.
                if number == len(replacements):
                    temporary.replace(path)
                    break
                old = _second_name(path) if path.exists() else None
                temporary.replace(path)
                undo.append((path, old))
        except BaseException:
            for path, old in undo:
                if old is None:
                    path.unlink()
                else:
                    old.replace(path)
            raise
        finally:
            for name in (*(one.temporary for one in replacements), *(old for _, old in undo if old)):
                _remove(name)


def _second_name(path: Path) -> Path:
    name = _free_name(path)
    unfinished.add(name)
    try:
        name.hardlink_to(path)
    except OSError:  # some file systems know no second names
        shutil.copy2(path, name)
    return name


def _free_name(path: Path) -> Path:
    return path.parent / f".shapeconcepts-{secrets.token_hex(8)}"


def _remove(temporary: Path) -> None:
    temporary.unlink(missing_ok=True)
    unfinished.discard(temporary)
