"""Reads STL and GLB meshes through trimesh.

trimesh leaves out what it cannot read, so what a file announces is counted before and compared after.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO

import numpy as np

from shapeconcepts.io.glb import checked_glb
from shapeconcepts.io.mesh import Mesh
from shapeconcepts.scan import ScanError


def read_stl(data: bytes) -> Mesh:
    """Mesh from a binary or ASCII STL file; ScanError says what is wrong with it."""
    n_faces = int.from_bytes(data[80:84], "little")
    end = 84 + 50 * n_faces
    # Text there reads as a number that no file is long enough for. Some programs write more after the faces.
    if n_faces and end <= len(data):
        return _load(data[:end], "stl", n_faces)
    if not re.match(rb"\s*solid\b", data, re.I):
        raise ScanError("is not an STL file, or truncated")
    if not re.search(rb"^\s*endsolid\b[^\n]*\s*\Z", data[-1000:], re.M | re.I):
        raise ScanError("is truncated: an ASCII STL file ends with endsolid")
    # One nameless solid: every solid costs a mesh of its own, and names may hold keywords and any encoding.
    facets = re.sub(rb"^[ \t]*(?:end)?solid\b[^\n]*$", b"", data, flags=re.M | re.I)
    n_facets = len(re.findall(rb"^[ \t]*facet\b", facets, re.M | re.I))
    return _load(b"solid\n" + facets + b"\nendsolid\n", "stl", n_facets)


def read_glb(data: bytes) -> Mesh:
    """Mesh of all objects of the scene in a binary glTF file, y upwards; ScanError says what is wrong."""
    return _load(checked_glb(data), "glb", 1)


def _load(data: bytes, file_type: str, n_faces: int) -> Mesh:
    # It takes longer to import than all other readers together, and only two formats need it.
    import trimesh

    try:
        with _silent(trimesh.util.log):
            loaded = trimesh.load_mesh(BytesIO(data), file_type=file_type, process=False, skip_materials=True)
        mesh = Mesh(np.array(loaded.vertices, dtype=np.float64), np.array(loaded.faces, dtype=np.int64))
    except Exception as error:  # trimesh raises whatever its parsing runs into
        reason = str(error) or type(error).__name__
        raise ScanError(f"is no {file_type.upper()} mesh that can be read ({reason})") from None
    if len(mesh.faces) < n_faces:
        raise ScanError(f"is damaged: {len(mesh.faces)} of {n_faces} faces can be read")
    return mesh


@contextmanager
def _silent(log: logging.Logger) -> Iterator[None]:
    """What is wrong with a file is told once, by the ScanError."""

    def drop(record: logging.LogRecord) -> bool:
        return False

    # A filter of its own for each call, unlike a saved level, leaves nothing behind when threads overlap.
    log.addFilter(drop)
    try:
        yield
    finally:
        log.removeFilter(drop)
