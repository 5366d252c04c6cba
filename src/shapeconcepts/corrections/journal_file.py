"""The journal beside a model's file: a line for each edit, on the disk before anybody is told of it."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

from shapeconcepts.corrections.edit import Edit
from shapeconcepts.corrections.journal import Journal
from shapeconcepts.interruption import unfinished
from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.model_file.error import ModelError, require

try:
    import fcntl
except ImportError:  # pragma: no cover - where files cannot be locked, there is one user
    fcntl = None  # type: ignore[assignment]

FORMAT = 1
_ENDING = ".journal"
# A line holds the names of the scans that it is about; a file that is no journal is not read to its end.
_LONGEST_LINE = 64_000_000


class JournalFile:
    """The file `m.safetensors.journal` beside the model `m.safetensors`.

    Its first line tells which journal it is, and each line after it is an edit. What a process that was
    killed left of a line was never told of, and does not count.

    Parameters
    ----------
    model_path : str or path
        The model's file; where it is a link, the journal lies beside what it leads to.
    """

    def __init__(self, model_path: str | PathLike[str]) -> None:
        whole = os.path.realpath(model_path)
        self.path = Path(whole + _ENDING)

    def read(self) -> Journal:
        """The journal; an empty one where there is no file.

        Raises
        ------
        ModelError
            If the file holds something else, or cannot be read.
        """
        try:
            if not self.path.exists():
                return Journal()
            require(self.path.is_file(), f"{self.path}: is not a regular file")
            return self._parsed()[0]
        except OSError as error:
            raise ModelError(f"{self.path}: cannot be read ({error.strerror})") from None

    def append(self, journal: Journal) -> None:
        """Add what the file does not hold of a journal; all of it is on the disk when this returns.

        Raises
        ------
        ModelError
            If the file holds edits that the journal does not know, or is none.
        OSError
            If it cannot be written.
        """
        if not journal.lines:
            return
        if not self.path.exists():
            header = json.dumps({"shapeconcepts_journal": FORMAT, "identity": journal.identity})
            lines = [header, *(edit.to_line() for edit in journal.lines)]
            write_atomically(self.path, "".join(f"{line}\n" for line in lines).encode("ascii"))
            return
        with self.path.open("r+b") as file:
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX)
            there, end = self._parsed()
            if there.goes_on_from(journal) and there.identity == journal.identity:
                return
            require(
                journal.identity == there.identity and journal.goes_on_from(there),
                f"{self.path}: holds edits that this model does not know, made by another process: "
                "load the model again, or save it elsewhere",
            )
            lines = [edit.to_line() for edit in journal.lines[len(there.lines) :]]
            file.truncate(end)
            file.seek(end)
            file.write("".join(f"{line}\n" for line in lines).encode("ascii"))
            file.flush()
            os.fsync(file.fileno())

    def set_aside(self) -> Path | None:
        """Rename the file, if it is there, so that it no longer belongs to the model; its new path."""
        if not os.path.lexists(self.path):
            return None
        number = 1
        while os.path.lexists(other := self.path.with_name(f"{self.path.name}.{number}")):
            number += 1
        self.path.rename(other)
        return other

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let no other process hold the journal, such as a second explorer.

        Raises
        ------
        ModelError
            If one does.
        """
        if fcntl is None:
            yield
            return
        path = self.path.with_name(f".{self.path.name}.lock")
        while True:
            with path.open("w") as file:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except OSError:
                    raise ModelError(f"{self.path}: is held by another explorer of this model") from None
                # Whoever held it before may have taken it away in between.
                if not path.exists() or not os.path.samestat(os.fstat(file.fileno()), path.stat()):
                    continue
                try:
                    # A signal that ends the process leaves no file behind either.
                    unfinished.add(path)
                    yield
                finally:
                    path.unlink(missing_ok=True)
                    unfinished.discard(path)
                return

    def _parsed(self) -> tuple[Journal, int]:
        """The journal, and where its last whole line ends."""
        edits: list[Edit] = []
        end, identity = 0, ""
        with self.path.open("rb") as file:
            for number, line in enumerate(iter(lambda: file.readline(_LONGEST_LINE), b""), 1):
                if not line.endswith(b"\n"):
                    require(len(line) < _LONGEST_LINE, f"{self.path}: line {number} is too long")
                    break
                end += len(line)
                try:
                    text = line.decode("utf-8")
                    if number == 1:
                        identity = _identity_of(text)
                    else:
                        edits.append(Edit.from_line(text))
                except (ModelError, UnicodeDecodeError) as error:
                    raise ModelError(f"{self.path}: line {number} {error}") from None
        require(end > 0, f"{self.path}: is empty, expected the journal of a model")
        try:
            return Journal(identity, tuple(edits)), end
        except ModelError as error:
            raise ModelError(f"{self.path}: {error}") from None


def _identity_of(line: str) -> str:
    try:
        header = json.loads(line)
    except ValueError:
        header = None
    is_header = isinstance(header, dict) and isinstance(header.get("identity"), str)
    require(is_header and "shapeconcepts_journal" in header, "is no beginning of a journal of shapeconcepts")
    version = header["shapeconcepts_journal"]
    require(version == FORMAT, f"has format {version!r:.40}, this version of shapeconcepts reads {FORMAT}")
    identity: str = header["identity"]
    return identity
