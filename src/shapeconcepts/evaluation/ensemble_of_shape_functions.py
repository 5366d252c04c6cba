"""Ensemble of Shape Functions: a histogram of a whole object, without normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.evaluation.ensemble_of_shape_functions_kernels import GRID_SIZE, shape_functions
from shapeconcepts.geometry.canonical_frame import canonical_ball
from shapeconcepts.geometry.points import checked_points

N_TRIPLES = 20_000
# How much each histogram counts, as in the Point Cloud Library: angles, areas, distances (each inside,
# outside, mixed), ratios.
_WEIGHTS = np.array([0.5, 0.5, 0.5, 0.5, 0.5, 1.0, 0.5, 2.0, 2.0, 1.0])
# In squared edges of a voxel; thinner triangles have no angles to speak of.
_SMALLEST_AREA = np.sqrt(1e-3)


def ensemble_of_shape_functions(points: ArrayLike) -> NDArray[np.float64]:
    """Ensemble of Shape Functions of an object (Wohlkinger & Vincze, ROBIO 2011).

    20,000 random triples of points, always the same ones of the same object, give histograms of the
    triangle's angles (A3), of the square root of its area (D3) and of its sides (D2). Each is split by where
    the lines between the points run in a grid of 64 x 64 x 64 voxels: inside the surface's voxels, outside,
    or mixed.
    The tenth histogram holds the shares inside of mixed lines. Thresholds and weights are those of the Point
    Cloud Library.

    The histogram does not depend on position, size, or the order of the points. The grid lies along the
    principal axes, so turning the object changes nothing but for rounding; where rounding decides (equal
    principal axes, points on a border of voxels), a turned object gets other triples or voxels and a
    histogram that is alike, not equal.

    Parameters
    ----------
    points : (m, 3) array-like
        Finite coordinates, in any unit.

    Returns
    -------
    (640,) float64
        Sums to 1; all zero where the points span no triangle.

    Raises
    ------
    ValueError
        If the shape is not (m, 3) or coordinates are not finite.
    """
    cloud = checked_points(points)
    empty = np.zeros(_WEIGHTS.size * 64)
    if len(cloud) < 3:
        return empty
    scaled = canonical_ball(cloud, GRID_SIZE / 2)
    if not scaled.any():
        return empty
    voxels = np.clip(np.floor(scaled + GRID_SIZE / 2), 0, GRID_SIZE - 1).astype(np.int64)
    histograms = shape_functions(scaled, voxels, N_TRIPLES, _SMALLEST_AREA) * _WEIGHTS[:, None]
    mass = histograms.sum()
    return (histograms / mass).ravel() if mass > 0 else empty
