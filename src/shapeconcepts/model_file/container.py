"""The file itself: a safetensors container with one text in its header, and a checksum over everything."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from safetensors.numpy import save

from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.model_file.error import ModelError, require
from shapeconcepts.model_file.layout import FORMAT, Tensors, check_layout

# A single key: the order of several in the header would change from one run to the next.
_KEY = "shapeconcepts"
# What safetensors allows.
_LARGEST_HEADER = 100_000_000
_TYPES = {
    "F64": "float64",
    "F32": "float32",
    "F16": "float16",
    "I64": "int64",
    "I32": "int32",
    "U16": "uint16",
}


def write_container(path: Path, tensors: Tensors, description: dict[str, Any]) -> None:
    """Write tensors and their description, with a checksum, so that the file appears complete or not at all.

    Raises
    ------
    ModelError
        If the path is something else than a file, or the description is too long.
    OSError
        If the file cannot be written.
    """
    text = json.dumps({**description, "checksum": _checksum(tensors, description)}, sort_keys=True)
    content = save(tensors, {_KEY: text})
    header_length = int.from_bytes(content[:8], "little")
    require(header_length <= _LARGEST_HEADER, f"names of scans are too long: {header_length} bytes in all")
    require(path.is_file() or not path.exists(), f"{path}: is not a regular file")
    write_atomically(path, content)


def read_container(path: Path) -> tuple[Tensors, dict[str, Any]]:
    """Read tensors and their description; types, shapes and the checksum fit, nothing else is checked.

    Memory is taken for what the file really holds, whatever it says.

    Raises
    ------
    ModelError
        If there is no model of a known version in the file, or it is damaged.
    """
    with _opened(path) as file:
        places, description = _read_header(file)
        tensors = {name: _read_tensor(file, *place) for name, place in places.items()}
    found = description.pop("checksum", None)
    expected = _checksum(tensors, description)
    require(
        found == expected, f"is damaged: its checksum is {expected[:12]}..., it says {str(found)[:12]!r}..."
    )
    return tensors, description


def read_parts(path: Path, names: Iterable[str]) -> tuple[Tensors, dict[str, Any]]:
    """Read some of the tensors and the description, without comparing the checksum, which is over all.

    Raises
    ------
    ModelError
        If there is no model of a known version in the file.
    """
    with _opened(path) as file:
        places, description = _read_header(file)
        tensors = {name: _read_tensor(file, *places[name]) for name in names}
    description.pop("checksum", None)
    return tensors, description


@contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    try:
        require(path.exists(), "there is no such file")
        require(not path.is_dir(), "is a folder")
        # Reading from a pipe or a device may never end.
        require(path.is_file(), "is not a regular file")
        with path.open("rb") as file:
            yield file
    except OSError as error:
        raise ModelError(f"cannot be read ({error.strerror})") from None


def _read_header(file: BinaryIO) -> tuple[dict[str, tuple[int, str, tuple[int, ...]]], dict[str, Any]]:
    """Offset in the file, type and shape of each tensor, and the description."""
    size = os.fstat(file.fileno()).st_size
    require(size > 0, "is empty")
    start = file.read(8)
    length = int.from_bytes(start, "little")
    if len(start) < 8 or not 2 <= length <= min(_LARGEST_HEADER, size - 8):
        raise ModelError(
            f"is no model file, or a truncated one: expected a safetensors header within its {size} bytes, "
            f"got a length of {length}"
        )
    header = _parse(file.read(length), "header")
    metadata = header.pop("__metadata__", None)
    if not isinstance(metadata, dict) or set(metadata) != {_KEY} or not isinstance(metadata[_KEY], str):
        raise ModelError("is a safetensors file, but no model of shapeconcepts")
    description = _parse(metadata[_KEY].encode(errors="surrogatepass"), "description")
    version = description.get("format")
    if type(version) is not int or version < 1:
        raise ModelError(f"has format {version!r:.40}, expected {FORMAT}")
    if version > FORMAT:
        raise ModelError(
            f"has format {version!s:.40}, written by {description.get('written_by')!s:.60}, which is newer "
            f"than this version of shapeconcepts: it reads format {FORMAT}"
        )
    if version < FORMAT:
        raise ModelError(
            f"has format {version}, written by {description.get('written_by')!s:.60}, an older version of "
            f"shapeconcepts, which found concepts by another rule: this one reads format {FORMAT}; "
            "learn the model again from its scans"
        )
    return _places(header, 8 + length, size), description


def _places(
    header: dict[str, Any], data_start: int, size: int
) -> dict[str, tuple[int, str, tuple[int, ...]]]:
    places, spans = {}, []
    for name, entry in header.items():
        title = f"entry {name[:60]!r} of the header"
        require(
            isinstance(entry, dict) and set(entry) == {"dtype", "shape", "data_offsets"},
            f"{title} must hold dtype, shape and data_offsets",
        )
        data_type, shape, offsets = entry["dtype"], entry["shape"], entry["data_offsets"]
        require(
            isinstance(data_type, str) and data_type in _TYPES,
            f"{title} must have a dtype of {', '.join(_TYPES)}, has {data_type!r:.40}",
        )
        require(
            _are_lengths(shape, size) and len(shape) <= 2, f"{title} has an impossible shape {shape!r:.80}"
        )
        require(
            _are_lengths(offsets, size) and len(offsets) == 2,
            f"{title} has impossible data_offsets {offsets!r:.80} in a file of {size} bytes",
        )
        places[name] = (data_start + offsets[0], _TYPES[data_type], tuple(shape))
        n_bytes = np.dtype(_TYPES[data_type]).itemsize
        for dimension in shape:
            n_bytes *= dimension
        require(
            offsets[1] - offsets[0] == n_bytes,
            f"{title} must take {n_bytes} bytes, its data_offsets are {offsets}",
        )
        spans.append(tuple(offsets))
    end = 0
    for first, last in sorted(spans):
        require(first == end, f"has tensors that overlap or leave a gap at byte {end} of the data")
        end = last
    require(
        end == size - data_start,
        f"is truncated or has a tail: its tensors take {end} bytes, it holds {size - data_start}",
    )
    check_layout({name: (data_type, shape) for name, (_, data_type, shape) in places.items()})
    return places


def _are_lengths(values: object, largest: int) -> bool:
    return isinstance(values, list) and all(type(v) is int and 0 <= v <= largest for v in values)


def _read_tensor(file: BinaryIO, offset: int, data_type: str, shape: tuple[int, ...]) -> np.ndarray:
    tensor = np.empty(shape, data_type)
    file.seek(offset)
    read = file.readinto(tensor.reshape(-1).view(np.uint8)) if tensor.size else 0  # type: ignore[attr-defined]
    require(read == tensor.nbytes, "was changed while it was read")
    return tensor


def _parse(text: bytes, part: str) -> dict[str, Any]:
    try:
        value = json.loads(
            text.decode(errors="surrogatepass"), object_pairs_hook=_unique, parse_constant=_no_constant
        )
    except (ValueError, RecursionError) as error:
        raise ModelError(f"is no model file: its {part} is not valid JSON ({error!s:.120})") from None
    require(isinstance(value, dict), f"is no model file: its {part} is no JSON object")
    return value


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key occurs twice")
    return found


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is no number")


def _checksum(tensors: Tensors, description: dict[str, Any]) -> str:
    """SHA-256 over the description and all tensors with their names, types and shapes."""
    digest = hashlib.sha256(json.dumps(description, sort_keys=True).encode())
    for name, tensor in sorted(tensors.items()):
        digest.update(f"\n{name} {tensor.dtype.name} {tensor.shape}\n".encode())
        digest.update(tensor.reshape(-1).view(np.uint8).data)
    return digest.hexdigest()
