"""Reads the meshes that are binary: STL, and GLB through trimesh.

trimesh leaves out what it cannot read, so what a file announces is checked before.
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
from shapeconcepts.io.mesh_text import read_ascii_stl
from shapeconcepts.scan import ScanError

STL_HEADER = 84
STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes) -> Mesh:
    """Mesh from a binary or ASCII STL file; ScanError says what is wrong with it."""
    n_facets = int.from_bytes(data[STL_HEADER - 4 : STL_HEADER], "little")
    # Text there reads as a number that no file is long enough for. Some programs write more after the facets.
    if n_facets and STL_HEADER + n_facets * STL_FACET.itemsize <= len(data):
        facets = np.frombuffer(data, STL_FACET, n_facets, STL_HEADER)
        vertices = facets["corners"].reshape(-1, 3).astype(np.float64)
        return Mesh(vertices, np.arange(3 * n_facets).reshape(-1, 3))
    if not re.match(rb"\s*solid\b", data, re.I):
        raise ScanError("is not an STL file, or truncated")
    return read_ascii_stl(data)


def read_glb(data: bytes) -> Mesh:
    """Mesh of all objects of the scene in a binary glTF file, y upwards; ScanError says what is wrong."""
    data = checked_glb(data)
    # It takes longer to import than all readers together, and only this format needs it.
    import trimesh

    try:
        with _silent(trimesh.util.log), np.errstate(over="ignore", invalid="ignore"):
            loaded = trimesh.load_mesh(BytesIO(data), file_type="glb", process=False, skip_materials=True)
        return Mesh(np.array(loaded.vertices, dtype=np.float64), np.array(loaded.faces, dtype=np.int64))
    except Exception as error:  # trimesh raises whatever its parsing runs into
        reason = str(error) or type(error).__name__
        raise ScanError(f"is no GLB mesh that can be read ({reason})") from None


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
