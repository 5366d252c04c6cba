"""Kernel that fits a smooth surface to one side of a border."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

MIN_FIT_POINTS = 6
CURVATURE_RIDGE = 0.02
SLOPE_RIDGE = 0.001


@kernel
def gather_surroundings(
    points: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    voxel: int,
    radius: float,
    stamps: NDArray[np.int32],
    stamp: int,
    surroundings: NDArray[np.int32],
) -> int:
    """Collect the other voxels within a radius that two steps through the neighbour lists reach.

    Longer lists for all voxels would cost more than this does for the few at borders.

    Parameters
    ----------
    stamps : (m,) int32
        Scratch memory that holds no `stamp` yet.
    surroundings : (m,) int32
        Receives the voxels.

    Returns
    -------
    int
        Their number.
    """
    # Written always and kept by the count: no branch to mispredict.
    reached = np.uint64(0)
    stamps[voxel] = stamp
    for k in range(np.uint64(indptr[voxel]), np.uint64(indptr[voxel + 1])):
        step = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
        for second in range(np.uint64(indptr[step]), np.uint64(indptr[step + np.uint32(1)])):
            j = np.uint32(indices[second])
            surroundings[reached] = j
            reached += np.uint64(stamps[j] != stamp)
            stamps[j] = stamp
    x, y, z = points[voxel, 0], points[voxel, 1], points[voxel, 2]
    count = 0
    for k in range(reached):
        j = np.uint32(surroundings[k])
        dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
        surroundings[count] = j
        count += dx * dx + dy * dy + dz * dz <= radius * radius
    return count


# Its sums may be reordered, for vector instructions, and fused with products: the same on each run of a
# machine.
@kernel(fastmath={"reassoc", "contract"})
def fit_surface(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    labels: NDArray[np.int32],
    region: int,
    surroundings: NDArray[np.int32],
    x: float,
    y: float,
    z: float,
    scale: float,
    workspace: NDArray[np.float64],
) -> tuple[int, float, float, float, float]:
    """Fit a quadratic height field to those of some voxels that belong to one region.

    The field is ``h(u, v) = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2`` over the plane across the region's
    mean normal there, with the origin at (x, y, z). As only the region's own points enter, its slope at the
    origin is the surface's slope on that side, however sharply it turns on the other side.

    Parameters
    ----------
    scale : float
        Radius of the surroundings; makes the ridge on the coefficients independent of the unit.
    workspace : (7, 7) float64
        Scratch memory.

    Returns
    -------
    count : int
        Number of voxels of the region; fewer than 6 give no fit, and 0 is returned.
    height : float
        Signed distance of the surface from (x, y, z).
    nx, ny, nz : float
        Unit normal of the surface where it is nearest to (x, y, z), to first order.
    """
    # Written always and kept by the count: no branch to mispredict.
    members = np.empty(len(surroundings) + 1, np.uint32)
    count = 0
    for k in range(len(surroundings)):
        j = np.uint32(surroundings[k])
        members[count] = j
        count += labels[j] == region
    nx, ny, nz = 0.0, 0.0, 0.0
    for k in range(count):
        j = members[k]
        nx += normals[j, 0]
        ny += normals[j, 1]
        nz += normals[j, 2]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if count < MIN_FIT_POINTS or length == 0.0:
        return 0, 0.0, 0.0, 0.0, 0.0
    nx, ny, nz = nx / length, ny / length, nz / length
    ux, uy, uz = (0.0, nz, -ny) if abs(nx) < 0.6 else (-nz, 0.0, nx)
    length = math.sqrt(ux * ux + uy * uy + uz * uz) * scale
    ux, uy, uz = ux / length, uy / length, uz / length
    vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux

    su = sv = suu = suv = svv = suuu = suuv = suvv = svvv = 0.0
    suuuu = suuuv = suuvv = suvvv = svvvv = sh = shu = shv = shuu = shuv = shvv = 0.0
    for k in range(count):
        j = members[k]
        dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
        u = dx * ux + dy * uy + dz * uz
        v = dx * vx + dy * vy + dz * vz
        h = (dx * nx + dy * ny + dz * nz) / scale
        uu, uv, vv = u * u, u * v, v * v
        su += u
        sv += v
        suu += uu
        suv += uv
        svv += vv
        suuu += uu * u
        suuv += uu * v
        suvv += vv * u
        svvv += vv * v
        suuuu += uu * uu
        suuuv += uu * uv
        suuvv += uu * vv
        suvvv += vv * uv
        svvvv += vv * vv
        sh += h
        shu += h * u
        shv += h * v
        shuu += h * uu
        shuv += h * uv
        shvv += h * vv
    a = workspace
    a[0, 0], a[0, 1], a[0, 2], a[0, 3], a[0, 4], a[0, 5], a[0, 6] = count, su, sv, suu, suv, svv, sh
    a[1, 1], a[1, 2], a[1, 3], a[1, 4], a[1, 5], a[1, 6] = suu + SLOPE_RIDGE, suv, suuu, suuv, suvv, shu
    a[2, 2], a[2, 3], a[2, 4], a[2, 5], a[2, 6] = svv + SLOPE_RIDGE, suuv, suvv, svvv, shv
    a[3, 3], a[3, 4], a[3, 5], a[3, 6] = suuuu + CURVATURE_RIDGE, suuuv, suuvv, shuu
    a[4, 4], a[4, 5], a[4, 6] = suuvv + CURVATURE_RIDGE / 2, suvvv, shuv
    a[5, 5], a[5, 6] = svvvv + CURVATURE_RIDGE, shvv
    _solve_symmetric(a)
    c0, c1, c2 = a[0, 6], a[1, 6], a[2, 6]
    nx -= (c1 * ux + c2 * vx) * scale
    ny -= (c1 * uy + c2 * vy) * scale
    nz -= (c1 * uz + c2 * vz) * scale
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    return count, c0 * scale / length, nx / length, ny / length, nz / length


@kernel
def _solve_symmetric(a: NDArray[np.float64]) -> None:
    """Solve a positive definite 6 x 6 system in place; upper triangle in, solution in the last column."""
    for i in range(6):
        for r in range(i + 1, 6):
            factor = a[i, r] / a[i, i]
            for c in range(r, 7):
                a[r, c] -= factor * a[i, c]
    for i in range(5, -1, -1):
        total = a[i, 6]
        for c in range(i + 1, 6):
            total -= a[i, c] * a[c, 6]
        a[i, 6] = total / a[i, i]
