"""Boxes: flat, tall, cubic, any; sharp or soft edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.shapes.deformation import dented, leaning
from shapeconcepts.simulation.shapes.mesh import Mesh, join, sheet

PARTS = ("left", "right", "front", "back", "bottom", "top")
_SHORTEST, _LONGEST, _LARGEST_DIAGONAL = 0.04, 0.32, 0.45


def make_box(rng: np.random.Generator) -> Mesh:
    """A box of 4 to 32 cm with slightly rounded edges; some lean, bulge or have a shallow dent."""
    half = _edge_lengths(rng) / 2.0
    mesh = rounded_box(half, radius=rng.uniform(0.0005, 0.004))
    if rng.random() < 0.3:
        mesh = _bulging(mesh, half, rng.uniform(-0.01, 0.02) * half.min())
    if rng.random() < 0.3:
        mesh = leaning(mesh, rng, np.radians(rng.uniform(0.0, 3.0)))
    if rng.random() < 0.2:
        mesh = dented(mesh, rng, depth=rng.uniform(0.001, 0.003), width=rng.uniform(0.02, 0.05))
    return mesh


def _edge_lengths(rng: np.random.Generator) -> NDArray[np.float64]:
    """Width, depth and height in metres."""
    kind = rng.choice(["flat", "tall", "cubic", "any"], p=[0.25, 0.25, 0.15, 0.35])
    while True:
        lengths = np.exp(rng.uniform(np.log(_SHORTEST), np.log(_LONGEST), 3))
        if kind == "flat":
            lengths = np.sort(lengths)[::-1]
        elif kind == "tall":
            lengths = np.sort(lengths)
        elif kind == "cubic":
            lengths = np.clip(lengths[0] * rng.uniform(0.85, 1.15, 3), _SHORTEST, _LONGEST)
        if np.linalg.norm(lengths) <= _LARGEST_DIAGONAL:
            return lengths


def rounded_box(half: NDArray[np.float64], radius: float, n: int = 8, n_round: int = 3) -> Mesh:
    """Box about the origin with half edge lengths (3,); each face owns its half of the rounded edges.

    The faces of a sharp box are cut into grids; whatever lies within `radius` of an edge is drawn onto the
    sphere of that radius around the nearest point of the core.
    """
    sides = []
    for axis in range(3):
        u, v = [(1, 2), (2, 0), (0, 1)][axis]
        along_u, along_v = _grid_line(half[u], radius, n, n_round), _grid_line(half[v], radius, n, n_round)
        for label, side in ((2 * axis, -1.0), (2 * axis + 1, 1.0)):
            points = np.empty((len(along_u), len(along_v), 3))
            points[..., axis] = side * half[axis]
            points[..., u] = along_u[:, None]
            points[..., v] = along_v[None, :]
            sides.append(sheet(points, label))
    mesh = join(sides)
    core = np.clip(mesh.vertices, radius - half, half - radius)
    outward = mesh.vertices - core
    return mesh._replace(vertices=core + radius * outward / np.linalg.norm(outward, axis=1, keepdims=True))


def _grid_line(half: float, radius: float, n: int, n_round: int) -> NDArray[np.float64]:
    rounding = radius * np.tan(np.linspace(0.0, np.pi / 4.0, n_round + 1))[1:]
    flat = np.linspace(radius - half, half - radius, n + 1)
    return np.concatenate([radius - half - rounding[::-1], flat, half - radius + rounding])


def _bulging(mesh: Mesh, half: NDArray[np.float64], height: float) -> Mesh:
    """Move the middle of each face outwards by a height in metres, the edges not at all."""
    place = np.clip(mesh.vertices / half, -1.0, 1.0)
    swell = 1.0 - place**2
    outward = np.column_stack(
        [
            place[:, 0] * swell[:, 1] * swell[:, 2],
            place[:, 1] * swell[:, 2] * swell[:, 0],
            place[:, 2] * swell[:, 0] * swell[:, 1],
        ]
    )
    return mesh._replace(vertices=mesh.vertices + height * outward)
