"""Kernels over oriented points: what is wrong with them, and the planes through their neighbourhoods."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbour_kernels import copy_nearby
from shapeconcepts.kernels import kernel

_ZERO, _ONE = np.float32(0.0), np.float32(1.0)
NOT_FINITE, NOT_UNIT = 1, 2


@kernel
def first_fault(points: NDArray[np.float64], normals: NDArray[np.float64]) -> tuple[int, int]:
    """`NOT_FINITE` or `NOT_UNIT` and the first row of points that are not, or normals neither unit nor zero.

    0 and -1 where all is well. Both arrays have shape (m, 3).
    """
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
            return NOT_FINITE, i
        squared_length = normals[i, 0] * normals[i, 0] + normals[i, 1] * normals[i, 1]
        squared_length += normals[i, 2] * normals[i, 2]
        if not (abs(squared_length - 1.0) < 1e-3 or squared_length == 0.0):
            return NOT_UNIT, i
    return 0, -1


@kernel
def on_given_side(
    fitted: NDArray[np.float64],
    counts: NDArray[np.float64],
    fewest: float,
    order: NDArray[np.int64],
    normals: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Fitted normals on the side of the given ones, which stay where less than `fewest` points were fitted.

    Parameters
    ----------
    fitted : (m, 3) float64
        Of either sign, for the points in the order of a grid.
    counts : (m,) float64
        Points behind each of them.
    fewest : float
    order : (m,) int64
    normals : (m, 3) float64

    Returns
    -------
    (m, 3) float64
        In the order of `normals`; the given one also where it is zero or perpendicular to the fitted one.
    """
    result = normals.copy()
    for place in range(len(order)):
        i = order[place]
        x, y, z = fitted[place, 0], fitted[place, 1], fitted[place, 2]
        side = x * normals[i, 0] + y * normals[i, 1] + z * normals[i, 2]
        if counts[place] >= fewest and side != 0.0:
            sign = 1.0 if side > 0.0 else -1.0
            result[i, 0], result[i, 1], result[i, 2] = sign * x, sign * y, sign * z
    return result


# Sums in any order compile to vector instructions; it is the same order whenever this runs.
@kernel(fastmath={"reassoc", "contract"})
def neighbourhood_covariances(
    coordinates: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Covariances of all points within a radius of each point, in squared radii.

    Parameters
    ----------
    coordinates, cells, indptr, candidates
        Of a `shapeconcepts.geometry.neighbours.CellGrid`.
    radius : float

    Returns
    -------
    covariances : (6, m) float64
        Elements xx, xy, xz, yy, yz and zz.
    counts : (m,) float64
        Points within the radius, the point itself among them.
    """
    m = coordinates.shape[1]
    covariances = np.empty((6, m))
    counts = np.empty(m)
    nearby = np.empty((3, m + 8), np.float32)
    for cell in range(len(cells) - 1):
        start = cells[cell]
        n = copy_nearby(coordinates, candidates[indptr[cell] : indptr[cell + 1]], start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((coordinates[0, i] - coordinates[0, start]) * (1.0 / radius))
            y = np.float32((coordinates[1, i] - coordinates[1, start]) * (1.0 / radius))
            z = np.float32((coordinates[2, i] - coordinates[2, start]) * (1.0 / radius))
            count = sx = sy = sz = sxx = sxy = sxz = syy = syz = szz = _ZERO
            for k in range(n):
                dx, dy, dz = nearby[0, k] - x, nearby[1, k] - y, nearby[2, k] - z
                is_near = dx * dx + dy * dy + dz * dz <= _ONE
                dx, dy, dz = dx if is_near else _ZERO, dy if is_near else _ZERO, dz if is_near else _ZERO
                count += _ONE if is_near else _ZERO
                sx += dx
                sy += dy
                sz += dz
                sxx += dx * dx
                sxy += dx * dy
                sxz += dx * dz
                syy += dy * dy
                syz += dy * dz
                szz += dz * dz
            counts[i] = count
            covariances[0, i], covariances[1, i] = sxx - sx * sx / count, sxy - sx * sy / count
            covariances[2, i], covariances[3, i] = sxz - sx * sz / count, syy - sy * sy / count
            covariances[4, i], covariances[5, i] = syz - sy * sz / count, szz - sz * sz / count
    return covariances, counts
