"""Reads the Polygon File Format (Stanford PLY): point clouds and meshes, ascii and binary.

http://paulbourke.net/dataformats/ply/
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import LABEL_NAMES, Cloud, decoded_lines, number_table
from shapeconcepts.io.mesh import Mesh, Polygons
from shapeconcepts.io.viewpoint import camera_frame_viewpoint
from shapeconcepts.scan import ScanError, whole_numbers

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
BYTE_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 2**18
FACE_NAMES = ("vertex_indices", "vertex_index")


class _Property(NamedTuple):
    name: str
    dtype: np.dtype
    # Type of the length that stands before the values of a list; None for a single value.
    length_dtype: np.dtype | None


class _Element(NamedTuple):
    name: str
    n_rows: int
    properties: list[_Property]

    @property
    def names(self) -> list[str]:
        return [field.name for field in self.properties]

    @property
    def has_lists(self) -> bool:
        return any(field.length_dtype is not None for field in self.properties)

    @property
    def row_dtype(self) -> np.dtype:
        return np.dtype([(field.name, field.dtype) for field in self.properties])


def read_ply(data: bytes) -> Cloud | Mesh:
    """Mesh where the file has faces, otherwise cloud; ScanError says what is wrong with it."""
    elements, byte_order, body = _read_header(data)
    names = [element.name for element in elements]
    if "vertex" not in names:
        raise ScanError("has no element vertex")
    vertex = elements[names.index("vertex")]
    for axis in "xyz":
        if axis not in vertex.names:
            raise ScanError(f"the element vertex has no property {axis}")
    for element in elements[: names.index("vertex") + 1]:
        if element.has_lists:
            raise ScanError(
                f"the element {element.name} has a list, supported is that after the vertices only"
            )
    face = _face_element(elements[names.index("vertex") + 1 :])

    if byte_order == "=":
        columns, lines = _ascii_vertices(data[body:], elements, vertex)
        faces = None if face is None else _ascii_faces(lines, face).triangles(len(data))
    else:
        columns, offset = _binary_vertices(data, body, elements, vertex)
        faces = None if face is None else _binary_faces(data, offset, face, byte_order).triangles(len(data))
    points = np.column_stack([columns[axis].astype(np.float64) for axis in "xyz"])
    if faces is not None:
        return Mesh(points, faces)
    label = next((name for name in LABEL_NAMES if name in columns), None)
    point_labels = None if label is None else whole_numbers(columns[label])
    return Cloud(points, camera_frame_viewpoint(points), point_labels)


def _face_element(after_vertices: list[_Element]) -> _Element | None:
    """The faces, None where the file is a point cloud."""
    if not any(element.name == "face" and element.n_rows for element in after_vertices):
        return None
    face = after_vertices[0]
    if face.name != "face":
        raise ScanError(f"the element {face.name} stands between vertices and faces, which is not supported")
    if not any(field.name in FACE_NAMES and field.dtype.kind in "iu" for field in face.properties):
        raise ScanError(f"the element face has no list of integers {' or '.join(FACE_NAMES)}")
    return face


def _read_header(data: bytes) -> tuple[list[_Element], str, int]:
    """Elements, byte order, and where the data begins."""
    if not data.startswith(b"ply"):
        raise ScanError("is not a PLY file")
    end = data.find(b"end_header", 0, LONGEST_HEADER)
    body = data.find(b"\n", end) + 1
    if end < 0 or body == 0:
        raise ScanError("is not a PLY file: its header does not end")
    byte_order = None
    elements: list[_Element] = []
    for line in data[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case [] | ["comment" | "obj_info", *_]:
                pass
            case ["format", encoding, _] if encoding in BYTE_ORDERS:
                byte_order = BYTE_ORDERS[encoding]
            case ["element", name, n_rows] if n_rows.isdecimal() and len(n_rows) <= 18:
                elements.append(_Element(name, int(n_rows), []))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= TYPES.keys():
                elements[-1].properties.append(
                    _Property(name, _dtype(kind, byte_order), _dtype(length, byte_order))
                )
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1].properties.append(_Property(name, _dtype(kind, byte_order), None))
            case _:
                raise ScanError(f"the header has the line {line[:60]!r}, which is not known")
    if byte_order is None:
        raise ScanError("the header has no format")
    for element in elements:
        if len(set(element.names)) < len(element.names):
            raise ScanError(f"the element {element.name} names a property twice")
    return [_with_small_axes(element) for element in elements], byte_order, body


def _with_small_axes(element: _Element) -> _Element:
    """Some programs write X, Y and Z."""
    capitals = {axis.upper() for axis in "xyz" if axis not in element.names}
    return element._replace(
        properties=[
            field._replace(name=field.name.lower()) if field.name in capitals else field
            for field in element.properties
        ]
    )


def _dtype(kind: str, byte_order: str | None) -> np.dtype:
    if byte_order is None:
        raise ScanError("the header has no format before its elements")
    return np.dtype(byte_order + TYPES[kind])


def _truncated(element: _Element) -> ScanError:
    return ScanError(
        f"is truncated: the header promises {element.n_rows} of the element {element.name}, "
        "the file holds fewer"
    )


def _binary_vertices(
    data: bytes, offset: int, elements: list[_Element], vertex: _Element
) -> tuple[dict[str, NDArray], int]:
    """Columns of the vertices, and where the next element begins."""
    for element in elements:
        dtype = element.row_dtype
        if element.n_rows * dtype.itemsize > len(data) - offset:
            raise _truncated(element)
        if element is vertex:
            break
        offset += element.n_rows * dtype.itemsize
    rows = np.frombuffer(data, dtype, vertex.n_rows, offset)
    return {field.name: rows[field.name] for field in vertex.properties}, offset + rows.nbytes


def _ascii_vertices(
    body: bytes, elements: list[_Element], vertex: _Element
) -> tuple[dict[str, NDArray], list[str]]:
    """Columns of the vertices, and the lines after them."""
    lines = [line for line in decoded_lines(body) if line.strip()]
    first = 0
    for element in elements:
        if element.n_rows > len(lines) - first:
            raise _truncated(element)
        if element is vertex:
            break
        first += element.n_rows
    end = first + vertex.n_rows
    table = number_table(lines[first:end])
    if table.shape[1] != len(vertex.properties):
        raise ScanError(
            f"has {table.shape[1]} numbers a vertex, the header describes {len(vertex.properties)}"
        )
    columns = {field.name: table[:, column] for column, field in enumerate(vertex.properties)}
    for field in vertex.properties:
        if field.dtype.kind == "f":
            with np.errstate(over="ignore"):
                columns[field.name] = columns[field.name].astype(field.dtype)
    return columns, lines[end:]


def _ascii_faces(lines: list[str], face: _Element) -> Polygons:
    if face.n_rows > len(lines):
        raise _truncated(face)
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


def _binary_faces(data: bytes, offset: int, face: _Element, byte_order: str) -> Polygons:
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
        raise _truncated(face) from None
    return polygons


def _smallest_size(field: _Property) -> int:
    """Bytes that a property of a face takes at least."""
    if field.length_dtype is None:
        return field.dtype.itemsize
    return field.length_dtype.itemsize + (2 * field.dtype.itemsize if field.name in FACE_NAMES else 0)
