"""Reads the meshes that are plain lines of text: Wavefront OBJ, the Object File Format (OFF) and ASCII STL.

Own code, since trimesh 5.2 takes vertex 0 of an OBJ file for 1, counts negative indices from the end of the
file and not from the face, accepts an OFF face with fewer corners than it announces, and leaves out facets of
an STL file that it cannot read.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import Cloud, checked_lines, number_table
from shapeconcepts.io.mesh import Mesh, Polygons
from shapeconcepts.scan import ScanError

# Texture coordinates, colours, normals, and a fourth or more coordinates may come with the vertices.
OFF_KEYWORD = r"(?:ST)?C?N?4?n?OFF"


def read_obj(data: bytes) -> Cloud | Mesh:
    """Mesh of all objects in an OBJ file, or cloud where it has no faces; ScanError where it is damaged.

    Materials are ignored.
    """
    vertices: list[str] = []
    polygons = Polygons()
    # Names and comments may be in any encoding.
    text = data.decode("utf-8-sig", "replace").replace("\\\r\n", " ").replace("\\\n", " ")
    for line in checked_lines(text):
        keyword, *words = line.split() or [""]
        if keyword == "v":
            vertices.append(" ".join(words))
        elif keyword == "f":
            try:
                corners = [_obj_index(word, len(vertices)) for word in words]
            except ValueError:
                raise ScanError(f"has the face {line[:60]!r}, which cannot be read") from None
            polygons.append(corners)
    if not vertices:
        raise ScanError("is not an OBJ file: it has no vertices")
    return _content(vertices, polygons, len(data))


def _obj_index(word: str, n_vertices: int) -> int:
    """Row of the vertex. Files count from 1, or backwards from the last vertex before the face."""
    number = int(word.partition("/")[0])
    index = number - 1 if number > 0 else n_vertices + number
    if number == 0 or index < 0:
        raise ValueError
    return index


def read_off(data: bytes) -> Cloud | Mesh:
    """Mesh from an OFF file, or cloud where it has no faces; ScanError says what is wrong with it."""
    text = data.decode("utf-8-sig", "replace")
    lines = [line.partition("#")[0].strip() for line in checked_lines(text)]
    lines = [line for line in lines if line]
    keyword = re.match(OFF_KEYWORD, lines[0]) if lines else None
    if keyword is None:
        raise ScanError("is not an OFF file")
    # Those of ModelNet40 have them behind the keyword without a blank.
    counts = lines[0][keyword.end() :].split()
    body = 1
    if not counts and len(lines) > 1:
        counts = lines[1].split()
        body = 2
    if len(counts) < 2 or not all(
        count.isascii() and count.isdigit() and len(count) <= 18 for count in counts[:2]
    ):
        raise ScanError("is an OFF file without the numbers of its vertices and faces")
    n_vertices, n_faces = int(counts[0]), int(counts[1])
    if n_vertices + n_faces > len(lines) - body:
        raise ScanError(
            f"is truncated: it promises {n_vertices} vertices and {n_faces} faces, "
            f"it has {len(lines) - body} lines"
        )
    faces = lines[body + n_vertices : body + n_vertices + n_faces]
    polygons = Polygons()
    for line in faces:
        polygons.append(_off_polygon(line))
    return _content(lines[body : body + n_vertices], polygons, len(data))


def _off_polygon(line: str) -> list[int]:
    words = line.split()
    try:
        n_corners = int(words[0])
        # Colours may follow.
        if not 0 <= n_corners < len(words):
            raise ValueError
        return [int(word) for word in words[1 : n_corners + 1]]
    except ValueError:
        raise ScanError(f"has the face {line[:60]!r}, which cannot be read") from None


def read_ascii_stl(data: bytes) -> Mesh:
    """Mesh of all solids in an STL file of text; ScanError says what is wrong with it."""
    vertices: list[str] = []
    n_facets, is_whole, has_ended = 0, False, False
    for line in checked_lines(data.decode("utf-8", "replace")):
        words = line.split()
        if not words:
            continue
        keyword = words[0].lower()
        # Some programs leave the last line out, or write more behind it.
        is_end = keyword == "endsolid" or [word.lower() for word in words[:2]] == ["end", "solid"]
        is_whole = keyword == "endfacet" or is_end or (is_whole and has_ended)
        has_ended = is_end or (has_ended and keyword != "facet")
        if keyword == "vertex":
            vertices.append(" ".join(words[1:]))
        elif keyword == "endfacet":
            n_facets += 1
            if len(vertices) != 3 * n_facets:
                n_corners = len(vertices) - 3 * (n_facets - 1)
                raise ScanError(f"is damaged: facet {n_facets} has {n_corners} vertices, expected 3")
    if not is_whole or len(vertices) != 3 * n_facets:
        raise ScanError("is truncated: an ASCII STL file ends with endsolid, or endfacet at least")
    if not n_facets:
        raise ScanError("is an STL file without facets")
    return Mesh(_coordinates(vertices), np.arange(3 * n_facets).reshape(-1, 3))


def _content(vertices: list[str], polygons: Polygons, file_size: int) -> Cloud | Mesh:
    points = _coordinates(vertices)
    if polygons:
        return Mesh(points, polygons.triangles(file_size))
    return Cloud(points)


def _coordinates(vertices: list[str]) -> NDArray[np.float64]:
    # The table would be without the row, and all later vertices would have another number.
    if "" in vertices:
        raise ScanError(f"vertex {vertices.index('') + 1} has no coordinates, expected 3")
    return number_table(vertices, (0, 1, 2))
