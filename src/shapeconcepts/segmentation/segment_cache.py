"""Keeps segmented objects in a folder, so that the same scan is not segmented twice."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields
from io import BytesIO
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.scan import ScanError
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.version import __version__

# What a segmented object depends on, apart from the scan and the parameters.
_SOURCES = (
    "scan.py",
    "kernels.py",
    "geometry/*.py",
    "io/*.py",
    "simulation/**/*.py",
    "sources/*.py",
    "preparation/*.py",
    "segmentation/*.py",
)
_DIGEST_SIZE = hashlib.sha256().digest_size


@dataclass(frozen=True)
class SegmentCache:
    """A folder with one file for each scan or labelled scene.

    An entry is found by what it was made from, and begins with a checksum of that and of all it holds, so it
    never becomes wrong; one that is damaged counts as missing. The folder can be deleted at any time. Several
    processes may use it at once.

    Attributes
    ----------
    folder : Path
        It is made when the first entry is stored.
    version : str
        Fingerprint of the code that segments.
    """

    folder: Path
    version: str

    @classmethod
    def of_user(cls) -> SegmentCache:
        """The cache in the user's own cache folder.

        Raises
        ------
        OSError
            If the user has no home folder.
        """
        return cls(user_cache_folder() / "segments", code_fingerprint())

    def key(self, content: bytes, parameters: object) -> str:
        """Name of an entry.

        Parameters
        ----------
        content : bytes
            The file that the scan is read from.
        parameters : object
            Whatever else decides what becomes of it, with a `repr` that says all.
        """
        digest = hashlib.sha256(f"{self.version}\n{parameters!r}\n".encode())
        digest.update(content)
        return digest.hexdigest()

    def load(self, key: str) -> list[SegmentedObject] | None:
        """The objects of an entry; None where there is none, or it is damaged."""
        try:
            content = read_regular_file(self._path(key))
        except ScanError:
            # The scan can be segmented anew, whatever the reason.
            return None
        digest, arrays = content[:_DIGEST_SIZE], content[_DIGEST_SIZE:]
        if digest != _digest(key, arrays):
            return None
        with np.load(BytesIO(arrays), allow_pickle=False) as kept:
            return [_unpack(f"{index}/", kept) for index in range(int(kept["n_objects"]))]

    def store(self, key: str, objects: list[SegmentedObject]) -> None:
        """Keep objects.

        Raises
        ------
        OSError
            If the folder cannot be written.
        """
        arrays = {"n_objects": np.array(len(objects))}
        for index, one in enumerate(objects):
            for field in fields(one):
                value = getattr(one, field.name)
                # An empty tuple is as good as none.
                if value is not None and not (isinstance(value, tuple) and not value):
                    arrays[f"{index}/{field.name}"] = np.asarray(value)
        content = BytesIO()
        np.savez(content, **arrays)  # type: ignore[arg-type]
        path = self._path(key)
        path.parent.mkdir(parents=True, exist_ok=True)
        # What is there is damaged, or no file at all, which nothing would replace.
        path.unlink(missing_ok=True)
        write_atomically(path, _digest(key, content.getvalue()) + content.getvalue())

    def _path(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.segments"


def user_cache_folder() -> Path:
    """Where the operating system wants a user's caches, with a folder for this package.

    Raises
    ------
    OSError
        If the user has no home folder.
    """
    try:
        folder = user_cache_path("shapeconcepts", appauthor=False, opinion=False)
    except RuntimeError as error:
        raise OSError(str(error)) from None
    # Before platformdirs 4.12, a home that is not known stays "~", and a relative XDG_CACHE_HOME is taken.
    if not folder.is_absolute():
        raise OSError(f"the user's cache folder cannot be told: {folder} is relative")
    return folder


def code_fingerprint() -> str:
    """Version of the package, and of the code that makes segmented objects of files."""
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for pattern in _SOURCES:
        for path in sorted(package.glob(pattern)):
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{__version__} {digest.hexdigest()}"


def _digest(key: str, arrays: bytes) -> bytes:
    return hashlib.sha256(key.encode() + arrays).digest()


def _unpack(prefix: str, arrays: np.lib.npyio.NpzFile) -> SegmentedObject:
    values = {name.removeprefix(prefix): arrays[name] for name in arrays.files if name.startswith(prefix)}
    scalars = {name: value.item() for name, value in values.items() if value.ndim == 0}
    texts = {name: tuple(value.tolist()) for name, value in values.items() if value.dtype.kind == "U"}
    return SegmentedObject(**{**values, **texts, **scalars})
