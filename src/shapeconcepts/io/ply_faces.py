"""Faces of the Polygon File Format, row by row: each may have another number of corners."""

from __future__ import annotations

import struct

from shapeconcepts.io.mesh import Polygons
from shapeconcepts.io.ply_header import FACE_NAMES, Element, Property, truncated
from shapeconcepts.scan import ScanError


def ascii_faces(lines: list[str], face: Element) -> Polygons:
    """Faces from the lines behind the vertices."""
    if face.n_rows > len(lines):
        raise truncated(face)
    lines = lines[: face.n_rows]
    polygons = Polygons()
    for line in lines:
        values = line.split()
        place = 0
        try:
            for field in face.properties:
                length = 1
                if field.length_dtype is not None:
                    length = int(values[place])
                    place += 1
                if not 0 <= length <= len(values) - place:
                    raise ValueError
                if field.name in FACE_NAMES:
                    corners = [int(value) for value in values[place : place + length]]
                place += length
        except (ValueError, IndexError):
            raise ScanError(f"has the face {line[:60]!r}, which does not fit the header") from None
        polygons.append(corners)
    return polygons


def binary_faces(data: bytes, offset: int, face: Element, byte_order: str) -> Polygons:
    """Faces from the bytes behind the vertices."""
    # An edge is no face, so the smallest rows bound the loop.
    smallest = sum(_smallest_size(field) for field in face.properties)
    if face.n_rows * smallest > len(data) - offset:
        raise ScanError(
            f"is truncated: {face.n_rows} faces of two corners or more do not fit into "
            f"{len(data) - offset} bytes"
        )
    layout = [
        (
            None if field.length_dtype is None else struct.Struct(byte_order + field.length_dtype.char),
            field.dtype.itemsize,
            field.dtype.char if field.name in FACE_NAMES else "",
        )
        for field in face.properties
    ]
    polygons = Polygons()
    try:
        for _ in range(face.n_rows):
            for length_format, size, corner_type in layout:
                length = 1
                if length_format is not None:
                    length = int(length_format.unpack_from(data, offset)[0])
                    offset += length_format.size
                    if length < 0:
                        raise ValueError
                if corner_type:
                    corners = struct.unpack_from(f"{byte_order}{length}{corner_type}", data, offset)
                offset += length * size
            if offset > len(data):
                raise ValueError
            polygons.append(corners)
    except ScanError:
        raise
    except (ValueError, struct.error):
        raise truncated(face) from None
    return polygons


def _smallest_size(field: Property) -> int:
    """Bytes that a property of a face takes at least."""
    if field.length_dtype is None:
        return field.dtype.itemsize
    return field.length_dtype.itemsize + (2 * field.dtype.itemsize if field.name in FACE_NAMES else 0)
