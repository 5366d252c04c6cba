"""Kernels that turn neighbourhoods of points into normals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def smallest_eigenvectors(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit eigenvectors of the smallest eigenvalues of symmetric 3 x 3 matrices.

    Closed form: trigonometric eigenvalue, then the largest cross product of two rows of A - lambda I. All but
    the trigonometry runs in loops that compile to vector instructions.

    Parameters
    ----------
    matrices : (6, m) float64
        Elements xx, xy, xz, yy, yz and zz of each matrix. They are overwritten.

    Returns
    -------
    (m, 3) float64
        (0, 0, 1) where all eigenvalues are equal.
    """
    m = matrices.shape[1]
    smallest = np.empty(m)
    squared_lengths = np.empty(m)
    vectors = np.empty((m, 3))
    for i in range(m):
        xx, xy, xz = matrices[0, i], matrices[1, i], matrices[2, i]
        yy, yz, zz = matrices[3, i], matrices[4, i], matrices[5, i]
        mean = (xx + yy + zz) / 3
        spread = math.sqrt(
            ((xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2 * (xy * xy + xz * xz + yz * yz)) / 6
        )
        spread = spread if spread > 1e-12 * mean else np.inf
        a, b, c = (xx - mean) / spread, (yy - mean) / spread, (zz - mean) / spread
        d, e, f = xy / spread, xz / spread, yz / spread
        smallest[i] = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2
        matrices[0, i], matrices[1, i], matrices[2, i] = a, d, e
        matrices[3, i], matrices[4, i], matrices[5, i] = b, f, c
    for i in range(m):
        angle = math.acos(min(1.0, max(-1.0, smallest[i]))) / 3
        smallest[i] = 2 * math.cos(angle + 2 * math.pi / 3)
    for i in range(m):
        a, b, c = matrices[0, i] - smallest[i], matrices[3, i] - smallest[i], matrices[5, i] - smallest[i]
        d, e, f = matrices[1, i], matrices[2, i], matrices[4, i]
        x0, y0, z0 = d * f - e * b, e * d - a * f, a * b - d * d
        x1, y1, z1 = d * c - e * f, e * e - a * c, a * f - d * e
        x2, y2, z2 = b * c - f * f, f * e - d * c, d * f - b * e
        n0 = x0 * x0 + y0 * y0 + z0 * z0
        n1 = x1 * x1 + y1 * y1 + z1 * z1
        n2 = x2 * x2 + y2 * y2 + z2 * z2
        longer = n1 > n0
        x0, y0, z0 = x1 if longer else x0, y1 if longer else y0, z1 if longer else z0
        n0 = n1 if longer else n0
        longer = n2 > n0
        x0, y0, z0 = x2 if longer else x0, y2 if longer else y0, z2 if longer else z0
        n0 = n2 if longer else n0
        length = math.sqrt(n0)
        vectors[i, 0], vectors[i, 1], vectors[i, 2] = x0 / length, y0 / length, z0 / length
        squared_lengths[i] = n0
    for i in range(m):
        # Eigenvalues that differ by less than some 1e-7 of the largest: the eigenvector is left open then.
        if squared_lengths[i] < 4e-13:
            a, b, c = matrices[0, i] - smallest[i], matrices[3, i] - smallest[i], matrices[5, i] - smallest[i]
            vectors[i] = _any_perpendicular(a, b, c, matrices[1, i], matrices[2, i], matrices[4, i])
    return vectors


@kernel
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


@kernel
def principal_component_normals(
    points: NDArray[np.float64], indptr: NDArray[np.int64], indices: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Normal of the least-squares plane through each point and its neighbours, of either sign."""
    m = len(points)
    covariances = np.empty((6, m))
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
        covariances[0, i], covariances[1, i] = sxx - sx * sx / n, sxy - sx * sy / n
        covariances[2, i], covariances[3, i] = sxz - sx * sz / n, syy - sy * sy / n
        covariances[4, i], covariances[5, i] = syz - sy * sz / n, szz - sz * sz / n
    return smallest_eigenvectors(covariances)
