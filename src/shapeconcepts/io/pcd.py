"""Reads the Point Cloud Data format of the Point Cloud Library (version 0.7 and before).

https://pointclouds.org/documentation/tutorials/pcd_file_format.html
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import lzf
import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import LABEL_NAMES, Cloud, decoded_lines, number_table
from shapeconcepts.io.unpacking import check_unpacked
from shapeconcepts.io.viewpoint import camera_frame_viewpoint, declared_viewpoint
from shapeconcepts.scan import ScanError, whole_numbers

FORMATS = {
    f"{kind}{size}": np.dtype(f"<{code}{size}")
    for kind, code, sizes in (("F", "f", "48"), ("I", "i", "1248"), ("U", "u", "1248"))
    for size in sizes
}
LONGEST_HEADER = 65536
ENCODINGS = ("ascii", "binary", "binary_compressed")
# An LZF back reference of 3 bytes stands for at most 264 bytes.
LZF_LARGEST_RATIO = 88


class _Field(NamedTuple):
    dtype: np.dtype
    n_values: int
    column: int
    offset: int


class _Header(NamedTuple):
    fields: dict[str, _Field]
    n_points: int
    n_columns: int
    point_size: int
    viewpoint: NDArray[np.float64]
    encoding: str


def read_pcd(data: bytes) -> Cloud:
    """Cloud from the bytes of a PCD file; ScanError says what is wrong with it."""
    header, body = _read_header(data)
    for axis in "xyz":
        if axis not in header.fields:
            raise ScanError(f"has no field {axis}, only {' '.join([*header.fields][:10])}")
    label = next((name for name in LABEL_NAMES if name in header.fields), None)
    names = [*"xyz"] if label is None else [*"xyz", label]
    for name in names:
        if header.fields[name].n_values != 1:
            raise ScanError(f"the field {name} must have COUNT 1, got {header.fields[name].n_values}")

    points, labels = _content(data, body, header, names)
    # (0, 0, 0) is what writers put there when they do not know; it needs the evidence of the cloud itself.
    declared = header.viewpoint.any()
    return Cloud(
        points,
        declared_viewpoint(points, header.viewpoint) if declared else camera_frame_viewpoint(points),
        labels,
    )


def _content(
    data: bytes, body: int, header: _Header, names: list[str]
) -> tuple[NDArray[np.float64], NDArray[np.int64] | None]:
    """Points, and labels where they are among the names; what is unpacked is gone afterwards."""
    if header.encoding == "ascii":
        columns = _ascii_columns(data[body:], header, names)
    elif header.encoding == "binary":
        columns = _binary_columns(data, body, header, names)
    else:
        columns = _compressed_columns(data, body, header, names)
    points = np.empty((header.n_points, 3))
    for axis, name in enumerate("xyz"):
        points[:, axis] = columns[name]
    return points, whole_numbers(columns[names[3]]) if len(names) > 3 else None


def _read_header(data: bytes) -> tuple[_Header, int]:
    """The header, and where the data begins."""
    entries: dict[str, list[str]] = {}
    position = 0
    while "DATA" not in entries:
        end = data.find(b"\n", position, LONGEST_HEADER)
        line = data[position : max(end, position)].strip()
        if end < 0 or not (line.isascii() or line.startswith(b"#")):
            raise ScanError("is not a PCD file: its header has no DATA line")
        position = end + 1
        if line and not line.startswith(b"#"):
            key, *values = (word.decode("ascii") for word in line.split())
            key = key.upper()
            entries["FIELDS" if key == "COLUMNS" else key] = values
    return _checked_header(entries), position


def _checked_header(entries: dict[str, list[str]]) -> _Header:
    for key in ("FIELDS", "SIZE", "TYPE"):
        if not entries.get(key):
            raise ScanError(f"the header has no {key}")
    names = entries["FIELDS"]
    counts = entries.get("COUNT", ["1"] * len(names))
    if not len(names) == len(entries["SIZE"]) == len(entries["TYPE"]) == len(counts):
        raise ScanError(
            f"the header describes {len(names)} FIELDS with {len(entries['SIZE'])} SIZE, "
            f"{len(entries['TYPE'])} TYPE and {len(counts)} COUNT values"
        )
    fields: dict[str, _Field] = {}
    column = offset = 0
    for name, kind, size, count_text in zip(names, entries["TYPE"], entries["SIZE"], counts, strict=True):
        if kind.upper() + size not in FORMATS:
            raise ScanError(f"the field {name} has the unknown TYPE {kind} with SIZE {size}")
        dtype, count = FORMATS[kind.upper() + size], _number("COUNT", count_text)
        if count < 1:
            raise ScanError(f"the field {name} has COUNT {count}, expected 1 or more")
        # PCL calls every piece of padding "_".
        if name in fields and name != "_":
            raise ScanError(f"the header names the field {name} twice")
        fields[name] = _Field(dtype, count, column, offset)
        column += count
        offset += count * dtype.itemsize

    encoding = " ".join(entries["DATA"]).lower()
    if encoding not in ENCODINGS:
        raise ScanError(f"DATA must be one of {', '.join(ENCODINGS)}, got {encoding!r}")
    viewpoint = _viewpoint(entries.get("VIEWPOINT", ["0", "0", "0"]))
    return _Header(fields, _number_of_points(entries), column, offset, viewpoint, encoding)


def _number_of_points(entries: dict[str, list[str]]) -> int:
    given = {
        key: _number(key, " ".join(entries[key])) for key in ("WIDTH", "HEIGHT", "POINTS") if key in entries
    }
    if "WIDTH" not in given:
        if "POINTS" not in given:
            raise ScanError("the header has neither WIDTH nor POINTS")
        return given["POINTS"]
    n_points = given["WIDTH"] * given.get("HEIGHT", 1)
    if given.get("POINTS", n_points) != n_points:
        raise ScanError(
            f"POINTS is {given['POINTS']}, but WIDTH {given['WIDTH']} x HEIGHT {given.get('HEIGHT', 1)} "
            f"is {n_points}"
        )
    return n_points


def _number(key: str, text: str) -> int:
    # More digits than any file can hold bytes are an attack on int().
    if not (text.isdigit() and len(text) <= 18):
        raise ScanError(f"{key} must be a number, 0 or more, got {text[:30]!r}")
    return int(text)


def _viewpoint(values: list[str]) -> NDArray[np.float64]:
    try:
        position = np.array([float(value) for value in values[:3]])
    except ValueError:
        position = np.empty(0)
    if position.shape != (3,):
        raise ScanError(f"VIEWPOINT must begin with 3 numbers, got {' '.join(values)[:60]!r}")
    return position


def _ascii_columns(body: bytes, header: _Header, names: list[str]) -> dict[str, NDArray]:
    lines = [line for line in decoded_lines(body) if line.strip()]
    if len(lines) < header.n_points:
        raise ScanError(
            f"is truncated: the header promises {header.n_points} points, the file has {len(lines)}"
        )
    table = number_table(lines[: header.n_points])
    if table.shape[1] != header.n_columns:
        raise ScanError(f"has {table.shape[1]} columns, the header describes {header.n_columns}")
    columns = {}
    for name in names:
        field = header.fields[name]
        column = table[:, field.column]
        if field.dtype.kind == "f":
            # The header gives the precision, so that all three encodings of a cloud read the same.
            with np.errstate(over="ignore"):
                column = column.astype(field.dtype)
        columns[name] = column
    return columns


def _binary_columns(data: bytes, body: int, header: _Header, names: list[str]) -> dict[str, NDArray]:
    if header.n_points == 0:
        raise ScanError("holds no points")
    promised, held = header.n_points * header.point_size, len(data) - body
    if promised > held:
        raise ScanError(
            f"is truncated: the header promises {header.n_points} points of {header.point_size} bytes, "
            f"the file has {held} bytes of data"
        )
    fields = [header.fields[name] for name in names]
    return {
        name: np.ndarray(header.n_points, field.dtype, data, body + field.offset, header.point_size)
        for name, field in zip(names, fields, strict=True)
    }


def _compressed_columns(data: bytes, body: int, header: _Header, names: list[str]) -> dict[str, NDArray]:
    """The block holds one field after the other, each for all points."""
    if len(data) - body < 8:
        raise ScanError("is truncated: the sizes of the compressed block are missing")
    compressed_size, size = struct.unpack_from("<II", data, body)
    block = data[body + 8 : body + 8 + compressed_size]
    if len(block) < compressed_size:
        raise ScanError(f"is truncated: the compressed block has {len(block)} of {compressed_size} bytes")
    if size != header.n_points * header.point_size:
        raise ScanError(
            f"the compressed block says {size} bytes, the header promises {header.n_points} points "
            f"of {header.point_size} bytes"
        )
    if size > LZF_LARGEST_RATIO * compressed_size:
        raise ScanError(f"the compressed block of {compressed_size} bytes cannot hold {size} bytes")
    check_unpacked(size, len(data), header.n_points)
    try:
        content = lzf.decompress(block, size) if size else b""
    except ValueError:
        content = None
    if content is None or len(content) != size:
        raise ScanError(f"the compressed block is damaged, it does not unpack to {size} bytes")
    fields = [header.fields[name] for name in names]
    return {
        name: np.frombuffer(content, field.dtype, header.n_points, field.offset * header.n_points)
        for name, field in zip(names, fields, strict=True)
    }
