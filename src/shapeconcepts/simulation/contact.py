"""Which surfaces come so close that a depth camera cannot tell whether they touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts.simulation.footprint import footprint, gap
from shapeconcepts.simulation.shapes.mesh import Mesh

TOUCHING = 0.01
_SPACING = 0.003


def touching_pairs(meshes: Sequence[Mesh]) -> list[tuple[int, int]]:
    """Pairs of meshes whose surfaces come within a centimetre of one another, to about 2 mm."""
    outlines = [footprint(mesh.vertices) for mesh in meshes]
    near = [
        (first, second)
        for second in range(len(meshes))
        for first in range(second)
        if gap(outlines[first], outlines[second]) < TOUCHING
    ]
    points = {index: _on_surface(meshes[index]) for index in {index for pair in near for index in pair}}
    return [(first, second) for first, second in near if _meet(points[first], points[second])]


def _meet(first: NDArray[np.float64], second: NDArray[np.float64]) -> bool:
    """Whether two sets of points (n, 3) come within a centimetre of one another."""
    low = np.maximum(first.min(axis=0), second.min(axis=0)) - TOUCHING
    high = np.minimum(first.max(axis=0), second.max(axis=0)) + TOUCHING
    first, second = (points[((points >= low) & (points <= high)).all(axis=1)] for points in (first, second))
    if not len(first) or not len(second):
        return False
    distances, _ = cKDTree(first).query(second, distance_upper_bound=TOUCHING)
    return bool(np.isfinite(distances).any())


def _on_surface(mesh: Mesh) -> NDArray[np.float64]:
    """Points (n, 3) a few millimetres apart on all of its triangles."""
    first, second, third = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    longest = np.linalg.norm(np.stack([second - first, third - second, first - third]), axis=2).max(axis=0)
    n_steps = np.maximum(np.ceil(longest / _SPACING).astype(int), 1)
    found = []
    for n in np.unique(n_steps):
        rows = n_steps == n
        a, b = np.divmod(np.arange((n + 1) ** 2), n + 1)
        inside = a + b <= n
        weights = np.column_stack([n - a - b, a, b])[inside] / n
        corners = np.stack([first[rows], second[rows], third[rows]], axis=1)
        found.append(np.einsum("wk,fkx->fwx", weights, corners).reshape(-1, 3))
    return np.concatenate(found)
