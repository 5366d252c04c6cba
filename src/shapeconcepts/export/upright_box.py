"""The smallest cuboid around a scan that stands upright."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

# Readers take an edge of no length for one that is not given.
LEAST_EDGE = 0.001
# Metres on each side: points that lie on it shall be inside, whatever rounds.
_MARGIN = 1e-6


class UprightBox(NamedTuple):
    """A cuboid of which two faces are horizontal.

    Attributes
    ----------
    centre : (3,) float64
        Metres.
    dimensions : (3,) float64
        Metres: length, width, at most as long, and height along z.
    yaw : float
        Radians, above -pi/2 and up to pi/2: from the x axis to the length, counter-clockwise around z.
    """

    centre: NDArray[np.float64]
    dimensions: NDArray[np.float64]
    yaw: float


def upright_box(points: NDArray[np.float64]) -> UprightBox:
    """The cuboid around points that stands on a horizontal face and has the smallest base.

    One side of the smallest rectangle around points lies along a side of their convex hull (Freeman and
    Shapira, Determining the minimum-area encasing rectangle, 1975).

    Parameters
    ----------
    points : (n, 3) float64
        Finite, metres, z upwards; one at least.

    Returns
    -------
    UprightBox
        With edges of a millimetre at least.
    """
    middle = points.mean(axis=0)
    corners = _corners(points[:, :2] - middle[:2])
    sides = np.roll(corners, -1, axis=0) - corners
    sides = sides[np.linalg.norm(sides, axis=1) > 0]
    angles = np.append(np.arctan2(sides[:, 1], sides[:, 0]), 0.0)
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    u, v = corners @ along.T, corners @ across.T
    extents = np.stack([np.ptp(u, axis=0), np.ptp(v, axis=0)], axis=1)
    best = int(extents.prod(axis=1).argmin())
    (length, width), yaw = extents[best], angles[best]
    base = along[best] * (u[:, best].min() + u[:, best].max()) / 2
    base = base + across[best] * (v[:, best].min() + v[:, best].max()) / 2
    if width > length:
        length, width, yaw = width, length, yaw + np.pi / 2
    low, high = points[:, 2].min(), points[:, 2].max()
    dimensions = np.maximum(np.array([length, width, high - low]) + 2 * _MARGIN, LEAST_EDGE)
    centre = np.array([*(base + middle[:2]), (low + high) / 2])
    return UprightBox(centre, dimensions, float(np.pi / 2 - (np.pi / 2 - yaw) % np.pi))


def _corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners of the convex hull of points (n, 2) in order; of points on a line, its ends."""
    try:
        return points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        centred = points - points.mean(axis=0)
        _, _, directions = np.linalg.svd(centred[:: max(len(points) // 1000, 1)], full_matrices=False)
        order = np.argsort(centred @ directions[0])
        return points[order[[0, -1]]]
