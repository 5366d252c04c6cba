"""Writes a folder of files that appears complete or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from shapeconcepts.interruption import unfinished, uninterrupted


class FolderInMaking:
    """A folder beside the place that it is to take.

    Parameters
    ----------
    path : Path
        Where it lies until it is complete.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def write(self, place: str, content: bytes) -> None:
        """Write a file.

        Parameters
        ----------
        place : str
            Its path inside the folder, with slashes; folders on the way are made.
        content : bytes

        Raises
        ------
        ValueError
            If the place is not inside the folder.
        FileExistsError
            If there is such a file already.
        OSError
            If it cannot be written.
        """
        parts = PurePosixPath(place).parts
        if not parts or place.startswith("/") or ".." in parts:
            raise ValueError(f"place must be inside the folder, got {place!r}")
        path = self._path.joinpath(*parts)
        # Whoever removes the folder, as the process is to end, must not find new files in it.
        with uninterrupted():
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as file:
                file.write(content)


@contextmanager
def folder_written_whole(path: Path, *, replace: bool = False) -> Iterator[FolderInMaking]:
    """What is written within becomes a folder at the end, if nothing fails.

    A writer that is killed leaves a folder ``.shapeconcepts-...`` behind, and nothing at the place itself.

    Parameters
    ----------
    path : Path
        The folder. What it lies in must exist.
    replace : bool
        Whether a folder that holds something may be replaced, with all that is in it.

    Raises
    ------
    OSError
        If it cannot be written, or something is there that may not be replaced.
    """
    path = Path(os.path.realpath(path))
    check_free(path, replace=replace)
    temporary = path.parent / f".shapeconcepts-{secrets.token_hex(8)}"
    try:
        with uninterrupted():
            unfinished.add(temporary)
            temporary.mkdir()
        yield FolderInMaking(temporary)
        # All at once: file by file, waiting for the disk takes longer than everything else.
        if hasattr(os, "sync"):
            os.sync()
        _put_in_place(temporary, path, replace)
    finally:
        if temporary.is_dir():
            shutil.rmtree(temporary)
        unfinished.discard(temporary)


def check_free(path: Path, *, replace: bool) -> None:
    """Complain about a place that a folder cannot take.

    Raises
    ------
    OSError
        If what the place is in is no folder, or a file, or a folder that holds something, is at the place.
    """
    if not path.parent.is_dir():
        raise NotADirectoryError(f"the folder {path.parent} does not exist")
    if not os.path.lexists(path):
        return
    if not path.is_dir():
        raise NotADirectoryError(f"{path}: is there already, and no folder")
    if not replace and any(path.iterdir()):
        raise FileExistsError(f"{path}: is there already, and not empty")


def _put_in_place(temporary: Path, path: Path, replace: bool) -> None:
    """Give a folder its place; what was there comes back if that fails, and is removed otherwise."""
    old = path.parent / f".shapeconcepts-{secrets.token_hex(8)}"
    with uninterrupted():
        check_free(path, replace=replace)
        was_there = path.exists()
        if was_there:
            path.rename(old)
        try:
            temporary.rename(path)
        except BaseException:
            if was_there:
                old.rename(path)
            raise
        if was_there:
            unfinished.add(old)
    if was_there:
        shutil.rmtree(old, ignore_errors=True)
        unfinished.discard(old)
