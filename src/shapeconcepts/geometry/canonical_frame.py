"""A frame that moves along with the points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.point_kernels import centred_rows


def canonical_coordinates(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Express points in the frame of their own principal axes.

    A grid laid in this frame cuts the same object into the same cells wherever it stands and whatever the
    order of its points, so that nothing that follows depends on the pose. The axes are signed by the skewness
    of the points along them. The frame may be left-handed, which no grid notices.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1.

    Returns
    -------
    (n, 3) float64
        Coordinates relative to the centroid, along the axes of falling variance.
    """
    return _signed_frame(points)[0].T


def canonical_axes(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes of `canonical_coordinates`, (3, 3) float64: unit columns of falling variance."""
    return _signed_frame(points)[1]


def _signed_frame(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    centred = centred_rows(points)  # few long rows are faster to compute with than many short ones
    _, axes = np.linalg.eigh(centred @ centred.T / len(points))
    axes = axes[:, ::-1]
    coordinates = axes.T @ centred
    skewness = (coordinates * coordinates * coordinates).sum(axis=1, keepdims=True)
    signs = np.where(skewness < 0, -1.0, 1.0)
    return coordinates * signs, axes * signs.T


def canonical_ball(points: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Points in their canonical frame, scaled until they fill a ball, and in an order of their own.

    Neither pose nor size nor the order of the points is left, but for rounding.

    Parameters
    ----------
    points : (n, 3) float64
        Finite coordinates, n >= 1.
    radius : float
        Distance of the farthest point from the centroid afterwards, unless all points are at one place.

    Returns
    -------
    (n, 3) float64
        Sorted by the last coordinate, then the one before, then the first.
    """
    # The order of the points must not reach the sums behind the principal axes either.
    coordinates = canonical_coordinates(_sorted(points))
    extent = np.sqrt((coordinates**2).sum(axis=1).max())
    return _sorted(np.ascontiguousarray(coordinates) * (radius / extent) if extent > 0 else coordinates)


def _sorted(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.ascontiguousarray(points[np.lexsort(points.T)])
