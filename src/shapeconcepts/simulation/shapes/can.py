"""Cans: food and drink cans, tins, pots; standing or lying."""

from __future__ import annotations

import numpy as np

from shapeconcepts.simulation.shapes.deformation import dented
from shapeconcepts.simulation.shapes.mesh import Mesh, loft, rotated

PARTS = ("side", "top", "bottom")
SIDE, TOP, BOTTOM = range(3)


def make_can(rng: np.random.Generator) -> Mesh:
    """A can 5 to 17 cm across and 4 to 30 cm high, flat or recessed at the ends, one in four lying.

    The bevelled rim of the base belongs to the side, from where it is seen; that of the lid to the lid.
    """
    radius = np.exp(rng.uniform(np.log(0.025), np.log(0.085)))
    height = float(np.clip(2.0 * radius * np.exp(rng.uniform(np.log(0.6), np.log(2.8))), 0.04, 0.3))
    oval = 1.0 + rng.uniform(0.0, 0.04) * (rng.random() < 0.3)
    narrowing = rng.uniform(0.0, 0.06) * (rng.random() < 0.25)
    shoulder = rng.uniform(0.0, 0.04) * radius
    lid_depth = rng.choice([0.0, rng.uniform(0.001, 0.004)])
    base_depth = rng.uniform(0.0, 0.003)
    rim = 0.0015
    profile = [
        (0.0, base_depth, BOTTOM),
        (radius - 2.0 * rim, base_depth, BOTTOM),
        (radius - 2.0 * rim, 0.0, BOTTOM),
        (radius - rim, 0.0, SIDE),
        *((radius, z, SIDE) for z in np.linspace(rim, height - 3.0 * shoulder - rim, 12)),
        (radius - shoulder, height - rim, TOP),
        (radius - shoulder - rim, height, TOP),
        (radius - shoulder - 2.0 * rim, height, TOP),
        (radius - shoulder - 2.0 * rim, height - lid_depth, TOP),
        (0.0, height - lid_depth, TOP),
    ]
    radii, heights, parts = (np.array(column) for column in zip(*profile, strict=True))
    radii = radii * (1.0 - narrowing * heights / height)
    mesh = loft(radii * oval, radii / oval, heights, labels=parts[:-1].astype(int), n_around=96)
    if rng.random() < 0.25:
        mesh = dented(mesh, rng, depth=rng.uniform(0.02, 0.06) * radius, width=rng.uniform(0.5, 1.0) * radius)
    return rotated(mesh, 0, np.pi / 2.0) if rng.random() < 0.25 else mesh
