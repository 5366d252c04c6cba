"""Sacks: lying cushions of rice, standing paper bags (some nearly boxes), tied sacks."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from shapeconcepts.simulation.shapes.deformation import crumpled, dented, leaning
from shapeconcepts.simulation.shapes.mesh import Mesh, loft, rotated

PARTS = ("body", "mouth")
BODY, MOUTH = range(2)


def make_sack(rng: np.random.Generator) -> Mesh:
    """A filled bag 14 to 34 cm long: a lying cushion, a standing bag with a flat seam, or a tied sack."""
    kinds = (_cushion, _paper_bag, _tied_sack)
    mesh = kinds[rng.choice(3, p=[0.35, 0.35, 0.3])](rng)
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    mesh = crumpled(mesh, rng, amplitude=rng.uniform(0.004, 0.012) * size, wavelength=0.25 * size)
    mesh = crumpled(mesh, rng, amplitude=rng.uniform(0.001, 0.003), wavelength=0.03)
    for _ in range(rng.integers(0, 3)):
        mesh = dented(mesh, rng, depth=rng.uniform(0.01, 0.05) * size, width=rng.uniform(0.1, 0.25) * size)
    return mesh


def _cushion(rng: np.random.Generator) -> Mesh:
    """Two seams at the ends, flattened below by its weight."""
    half_length = rng.uniform(0.07, 0.17)
    half_width = half_length * rng.uniform(0.5, 0.8)
    half_thickness = half_length * rng.uniform(0.25, 0.42)
    fraction = np.sin(np.linspace(-np.pi / 2.0, np.pi / 2.0, 40))
    fullness = (1.0 - np.abs(fraction) ** rng.uniform(2.5, 5.0)) ** 0.6
    width = half_width * (1.0 - rng.uniform(0.05, 0.2) * fullness)
    exponent = 2.0 + rng.uniform(0.3, 2.0) * fullness
    closed = np.concatenate([[0.0], np.ones(38), [0.0]])
    mesh = loft(
        closed * width,
        closed * (0.002 + half_thickness * fullness),
        half_length * fraction,
        exponent=exponent,
        n_around=80,
    )
    mesh = rotated(mesh, 0, np.pi / 2.0)
    below = mesh.vertices[:, 2] < 0.0
    flat = mesh.vertices.copy()
    flat[below, 2] *= rng.uniform(0.4, 0.8)
    return mesh._replace(vertices=flat)


def _paper_bag(rng: np.random.Generator) -> Mesh:
    """Stands on a rounded rectangle and closes to a seam, or is folded flat at the top like a box."""
    height = rng.uniform(0.14, 0.32)
    half_width = height * rng.uniform(0.25, 0.42)
    half_depth = half_width * rng.uniform(0.5, 0.9)
    like_box = rng.random() < 0.4
    seam = rng.uniform(0.75, 0.95) if like_box else rng.uniform(0.04, 0.15)
    shoulder = rng.uniform(0.85, 0.95) if like_box else rng.uniform(0.5, 0.75)
    bulge = rng.uniform(1.03, 1.15)
    at = np.linspace(0.0, 1.0, 48)
    depth = PchipInterpolator([0.0, 0.06, 0.4, shoulder, 1.0], [0.85, 1.0, bulge, 0.97, seam])(at)
    width = PchipInterpolator([0.0, 0.06, 0.4, shoulder, 1.0], [0.92, 1.0, bulge, 1.0, 0.95])(at)
    closing = np.r_[0.0, np.ones(48), 0.0]
    at, depth, width = np.r_[0.0, at, 1.0], np.r_[depth[0], depth, seam], np.r_[width[0], width, 0.95]
    parts = np.where(at[1:] > (1.5 if like_box else 0.92), MOUTH, BODY)
    mesh = loft(
        closing * half_width * width,
        closing * half_depth * depth,
        height * at,
        labels=parts,
        exponent=rng.uniform(3.0, 7.0),
        n_around=96,
    )
    mesh = leaning(mesh, rng, np.radians(rng.uniform(0.0, 8.0)))
    return rotated(mesh, 0, np.pi / 2.0) if rng.random() < 0.25 else mesh


def _tied_sack(rng: np.random.Generator) -> Mesh:
    """A round body, a cord around the neck, and the folds of the open end above it."""
    height = rng.uniform(0.15, 0.32)
    belly = height * rng.uniform(0.3, 0.45)
    cord = rng.uniform(0.72, 0.82)
    neck = rng.uniform(0.2, 0.35)
    flare = neck * rng.uniform(1.6, 2.6)
    at = np.linspace(0.0, 1.0, 64)
    outline = PchipInterpolator(
        [0.0, 0.05, 0.3, 0.55 * cord + 0.1, cord, 1.0], [0.75, 0.92, 1.0, 0.85, neck, flare]
    )(at)
    n_folds = rng.integers(6, 12)
    parts = np.where(at > cord, MOUTH, BODY)
    radii = np.r_[0.0, belly * outline, 0.0]
    heights = height * np.r_[0.0, at, 0.97]
    mesh = loft(radii, radii * rng.uniform(0.75, 1.0), heights, labels=np.r_[BODY, parts], n_around=120)
    turn = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    # Folds gather towards the cord and stay in the open end.
    depth = 0.18 * np.clip((mesh.vertices[:, 2] / height - 0.45 * cord) / (0.55 * cord), 0.0, 1.0) ** 2
    fold = 1.0 + depth * np.sin(n_folds * turn + rng.uniform(0.0, 2.0 * np.pi))
    return mesh._replace(vertices=mesh.vertices * np.column_stack([fold, fold, np.ones_like(fold)]))
