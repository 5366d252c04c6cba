"""Reads the Polygon File Format (Stanford PLY): point clouds and meshes, ascii and binary.

http://paulbourke.net/dataformats/ply/
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import (
    LABEL_NAMES,
    VIEWPOINT_NAMES,
    Cloud,
    decoded_lines,
    labels_or_notice,
    number_table,
    value_or_notice,
    without_mark,
)
from shapeconcepts.io.mesh import Mesh
from shapeconcepts.io.ply_faces import ascii_faces, binary_faces
from shapeconcepts.io.ply_header import FACE_NAMES, Element, read_header, truncated
from shapeconcepts.io.viewpoint import common_position, unless_default, viewpoint_in_comments
from shapeconcepts.scan import ScanError

# The camera, as the Point Cloud Library writes it.
_CAMERA_POSITION = ("view_px", "view_py", "view_pz")


class _Rows(NamedTuple):
    """The rows of an element: what gives its columns by name, and where they end.

    That is a line of a text, else a byte: thousands of elements must not copy what is behind each.
    """

    columns: Callable[[list[str]], list[NDArray]]
    lines: list[str]
    end: int


def read_ply(data: bytes) -> Cloud | Mesh:
    """Mesh where the file has faces, otherwise cloud; ScanError says what is wrong with it."""
    data = without_mark(data)
    elements, byte_order, body, comments = read_header(data)
    names = [element.name for element in elements]
    if "vertex" not in names:
        raise ScanError("has no element vertex")
    place = names.index("vertex")
    vertex, others = elements[place], elements[place + 1 :]
    for axis in "xyz":
        if axis not in vertex.names:
            raise ScanError(f"the element vertex has no property {axis}")
        if vertex.properties[vertex.names.index(axis)].dtype.kind not in "iuf":
            raise ScanError(f"the property {axis} of the element vertex has a type that is not known")
    for element in elements[: place + 1]:
        if element.has_lists:
            raise ScanError(
                f"the element {element.name} has a list, supported is that after the vertices only"
            )
    face = _face_element(others)

    is_text = byte_order == "="
    rows = _Rows(lambda _: [], [], body)
    if is_text:
        rows = rows._replace(lines=_lines_with_content(data[body:]), end=0)
    for element in elements[: place + 1]:
        rows = _next_rows(rows, data, element, is_text)
    points = np.column_stack([column.astype(np.float64) for column in rows.columns([*"xyz"])])
    if face is not None:
        polygons = (
            ascii_faces(rows.lines[rows.end :], face)
            if is_text
            else binary_faces(data, rows.end, face, byte_order)
        )
        return Mesh(points, polygons.triangles(len(data)))
    label = next((name for name in LABEL_NAMES if name in vertex.names), None)
    labels, of_labels = labels_or_notice(lambda: None if label is None else rows.columns([label])[0])

    def declared() -> NDArray[np.float64] | None:
        position = viewpoint_in_comments(comments)
        if position is None and set(VIEWPOINT_NAMES) <= set(vertex.names):
            position = unless_default(common_position(rows.columns([*VIEWPOINT_NAMES])))
        return _camera_position(rows, data, others, is_text) if position is None else position

    viewpoint, of_viewpoint = value_or_notice("a viewpoint", declared)
    return Cloud(points, viewpoint, labels, of_viewpoint + of_labels)


def _lines_with_content(data: bytes) -> list[str]:
    return [line for line in decoded_lines(data) if line.strip()]


def _face_element(after_vertices: list[Element]) -> Element | None:
    """The faces, None where the file is a point cloud."""
    if not any(element.name == "face" and element.n_rows for element in after_vertices):
        return None
    face = after_vertices[0]
    if face.name != "face":
        raise ScanError(f"the element {face.name} stands between vertices and faces, which is not supported")
    if not any(field.name in FACE_NAMES and field.dtype.kind in "iu" for field in face.properties):
        raise ScanError(f"the element face has no list of integers {' or '.join(FACE_NAMES)}")
    return face


def _next_rows(rows: _Rows, data: bytes, element: Element, is_text: bool) -> _Rows:
    """Rows of the element behind some, which must have no list."""
    return _text_rows(rows, element) if is_text else _binary_rows(rows, data, element)


def _binary_rows(rows: _Rows, data: bytes, element: Element) -> _Rows:
    dtype = element.row_dtype
    if element.n_rows * dtype.itemsize > len(data) - rows.end:
        raise truncated(element)
    content = np.frombuffer(data, dtype, element.n_rows, rows.end)
    return _Rows(lambda names: [content[name] for name in names], [], rows.end + content.nbytes)


def _text_rows(rows: _Rows, element: Element) -> _Rows:
    end = rows.end + element.n_rows
    if end > len(rows.lines):
        raise truncated(element)
    lines = rows.lines[rows.end : end]
    names = element.names
    for line in (*lines[:1], *lines[-1:]):
        if element.name == "vertex" and (n := len(line.split())) != len(names):
            raise ScanError(f"has {n} numbers a vertex, the header describes {len(names)}")

    def columns(wanted: list[str]) -> list[NDArray]:
        # All digits that are there, whatever the type of the property.
        return list(number_table(lines, [names.index(name) for name in wanted]).T)

    return _Rows(columns, rows.lines, end)


def _camera_position(
    rows: _Rows, data: bytes, others: list[Element], is_text: bool
) -> NDArray[np.float64] | None:
    """Where the camera stood, if that is among the elements behind the vertices."""
    for element in others:
        if element.has_lists and element.n_rows:
            break
        rows = _next_rows(rows, data, element, is_text)
        if element.name == "camera" and element.n_rows and set(_CAMERA_POSITION) <= set(element.names):
            return unless_default(common_position(rows.columns([*_CAMERA_POSITION])))
    return None
