"""Reads the Point Cloud Data format of the Point Cloud Library (version 0.7 and before).

https://pointclouds.org/documentation/tutorials/pcd_file_format.html
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import NamedTuple

import lzf
import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import (
    LABEL_NAMES,
    VIEWPOINT_NAMES,
    Cloud,
    decoded_lines,
    labels_or_notice,
    line_end_of,
    number_table,
    value_or_notice,
    without_mark,
)
from shapeconcepts.io.unpacking import check_unpacked
from shapeconcepts.io.viewpoint import common_position, unless_default
from shapeconcepts.scan import ScanError

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
    viewpoint: list[str]
    encoding: str
    image_shape: tuple[int, int] | None


def read_pcd(data: bytes) -> Cloud:
    """Cloud from the bytes of a PCD file; ScanError says what is wrong with it."""
    data = without_mark(data)
    header, body = _read_header(data)
    for axis in "xyz":
        if axis not in header.fields:
            raise ScanError(f"has no field {axis}, only {' '.join([*header.fields][:10])}")
        if (count := header.fields[axis].n_values) != 1:
            raise ScanError(f"the field {axis} must have COUNT 1, got {count}")
    columns = _columns(data, body, header)
    coordinates = columns([*"xyz"])
    points = np.empty((header.n_points, 3))
    for column, values in enumerate(coordinates):
        points[:, column] = values
    label = next((name for name in LABEL_NAMES if name in header.fields), None)
    labels, of_labels = labels_or_notice(lambda: None if label is None else columns([label])[0])

    def declared() -> NDArray[np.float64] | None:
        position = unless_default(_viewpoint(header.viewpoint))
        if position is None and header.fields.keys() >= set(VIEWPOINT_NAMES):
            position = unless_default(common_position(columns([*VIEWPOINT_NAMES])))
        return position

    viewpoint, of_viewpoint = value_or_notice("a viewpoint", declared)
    return Cloud(points, viewpoint, labels, of_viewpoint + of_labels, header.image_shape)


def _columns(data: bytes, body: int, header: _Header) -> Callable[[list[str]], list[NDArray]]:
    """What gives the values of fields by name, of which each has one."""
    if header.encoding == "ascii":
        lines = _ascii_lines(data[body:], header)
        return lambda names: _ascii_columns(lines, header, names)
    if header.encoding == "binary":
        return lambda names: _binary_columns(data, body, header, names)
    content = _unpacked(data, body, header)
    return lambda names: [
        np.frombuffer(content, field.dtype, header.n_points, field.offset * header.n_points)
        for field in _single(header, names)
    ]


def _single(header: _Header, names: list[str]) -> list[_Field]:
    fields = [header.fields[name] for name in names]
    for name, field in zip(names, fields, strict=True):
        if field.n_values != 1:
            raise ScanError(f"the field {name} must have COUNT 1, got {field.n_values}")
    return fields


def _read_header(data: bytes) -> tuple[_Header, int]:
    """The header, and where the data begins."""
    entries: dict[str, list[str]] = {}
    position = 0
    line_end = line_end_of(data[:LONGEST_HEADER])
    while "DATA" not in entries:
        end = data.find(line_end, position, LONGEST_HEADER)
        line = data[position : max(end, position)].strip()
        if end < 0 or not (line.isascii() or line.startswith(b"#")):
            raise ScanError("is not a PCD file: its header has no DATA line")
        position = end + len(line_end)
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
        # Some programs write X, Y and Z.
        if name in ("X", "Y", "Z") and name.lower() not in names:
            name = name.lower()
        # PCL calls every piece of padding "_".
        if name in fields and name != "_":
            raise ScanError(f"the header names the field {name} twice")
        fields[name] = _Field(dtype, count, column, offset)
        column += count
        offset += count * dtype.itemsize

    encoding = " ".join(entries["DATA"]).lower()
    if encoding not in ENCODINGS:
        raise ScanError(f"DATA must be one of {', '.join(ENCODINGS)}, got {encoding!r}")
    viewpoint = entries.get("VIEWPOINT", ["0", "0", "0"])
    n_points = _number_of_points(entries)
    height = _number("HEIGHT", " ".join(entries["HEIGHT"])) if "HEIGHT" in entries else 1
    image_shape = (height, n_points // height) if height > 1 and n_points % height == 0 else None
    return _Header(fields, n_points, column, offset, viewpoint, encoding, image_shape)


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


def _ascii_lines(body: bytes, header: _Header) -> list[str]:
    lines = [line for line in decoded_lines(body) if line.strip()]
    if len(lines) < header.n_points:
        raise ScanError(
            f"is truncated: the header promises {header.n_points} points, the file has {len(lines)}"
        )
    lines = lines[: header.n_points]
    for line in (lines[:1], lines[-1:]):
        if line and (n_columns := len(line[0].split())) != header.n_columns:
            raise ScanError(f"has {n_columns} columns, the header describes {header.n_columns}")
    return lines


def _ascii_columns(lines: list[str], header: _Header, names: list[str]) -> list[NDArray]:
    """All digits that are there, whatever SIZE says."""
    columns = [field.column for field in _single(header, names)]
    return list(number_table(lines, columns).T)


def _binary_columns(data: bytes, body: int, header: _Header, names: list[str]) -> list[NDArray]:
    if header.n_points == 0:
        raise ScanError("holds no points")
    promised, held = header.n_points * header.point_size, len(data) - body
    if promised > held:
        raise ScanError(
            f"is truncated: the header promises {header.n_points} points of {header.point_size} bytes, "
            f"the file has {held} bytes of data"
        )
    return [
        np.ndarray(header.n_points, field.dtype, data, body + field.offset, header.point_size)
        for field in _single(header, names)
    ]


def _unpacked(data: bytes, body: int, header: _Header) -> bytes:
    """The compressed block: one field after the other, each for all points."""
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
    unpacked: bytes = content
    return unpacked
