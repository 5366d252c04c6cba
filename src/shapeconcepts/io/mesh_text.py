"""Reads the meshes that are plain lines of text: Wavefront OBJ and the Object File Format (OFF).

Own code, since trimesh 5.2 takes vertex 0 of an OBJ file for 1, counts negative indices from the end of the
file and not from the face, and accepts an OFF face with fewer corners than it announces.
"""

from __future__ import annotations

from shapeconcepts.io.cloud import checked_lines, number_table
from shapeconcepts.io.mesh import Mesh, Polygons
from shapeconcepts.scan import ScanError


def read_obj(data: bytes) -> Mesh:
    """Mesh of all objects in an OBJ file; ScanError says what is wrong with it. Materials are ignored."""
    vertices: list[str] = []
    polygons = Polygons()
    # Names and comments may be in any encoding.
    text = data.decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ")
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
    if not polygons:
        raise ScanError("is not an OBJ mesh: it has no faces")
    return Mesh(number_table(vertices, (0, 1, 2)), polygons.triangles(len(data)))


def _obj_index(word: str, n_vertices: int) -> int:
    """Row of the vertex. Files count from 1, or backwards from the last vertex before the face."""
    number = int(word.partition("/")[0])
    index = number - 1 if number > 0 else n_vertices + number
    if number == 0 or index < 0:
        raise ValueError
    return index


def read_off(data: bytes) -> Mesh:
    """Mesh from an OFF file; ScanError says what is wrong with it."""
    text = data.decode("utf-8", "replace")
    lines = [line.partition("#")[0].strip() for line in checked_lines(text)]
    lines = [line for line in lines if line]
    keyword, *counts = lines[0].split() if lines else [""]
    if not keyword.endswith("OFF"):
        raise ScanError("is not an OFF file")
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
    return Mesh(number_table(lines[body : body + n_vertices], (0, 1, 2)), polygons.triangles(len(data)))


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
