"""Bowls, mugs and bottles, which stand on tables beside the paper's categories."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from shapeconcepts.simulation.shapes.mesh import Mesh, bezier, join, moved, revolve, rotated, tube


def make_bowl(rng: np.random.Generator) -> Mesh:
    """A bowl 10 to 24 cm across and 4 to 10 cm high."""
    radius = rng.uniform(0.05, 0.12)
    height = radius * rng.uniform(0.7, 0.9)
    wall = rng.uniform(0.003, 0.006)
    foot = radius * rng.uniform(0.35, 0.55)
    turn = np.linspace(0.0, np.pi / 2.0, 24)
    outer = foot + (radius - foot) * np.sin(turn)
    heights = height * (1.0 - np.cos(turn))
    return revolve(
        np.concatenate([[0.0], outer, outer[::-1] - wall, [0.0]]),
        np.concatenate([[0.0], heights, np.maximum(heights[::-1], wall), [wall]]),
    )


def make_mug(rng: np.random.Generator) -> Mesh:
    """A mug 6 to 10 cm across and 7 to 12 cm high, with a handle."""
    radius = rng.uniform(0.03, 0.05)
    height = rng.uniform(0.07, 0.12)
    narrowing = rng.uniform(0.8, 1.0)
    wall = rng.uniform(0.003, 0.005)
    heights = np.linspace(0.0, height, 12)
    outer = radius * (narrowing + (1.0 - narrowing) * heights / height)
    body = revolve(
        np.concatenate([[0.0], outer, outer[::-1] - wall, [0.0]]),
        np.concatenate([[0.0], heights, np.maximum(heights[::-1], wall), [wall]]),
    )
    reach = radius + rng.uniform(0.03, 0.05)
    # Into the wall, not through it.
    low, high = 0.2 * height, 0.85 * height
    ends = np.interp([high, low], heights, outer) - wall / 2.0
    path = bezier(
        [(ends[0], 0.0, high), (reach, 0.0, high), (reach, 0.0, low), (ends[1], 0.0, low)],
        np.linspace(0.0, 1.0, 20),
    )
    return join([body, tube(path, np.full(20, rng.uniform(0.004, 0.006)), flatness=rng.uniform(1.0, 1.8))])


def make_bottle(rng: np.random.Generator) -> Mesh:
    """A bottle 16 to 32 cm high; one in four lies."""
    height = rng.uniform(0.16, 0.32)
    radius = height * rng.uniform(0.11, 0.17)
    neck = radius * rng.uniform(0.3, 0.45)
    shoulder = rng.uniform(0.5, 0.65)
    at = np.linspace(0.0, 1.0, 60)
    outline = PchipInterpolator(
        [0.0, 0.02, shoulder, shoulder + 0.2, 1.0], [0.95 * radius, radius, radius, 1.1 * neck, neck]
    )(at)
    mesh = revolve(np.r_[0.0, outline, 0.0], height * np.r_[0.0, at, 1.0])
    return lying(mesh) if rng.random() < 0.25 else mesh


def lying(mesh: Mesh) -> Mesh:
    """A mesh that stood along z, along y and with its lowest point at the height 0."""
    turned = rotated(mesh, 0, np.pi / 2.0)
    return moved(turned, (0.0, 0.0, -turned.vertices[:, 2].min()))
