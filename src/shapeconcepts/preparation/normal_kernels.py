"""Kernels that turn neighbourhoods of points into normals."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, error_model="numpy")
def smallest_eigenvector(
    xx: float, xy: float, xz: float, yy: float, yz: float, zz: float
) -> tuple[float, float, float]:
    """Unit eigenvector of the smallest eigenvalue of a symmetric 3 x 3 matrix; (0, 0, 1) where all are equal.

    Closed form: trigonometric eigenvalue, then the largest cross product of two rows of A - lambda I.
    """
    mean = (xx + yy + zz) / 3
    spread = math.sqrt(
        ((xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2 * (xy * xy + xz * xz + yz * yz)) / 6
    )
    if not spread > 1e-12 * mean:
        return 0.0, 0.0, 1.0
    a, b, c = (xx - mean) / spread, (yy - mean) / spread, (zz - mean) / spread
    d, e, f = xy / spread, xz / spread, yz / spread
    half_determinant = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2
    angle = math.acos(min(1.0, max(-1.0, half_determinant))) / 3
    smallest = 2 * math.cos(angle + 2 * math.pi / 3)
    a, b, c = a - smallest, b - smallest, c - smallest
    x0, y0, z0 = d * f - e * b, e * d - a * f, a * b - d * d
    x1, y1, z1 = d * c - e * f, e * e - a * c, a * f - d * e
    x2, y2, z2 = b * c - f * f, f * e - d * c, d * f - b * e
    n0 = x0 * x0 + y0 * y0 + z0 * z0
    n1 = x1 * x1 + y1 * y1 + z1 * z1
    n2 = x2 * x2 + y2 * y2 + z2 * z2
    if n1 > n0:
        x0, y0, z0, n0 = x1, y1, z1, n1
    if n2 > n0:
        x0, y0, z0, n0 = x2, y2, z2, n2
    if n0 < 1e-12:
        return _any_perpendicular(a, b, c, d, e, f)
    length = math.sqrt(n0)
    return x0 / length, y0 / length, z0 / length


@njit(cache=True, error_model="numpy")
def _any_perpendicular(
    a: float, b: float, c: float, d: float, e: float, f: float
) -> tuple[float, float, float]:
    """A unit vector perpendicular to the longest row of a symmetric matrix of rank 1 (points on a line)."""
    x, y, z = a, d, e
    if d * d + b * b + f * f > x * x + y * y + z * z:
        x, y, z = d, b, f
    if e * e + f * f + c * c > x * x + y * y + z * z:
        x, y, z = e, f, c
    if abs(x) < abs(y) and abs(x) < abs(z):
        x, y, z = 0.0, -z, y
    elif abs(y) < abs(z):
        x, y, z = -z, 0.0, x
    else:
        x, y, z = -y, x, 0.0
    length = math.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return 0.0, 0.0, 1.0
    return x / length, y / length, z / length


@njit(cache=True, error_model="numpy")
def principal_component_normals(
    points: NDArray[np.float64], indptr: NDArray[np.int64], indices: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Normal of the least-squares plane through each point and its neighbours, of either sign."""
    m = len(points)
    normals = np.empty((m, 3))
    for i in range(m):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        sx = sy = sz = sxx = sxy = sxz = syy = syz = szz = 0.0
        for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
            j = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
            dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            sx += dx
            sy += dy
            sz += dz
            sxx += dx * dx
            sxy += dx * dy
            sxz += dx * dz
            syy += dy * dy
            syz += dy * dz
            szz += dz * dz
        n = indptr[i + 1] - indptr[i] + 1
        normals[i, 0], normals[i, 1], normals[i, 2] = smallest_eigenvector(
            sxx - sx * sx / n,
            sxy - sx * sy / n,
            sxz - sx * sz / n,
            syy - sy * sy / n,
            syz - sy * sz / n,
            szz - sz * sz / n,
        )
    return normals
