"""Meshes of tableware and packets, none of them made after a scan: what someone with CAD models has."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shapeconcepts.simulation.shapes import SHAPES
from shapeconcepts.simulation.shapes.mesh import Mesh, bezier, join, loft, moved, revolve, tube

WALL = 0.003


def vessel(radii: np.ndarray, heights: np.ndarray) -> Mesh:
    """An open solid of revolution with a wall, from the profile of its outside."""
    inside = np.maximum(radii - WALL, 0.0)
    profile = np.concatenate([[0.0], radii, inside[::-1], [0.0]])
    z = np.concatenate([[heights[0]], heights, heights[::-1] + np.linspace(0, WALL, len(heights)), [WALL]])
    return revolve(profile, z)


def make_bowl(rng: np.random.Generator) -> Mesh:
    radius, depth, foot = rng.uniform(0.05, 0.12), rng.uniform(0.4, 0.8), rng.uniform(0.3, 0.5)
    t = np.linspace(0, 1, 14)
    rise = rng.uniform(1.6, 3.0)
    return vessel(radius * (foot + (1 - foot) * t), radius * depth * t**rise)


def make_plate(rng: np.random.Generator) -> Mesh:
    radius, height, flat = rng.uniform(0.08, 0.14), rng.uniform(0.012, 0.03), rng.uniform(0.55, 0.75)
    t = np.linspace(0, 1, 16)
    return vessel(radius * np.maximum(t, 0.02), height * np.clip((t - flat) / (1 - flat), 0, 1) ** 1.3)


def make_cup(rng: np.random.Generator) -> Mesh:
    top, height = rng.uniform(0.03, 0.05), rng.uniform(0.08, 0.16)
    foot = top * rng.uniform(0.6, 0.9)
    t = np.linspace(0, 1, 12)
    return vessel(foot + (top - foot) * t, height * t)


def make_mug(rng: np.random.Generator) -> Mesh:
    radius, height = rng.uniform(0.035, 0.05), rng.uniform(0.08, 0.11)
    body = vessel(np.full(12, radius) * rng.uniform(0.9, 1.1, 1), height * np.linspace(0, 1, 12))
    reach, thick = rng.uniform(0.025, 0.04), rng.uniform(0.004, 0.007)
    outer = body.vertices[:, 0].max()
    corners = [(outer - 0.003, 0, 0.2 * height), (outer + 1.4 * reach, 0, 0.2 * height)]
    corners += [(outer + 1.4 * reach, 0, 0.85 * height), (outer - 0.003, 0, 0.85 * height)]
    path = bezier(np.array(corners), np.linspace(0, 1, 20))
    return join([body, tube(path, np.full(20, thick))])


def make_carton(rng: np.random.Generator) -> Mesh:
    half, height = rng.uniform(0.03, 0.05), rng.uniform(0.14, 0.25)
    depth = half * rng.uniform(0.7, 1.0)
    body = [(0, 0, 0), (half, depth, 0), (half, depth, height)]
    roof = rng.uniform(0.02, 0.04)
    gable = [(half, 0.003, height + roof), (half, 0.003, height + 1.6 * roof), (0, 0, height + 1.6 * roof)]
    widths, depths, heights = np.array(body + (gable if rng.random() < 0.6 else [(0, 0, height)])).T
    return loft(widths, depths, heights, exponent=40.0, n_around=128)


def make_cutlery(rng: np.random.Generator) -> Mesh:
    length, width = rng.uniform(0.15, 0.21), rng.uniform(0.007, 0.011)
    t = np.linspace(0, 1, 24)
    bend = rng.uniform(0.005, 0.015) * np.sin(np.pi * t)
    path = np.column_stack([length * t, np.zeros(24), bend])
    kind = rng.integers(3)
    head = np.clip((t - 0.72) / 0.28, 0, 1)
    girth = width * np.where(t < 0.72, 0.7 - 0.4 * t, 0.4)
    if kind == 0:
        girth = np.maximum(girth, width * 1.9 * np.sqrt(np.clip(head * (1 - head) * 4, 0, 1)))
        return tube(path[:, [1, 0, 2]], girth, flatness=0.18)
    if kind == 1:
        return tube(path, np.where(t > 0.45, 1.1, 0.8) * width * np.minimum(1, (1 - t) * 8), flatness=0.2)
    handle = tube(path[:19, [1, 0, 2]], girth[:19], flatness=0.25)
    bridge = tube(np.array([(-width * 1.2, length * 0.78, 0.004), (0, length * 0.77, 0.003),
                            (width * 1.2, length * 0.78, 0.004)]), np.full(3, width * 0.5))  # fmt: skip
    tines = [
        moved(tube(np.array([(0, length * s, 0.003) for s in (0.77, 0.88, 0.99)]), [0.0016] * 3), (x, 0, 0))
        for x in np.linspace(-width * 1.1, width * 1.1, 4)
    ]
    return join([handle, bridge, *tines])


TABLEWARE: dict[str, Callable[[np.random.Generator], Mesh]] = {
    "bowl": make_bowl,
    "can": SHAPES["can"],
    "carton": make_carton,
    "cup": make_cup,
    "cutlery": make_cutlery,
    "mug": make_mug,
    "plate": make_plate,
}
