"""Outlines of things from above: how far apart they are, and whether one lies within another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

_CONTACT = 0.0005
_HALVINGS = 14


def footprint(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convex outline (k, 2), counter-clockwise, of points (v, 3) seen from above."""
    flat = vertices[:, :2]
    return flat[ConvexHull(flat).vertices]


def gap(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Widest strip between two convex outlines, metres; negative where they overlap.

    It is at most their distance, and has its sign.
    """
    return max(_gap_beyond(first, second), _gap_beyond(second, first))


def _gap_beyond(outline: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    normals, offsets = _sides(outline)
    return float(((other @ normals.T).min(axis=0) - offsets).max())


def _sides(outline: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outward unit normals (k, 2) of the sides, and their distances from the origin."""
    along = np.roll(outline, -1, axis=0) - outline
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals, np.einsum("ij,ij->i", normals, outline)


def is_within(outline: NDArray[np.float64], region: NDArray[np.float64], margin: float) -> bool:
    """Whether an outline, or points (k, 2), keep a margin in metres from the sides of a convex region."""
    normals, offsets = _sides(region)
    return bool((outline @ normals.T <= offsets - margin).all())


def until_contact(
    outline: NDArray[np.float64], other: NDArray[np.float64], direction: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Shift (2,) that puts an outline beside another one, all but touching it, in a direction (2,)."""
    to_other = other.mean(axis=0) - outline.mean(axis=0)
    near, far = 0.0, float(np.linalg.norm(np.ptp(outline, axis=0)) + np.linalg.norm(np.ptp(other, axis=0)))
    for _ in range(_HALVINGS):
        middle = (near + far) / 2.0
        if gap(outline + to_other + middle * direction, other) < _CONTACT:
            near = middle
        else:
            far = middle
    return to_other + far * direction
