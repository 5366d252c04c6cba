"""Balls: from table tennis to football, slightly out of round."""

from __future__ import annotations

import numpy as np

from shapeconcepts.simulation.shapes.deformation import dented
from shapeconcepts.simulation.shapes.mesh import Mesh, ellipsoid

PARTS = ("ball",)


def make_ball(rng: np.random.Generator) -> Mesh:
    """A ball 4 to 30 cm across; some are squashed by their weight or slightly dented."""
    radius = np.exp(rng.uniform(np.log(0.02), np.log(0.15)))
    squash = rng.uniform(0.0, 0.08) * (rng.random() < 0.4)
    mesh = ellipsoid(radius * np.array([1.0 + squash / 2.0, 1.0 + squash / 2.0, 1.0 - squash]), n=48)
    if rng.random() < 0.2:
        mesh = dented(mesh, rng, depth=rng.uniform(0.01, 0.04) * radius, width=rng.uniform(0.6, 1.0) * radius)
    return mesh
