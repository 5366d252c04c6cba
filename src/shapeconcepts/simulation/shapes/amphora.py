"""Amphorae: bellied vessels with a neck and two, one or no handles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from shapeconcepts.simulation.shapes.deformation import leaning
from shapeconcepts.simulation.shapes.mesh import Mesh, bezier, join, mirrored, revolve, rotated, tube

PARTS = ("body", "neck", "left handle", "right handle")
BODY, NECK, LEFT_HANDLE, RIGHT_HANDLE = range(4)

# Relative to the height of the vessel.
_WALL = 0.02
_N_OUTER = 72


def make_amphora(rng: np.random.Generator) -> Mesh:
    """An amphora 12 to 36 cm high; three in five have two handles, one in five one; a few lie."""
    height = rng.uniform(0.12, 0.36)
    radii, heights, parts = _outline(rng)
    meshes = [revolve(height * radii, height * heights, labels=parts, n_around=72)]
    n_handles = rng.choice([0, 1, 2], p=[0.2, 0.2, 0.6])
    if n_handles:
        handle = _handle(rng, radii, heights)
        handle = handle._replace(vertices=height * handle.vertices)
        meshes.append(handle)
        if n_handles == 2:
            meshes.append(mirrored(handle, LEFT_HANDLE))
    mesh = join(meshes)
    if rng.random() < 0.2:
        mesh = leaning(mesh, rng, np.radians(rng.uniform(0.0, 4.0)))
    if rng.random() < 0.15:
        return rotated(rotated(mesh, 2, rng.uniform(0.0, 2.0 * np.pi)), 0, np.pi / 2.0)
    return mesh


def _outline(rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Radii and heights of the profile of a vessel of height 1, and the part of each band.

    From the middle of the foot up to the lip and down again inside.
    """
    belly = rng.uniform(0.24, 0.38)
    belly_height = rng.uniform(0.38, 0.6)
    neck = belly * rng.uniform(0.28, 0.5)
    neck_start = rng.uniform(0.72, 0.82)
    lip = neck * rng.uniform(1.1, 1.6)
    foot = belly * rng.uniform(0.3, 0.65)
    waist = max(foot * rng.uniform(0.75, 1.0), 0.05)
    knots = np.array(
        [
            (0.0, foot),
            (0.03, foot),
            (0.07, waist),
            (0.07 + 0.55 * (belly_height - 0.07), waist + (belly - waist) * rng.uniform(0.65, 0.85)),
            (belly_height, belly),
            (
                belly_height + 0.55 * (neck_start - belly_height),
                neck + (belly - neck) * rng.uniform(0.7, 0.88),
            ),
            (neck_start, neck * 1.08),
            (0.5 * neck_start + 0.46, neck),
            (0.97, lip),
            (1.0, lip),
        ]
    )
    outer_heights = np.linspace(0.0, 1.0, _N_OUTER)
    outer = PchipInterpolator(knots[:, 0], knots[:, 1])(outer_heights)
    outer_parts = np.where(outer_heights[1:] <= neck_start, BODY, NECK)
    inner_heights = np.linspace(0.995, neck_start, 12)
    inner = np.interp(inner_heights, outer_heights, outer) - _WALL
    # The inside widens below the neck; what can be seen through the mouth is the bottom.
    radii = np.concatenate([[0.0], outer, inner, [0.9 * belly, 0.7 * foot, 0.0]])
    heights = np.concatenate([[0.0], outer_heights, inner_heights, [belly_height, 0.05, 0.05]])
    parts = np.concatenate([[BODY], outer_parts, np.full(len(inner), NECK), np.full(3, BODY)])
    return radii, heights, parts


def _handle(rng: np.random.Generator, radii: NDArray[np.float64], heights: NDArray[np.float64]) -> Mesh:
    """Handle of a vessel of height 1 in the plane y = 0, from the upper neck to the shoulder."""
    outer = slice(1, 1 + _N_OUTER)
    thickness = rng.uniform(0.018, 0.03)
    top_height = rng.uniform(0.88, 0.95)
    low_height = rng.uniform(0.55, 0.7)
    at_top = np.interp(top_height - thickness, heights[outer], radii[outer])
    at_low = np.interp(low_height, heights[outer], radii[outer])
    reach = max(at_top, at_low) + rng.uniform(0.08, 0.2)
    rise = rng.uniform(0.0, 0.06)
    path = bezier(
        [
            (at_top - 0.3 * _WALL, 0.0, top_height),
            (reach, 0.0, top_height + rise),
            (reach, 0.0, low_height + 0.1),
            (at_low - thickness / 2.0, 0.0, low_height),
        ],
        np.linspace(0.0, 1.0, 24),
    )
    return tube(path, np.full(24, thickness), label=RIGHT_HANDLE, flatness=rng.uniform(0.9, 2.0))
