"""Smooth changes that keep what a surface part is: dents, crumples, lean."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.shapes.mesh import Mesh


def dented(mesh: Mesh, rng: np.random.Generator, depth: float, width: float) -> Mesh:
    """Press one soft dent of a depth and width in metres towards the middle, at a random vertex."""
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2.0
    place = mesh.vertices[rng.integers(len(mesh.vertices))]
    inward = (middle - place) / max(float(np.linalg.norm(middle - place)), 1e-9)
    distance = np.linalg.norm(mesh.vertices - place, axis=1)
    return mesh._replace(
        vertices=mesh.vertices + depth * np.exp(-((distance / width) ** 2))[:, None] * inward
    )


def crumpled(
    mesh: Mesh, rng: np.random.Generator, amplitude: float, wavelength: float, n_waves: int = 12
) -> Mesh:
    """Add a smooth random displacement with a root mean square length and shortest wavelength in metres."""
    return mesh._replace(
        vertices=mesh.vertices + _random_waves(mesh.vertices, rng, amplitude, wavelength, n_waves)
    )


def leaning(mesh: Mesh, rng: np.random.Generator, angle: float) -> Mesh:
    """Shear upwards in a random direction, by an angle in radians."""
    azimuth = rng.uniform(0.0, 2.0 * np.pi)
    shift = np.tan(angle) * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    return mesh._replace(vertices=mesh.vertices + mesh.vertices[:, 2:] * shift)


def _random_waves(
    points: NDArray[np.float64], rng: np.random.Generator, amplitude: float, wavelength: float, n_waves: int
) -> NDArray[np.float64]:
    directions = rng.standard_normal((n_waves, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    frequency = 2.0 * np.pi / (wavelength * rng.uniform(1.0, 2.5, n_waves))
    phase = rng.uniform(0.0, 2.0 * np.pi, n_waves)
    push = rng.standard_normal((n_waves, 3)) * np.sqrt(2.0 / (3.0 * n_waves))
    return amplitude * np.sin(points @ (directions * frequency[:, None]).T + phase) @ push
