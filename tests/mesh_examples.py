"""A small mesh for the tests of mesh files, and what it looks like after reading."""

import numpy as np
import trimesh

# A unit square and a triangle beside it, in cm around (1, 2, 3).
VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1.0]]) * 0.1 + [1, 2, 3]
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 4]])


def write(tmp_path, data, name):
    path = tmp_path / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


def corners(vertices, faces):
    """Triangles as sorted coordinates, which do not depend on how a file shares its vertices."""
    return np.array(sorted(np.round(vertices[faces], 5).reshape(-1, 9).tolist()))


def exported(file_type):
    mesh = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
    data = mesh.export(file_type=file_type)
    return data.encode() if isinstance(data, str) else data
