"""Oriented points, and normals through all points within a radius."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbours import cell_grid
from shapeconcepts.geometry.normal_kernels import smallest_eigenvectors
from shapeconcepts.geometry.surface_kernels import (
    NOT_FINITE,
    NOT_UNIT,
    first_fault,
    neighbourhood_covariances,
    on_given_side,
)

# Fewer points, with the point itself, are no plane to trust.
_FEWEST_POINTS = 4.0


def normals_within(
    points: NDArray[np.float64], normals: NDArray[np.float64], radius: float
) -> NDArray[np.float64]:
    """Normals of the least-squares planes through all points within a radius, on the side of given normals.

    Parameters
    ----------
    points : (m, 3) float64
        Finite coordinates.
    normals : (m, 3) float64
        Unit normals that tell the side.
    radius : float
        Inclusive, in the unit of the points.

    Returns
    -------
    (m, 3) float64
        The given normal where less than four points are within the radius, where it is zero, and where it is
        perpendicular to the new one.

    Raises
    ------
    ValueError
        If the shapes do not fit, values are not finite, normals are neither unit nor zero, or `radius` is not
        a positive number.
    """
    points, normals = checked_surface(points, normals)
    grid = cell_grid(points, radius)
    covariances, counts = neighbourhood_covariances(*grid[1:], float(radius))
    return on_given_side(smallest_eigenvectors(covariances), counts, _FEWEST_POINTS, grid.order, normals)


def checked_surface(
    points: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and normals as contiguous (m, 3) float64 arrays.

    Raises
    ------
    ValueError
        If a shape is not (m, 3) or the two differ, values are not finite, or normals are neither unit nor
        zero.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    normals = np.ascontiguousarray(normals, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have shape (m, 3), got {points.shape}")
    if normals.shape != points.shape:
        raise ValueError(f"normals must have the shape of points {points.shape}, got {normals.shape}")
    fault, row = first_fault(points, normals)
    if fault == NOT_FINITE:
        raise ValueError(f"points must be finite, got {points[row].tolist()} at row {row}")
    if fault == NOT_UNIT:
        raise ValueError(f"normals must be unit vectors (or zero), got {normals[row].tolist()} at row {row}")
    return points, normals
