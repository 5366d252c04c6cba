"""What was shown of a model the last time, so that it is there before the model is read again."""

from __future__ import annotations

import hashlib
import os
import sqlite3
from collections.abc import Callable, Iterable
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar

from shapeconcepts.explorer.file_status import file_status
from shapeconcepts.io.user_cache_folder import user_cache_folder

T = TypeVar("T")

# Of all models together: those that were not looked at for the longest time are forgotten first.
MOST_BYTES = 500_000_000
_TABLES = """
CREATE TABLE IF NOT EXISTS documents (name TEXT PRIMARY KEY, of TEXT, content BLOB);
CREATE TABLE IF NOT EXISTS previews (row INTEGER PRIMARY KEY, of TEXT, path TEXT, status TEXT, content BLOB);
"""


class Remembered:
    """Documents and packed previews of one model, in a file of the user's cache that may be deleted any time.

    Each is kept together with what it is of, and given back only for the same. Nothing here ever fails: what
    cannot be read or written is made anew.

    Parameters
    ----------
    subject : iterable of str
        Where the model is, where its scans are, and how they are read.
    """

    def __init__(self, subject: Iterable[str]) -> None:
        self._lock = Lock()
        self._connection: sqlite3.Connection | None = None
        name = hashlib.sha256(
            "\0".join([*subject, _code_stamp()]).encode("utf-8", "surrogateescape")
        ).hexdigest()
        try:
            folder = user_cache_folder() / "explorer"
            folder.mkdir(parents=True, exist_ok=True)
            self._path = folder / f"{name[:32]}.sqlite"
            self._connection = self._opened()
        except (OSError, sqlite3.Error):
            return
        _make_room(folder, self._path)

    def document(self, name: str, of: str) -> bytes | None:
        """A document, if it is one of that."""
        return self._asked("SELECT content FROM documents WHERE name = ? AND of = ?", (name, of))

    def keep_document(self, name: str, of: str, content: bytes) -> None:
        """Keep a document instead of an earlier one."""
        self._told("REPLACE INTO documents VALUES (?, ?, ?)", (name, of, content))

    def preview(self, row: int, of: str) -> bytes | None:
        """The packed preview of a scan, if its file is as it was."""

        def ask(connection: sqlite3.Connection) -> bytes | None:
            found = connection.execute(
                "SELECT path, status, content FROM previews WHERE row = ? AND of = ?", (row, of)
            ).fetchone()
            return found[2] if found and file_status(Path(found[0])) == found[1] else None

        return self._try(ask)

    def keep_preview(self, row: int, of: str, path: Path, status: str, content: bytes) -> None:
        """Keep the packed preview of a scan, which is alone in its file."""
        self._told("REPLACE INTO previews VALUES (?, ?, ?, ?, ?)", (row, of, str(path), status, content))

    def close(self) -> None:
        """Let go of the file."""
        with self._lock:
            if self._connection is not None:
                self._connection.close()
                self._connection = None

    def _opened(self) -> sqlite3.Connection:
        try:
            return self._with_tables()
        except sqlite3.DatabaseError:
            # It is damaged, or no database.
            self._path.unlink(missing_ok=True)
            return self._with_tables()

    def _with_tables(self) -> sqlite3.Connection:
        connection = sqlite3.connect(self._path, timeout=0.5, isolation_level=None, check_same_thread=False)
        try:
            # What a crash of the whole computer leaves is noticed, and made anew.
            connection.executescript(f"PRAGMA journal_mode=WAL; PRAGMA synchronous=OFF; {_TABLES}")
        except sqlite3.Error:
            connection.close()
            raise
        return connection

    def _asked(self, query: str, values: tuple[Any, ...]) -> bytes | None:
        found = self._try(lambda connection: connection.execute(query, values).fetchone())
        return found[0] if found else None

    def _told(self, query: str, values: tuple[Any, ...]) -> None:
        self._try(lambda connection: connection.execute(query, values))

    def _try(self, work: Callable[[sqlite3.Connection], T]) -> T | None:
        with self._lock:
            if self._connection is None:
                return None
            try:
                return work(self._connection)
            except sqlite3.Error:
                return None


def _code_stamp() -> str:
    """Changes whenever the package does: other code may draw other pictures."""
    digest = hashlib.sha256()
    for folder, folders, names in os.walk(Path(__file__).resolve().parents[1]):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        for name in sorted(names):
            if name.endswith(".py"):
                digest.update(f"{name} {file_status(Path(folder, name))}\n".encode())
    return digest.hexdigest()


def _make_room(folder: Path, own: Path) -> None:
    try:
        os.utime(own)
        files = sorted(folder.glob("*.sqlite"), key=lambda path: path.stat().st_mtime, reverse=True)
        total = 0
        for path in files:
            total += path.stat().st_size
            if total > MOST_BYTES and path != own:
                for ending in ("", "-wal", "-shm"):
                    path.with_name(path.name + ending).unlink(missing_ok=True)
    except OSError:
        return
