"""Plates: dinner and soup plates, saucers, platters; lying, upside down, or leaning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.shapes.mesh import Mesh, loft, rotated

PARTS = ("plate",)


def make_plate(rng: np.random.Generator) -> Mesh:
    """A plate 14 to 30 cm across, 1 to 5 cm deep; one in five oval, one in five nearly square."""
    radius = rng.uniform(0.07, 0.15)
    depth = radius * rng.uniform(0.1, 0.35)
    well = radius * rng.uniform(0.5, 0.75)
    wall = well + rng.uniform(0.3, 1.0) * (radius - well)
    rim_rise = depth * rng.uniform(0.05, 0.4)
    thickness = rng.uniform(0.003, 0.006)
    upper = _rounded_line(
        [(0.0, 0.0), (well, 0.0), (wall, depth - rim_rise), (radius, depth)], smoothness=0.15 * radius
    )
    # Under the plate, from the middle outwards, then over the edge and back inside.
    radii = np.concatenate([upper[:, 0], upper[::-1, 0]])
    heights = np.concatenate([upper[:, 1] - thickness, upper[::-1, 1]])
    kind = rng.choice(["round", "oval", "square"], p=[0.6, 0.2, 0.2])
    stretch = rng.uniform(1.1, 1.35) if kind == "oval" else 1.0
    exponent = rng.uniform(3.0, 6.0) if kind == "square" else 2.0
    mesh = loft(radii, radii / stretch, heights, exponent=exponent, n_around=80)
    return _posed(mesh, rng)


def _posed(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    pose = rng.choice(["lying", "upside down", "leaning"], p=[0.6, 0.15, 0.25])
    if pose == "lying":
        return mesh
    tilt = np.pi if pose == "upside down" else np.radians(rng.uniform(50.0, 80.0))
    return rotated(mesh, 0, tilt)


def _rounded_line(corners: list[tuple[float, float]], smoothness: float) -> NDArray[np.float64]:
    """A polyline as 48 points with its corners rounded over a length."""
    line = np.array(corners)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, length[-1], 48)
    window = np.linspace(-smoothness / 2.0, smoothness / 2.0, 15)
    # The window shrinks towards the ends, which therefore stay in their places.
    offsets = (
        at[:, None] + window * (np.minimum(at, length[-1] - at) / (smoothness / 2.0)).clip(max=1.0)[:, None]
    )
    return np.column_stack([np.interp(offsets, length, line[:, k]).mean(axis=1) for k in range(2)])
