"""Which points of a complete cloud a sensor would see from one place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

# Radius of the sphere that points are flipped at, in distances of the farthest one.
_RADIUS = 100.0
_FEWEST = 5


def visible_points(points: NDArray[np.float64], viewpoint: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Points that no surface hides, found without a surface (Katz, Tal and Basri, Direct visibility of point
    sets, SIGGRAPH 2007).

    Each point is flipped outwards at a large sphere around the viewpoint, so that near ones come to lie
    farthest out; those on the convex hull are visible.

    Parameters
    ----------
    points : (n, 3) float64
        About evenly spread on surfaces.
    viewpoint : (3,) float64
        Outside of them.

    Returns
    -------
    (n,) bool
        All of them where they span no space.
    """
    rays = points - viewpoint
    distances = np.linalg.norm(rays, axis=1, keepdims=True)
    if len(points) < _FEWEST or distances.min() == 0.0:
        return np.ones(len(points), np.bool_)
    flipped = rays * (2.0 * _RADIUS * distances.max() / distances - 1.0)
    try:
        hull = ConvexHull(np.vstack([flipped, np.zeros(3)]))
    except QhullError:
        return np.ones(len(points), np.bool_)
    is_visible = np.zeros(len(points) + 1, np.bool_)
    is_visible[hull.vertices] = True
    return is_visible[:-1]
