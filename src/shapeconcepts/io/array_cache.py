"""Keeps arrays in a folder, found by what they were made from."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.scan import ScanError
from shapeconcepts.version import __version__

_DIGEST_SIZE = hashlib.sha256().digest_size


@dataclass(frozen=True)
class ArrayCache:
    """A folder with one file for each entry.

    An entry is found by what it was made from, and begins with a checksum of that and of all it holds, so it
    never becomes wrong; one that is damaged counts as missing. The folder can be deleted at any time. Several
    processes may use it at once.

    Attributes
    ----------
    folder : Path
        It is made when the first entry is stored.
    version : str
        Fingerprint of the code that makes what is kept, see `code_fingerprint`.
    """

    folder: Path
    version: str

    def key(self, content: bytes, parameters: object) -> str:
        """Name of an entry.

        Parameters
        ----------
        content : bytes
            What the entry is made from, such as the file of a scan.
        parameters : object
            Whatever else decides what becomes of it, with a `repr` that says all.
        """
        digest = hashlib.sha256(f"{self.version}\n{parameters!r}\n".encode())
        digest.update(content)
        return digest.hexdigest()

    def load_arrays(self, key: str) -> list[dict[str, NDArray[Any]]] | None:
        """The arrays of each object of an entry by name; None where there is none, or it is damaged."""
        try:
            content = read_regular_file(self._path(key))
        except ScanError:
            # What it holds can be made anew, whatever the reason.
            return None
        digest, arrays = content[:_DIGEST_SIZE], content[_DIGEST_SIZE:]
        if digest != _digest(key, arrays):
            return None
        with np.load(BytesIO(arrays), allow_pickle=False) as archive:
            kept = dict(archive)
        return [with_prefix(f"{index}/", kept) for index in range(int(kept["n_objects"]))]

    def store_arrays(self, key: str, objects: Sequence[Mapping[str, NDArray[Any]]]) -> None:
        """Keep the arrays of objects.

        Raises
        ------
        OSError
            If the folder cannot be written.
        """
        arrays = {
            f"{index}/{name}": array for index, one in enumerate(objects) for name, array in one.items()
        }
        content = BytesIO()
        np.savez(content, n_objects=np.array(len(objects)), **arrays)  # type: ignore[arg-type]
        path = self._path(key)
        path.parent.mkdir(parents=True, exist_ok=True)
        # What is there is damaged, or no file at all, which nothing would replace.
        path.unlink(missing_ok=True)
        write_atomically(path, _digest(key, content.getvalue()) + content.getvalue())

    def _path(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.{self.folder.name}"


def code_fingerprint(sources: Iterable[str]) -> str:
    """Version of the package, and of the code in some of its files.

    Parameters
    ----------
    sources : iterable of str
        Patterns of files below the package, such as ``geometry/*.py``.
    """
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for pattern in sources:
        for path in sorted(package.glob(pattern)):
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{__version__} {digest.hexdigest()}"


def with_prefix(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Arrays whose names begin so, without it."""
    return {name.removeprefix(prefix): array for name, array in arrays.items() if name.startswith(prefix)}


def _digest(key: str, arrays: bytes) -> bytes:
    return hashlib.sha256(key.encode() + arrays).digest()
