"""The header of the Polygon File Format: which elements a file holds, with which properties."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shapeconcepts.io.cloud import line_end_of
from shapeconcepts.scan import ScanError

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
BYTE_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 2**18
FACE_NAMES = ("vertex_indices", "vertex_index")


class Property(NamedTuple):
    """A property of an element, by name; of an unknown type, dtype is that of objects."""

    name: str
    dtype: np.dtype
    # Type of the length that stands before the values of a list; None for a single value.
    length_dtype: np.dtype | None


class Element(NamedTuple):
    """A kind of rows, such as the vertices."""

    name: str
    n_rows: int
    properties: list[Property]

    @property
    def names(self) -> list[str]:
        """Names of its properties."""
        return [field.name for field in self.properties]

    @property
    def has_lists(self) -> bool:
        """Whether its rows differ in length."""
        return any(field.length_dtype is not None for field in self.properties)

    @property
    def row_dtype(self) -> np.dtype:
        """Of a row in a binary file."""
        return np.dtype([(field.name, field.dtype) for field in self.properties])


class Header(NamedTuple):
    """What a header says; `body` is where the data begins in the file, less a byte order mark."""

    elements: list[Element]
    byte_order: str
    body: int
    comments: list[str]


def read_header(data: bytes) -> Header:
    """The header of a file without a byte order mark; ScanError says what is wrong with it."""
    if not data.startswith(b"ply"):
        raise ScanError("is not a PLY file")
    line_end = line_end_of(data[:LONGEST_HEADER])
    lines: list[str] = []
    position = 0
    while not lines or lines[-1] != "end_header":
        end = data.find(line_end, position, LONGEST_HEADER)
        if end < 0:
            raise ScanError("is not a PLY file: its header does not end")
        lines.append(data[position:end].decode("latin-1").strip())
        position = end + len(line_end)
    byte_order = None
    elements: list[Element] = []
    comments: list[str] = []
    for line in lines[1:-1]:
        match line.split():
            case []:
                pass
            case ["comment" | "obj_info", *words]:
                comments.append(" ".join(words))
            case ["format", encoding, _] if encoding in BYTE_ORDERS:
                byte_order = BYTE_ORDERS[encoding]
            case ["element", name, n_rows] if n_rows.isdecimal() and len(n_rows) <= 18:
                elements.append(Element(name, int(n_rows), []))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= TYPES.keys():
                elements[-1].properties.append(
                    Property(name, _dtype(kind, byte_order), _dtype(length, byte_order))
                )
            # As text, a column of another type can be left out.
            case ["property", kind, name] if elements and (kind in TYPES or byte_order == "="):
                elements[-1].properties.append(Property(name, _dtype(kind, byte_order), None))
            case _:
                raise ScanError(f"the header has the line {line[:60]!r}, which is not known")
    if byte_order is None:
        raise ScanError("the header has no format")
    for element in elements:
        if len(set(element.names)) < len(element.names):
            raise ScanError(f"the element {element.name} names a property twice")
    return Header([_with_small_axes(element) for element in elements], byte_order, position, comments)


def truncated(element: Element) -> ScanError:
    """What to raise where the rows of an element are missing."""
    return ScanError(
        f"is truncated: the header promises {element.n_rows} of the element {element.name}, "
        "the file holds fewer"
    )


def _with_small_axes(element: Element) -> Element:
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
    return np.dtype(byte_order + TYPES[kind]) if kind in TYPES else np.dtype(object)
