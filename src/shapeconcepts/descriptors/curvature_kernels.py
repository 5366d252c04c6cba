"""Kernels of principal curvatures, over points sorted by grid cell."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbour_kernels import copy_nearby
from shapeconcepts.kernels import kernel

PLACES = 11
N_BINS = PLACES * (PLACES + 1) // 2
# The places lie half a unit apart on the scale of asinh(2 x), so that the last one is at 3.02.
_STEPS_PER_UNIT = 2.0
_FINENESS = 2.0
# Sums of squares along and across a line: below this ratio the spread across says nothing.
_LINE = np.float32(1e-3)
# Mean square of the distances in the tangent plane, in squared radii: below it they are rounding.
_SPOT = np.float32(1e-10)

_ZERO, _ONE = np.float32(0.0), np.float32(1.0)


# Sums in any order compile to vector instructions; it is the same order whenever this runs.
@kernel(fastmath={"reassoc", "contract"})
def principal_curvatures(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
) -> NDArray[np.float64]:
    """Eigenvalues of the Weingarten map at each point, the larger first, times the radius.

    Parameters
    ----------
    surface : (6, m) float64
        Points and unit normals in the order of a `shapeconcepts.geometry.neighbours.CellGrid`.
    cells, indptr, candidates
        Of the grid.
    radius : float

    Returns
    -------
    (m, 2) float64
    """
    m = surface.shape[1]
    curvatures = np.zeros((m, 2))
    nearby = np.empty((6, m + 8), np.float32)
    for cell in range(len(cells) - 1):
        start = cells[cell]
        n = copy_nearby(surface, candidates[indptr[cell] : indptr[cell + 1]], start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            nx, ny, nz = np.float32(surface[3, i]), np.float32(surface[4, i]), np.float32(surface[5, i])
            # Two directions that span the tangent plane.
            if abs(nx) < abs(nz):
                ax, ay, az = _ZERO, nz, -ny
            else:
                ax, ay, az = ny, -nx, _ZERO
            length = np.float32(math.sqrt(ax * ax + ay * ay + az * az))
            ax, ay, az = ax / length, ay / length, az / length
            bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
            count = su = sv = sp = sq = suu = suv = svv = sup = suq = svp = svq = _ZERO
            for k in range(n):
                dx, dy, dz = nearby[0, k] - x, nearby[1, k] - y, nearby[2, k] - z
                weight = _ONE if dx * dx + dy * dy + dz * dz <= _ONE else _ZERO
                u, v = weight * (dx * ax + dy * ay + dz * az), weight * (dx * bx + dy * by + dz * bz)
                p = nearby[3, k] * ax + nearby[4, k] * ay + nearby[5, k] * az
                q = nearby[3, k] * bx + nearby[4, k] * by + nearby[5, k] * bz
                count += weight
                su += u
                sv += v
                sp += weight * p
                sq += weight * q
                suu += u * u
                suv += u * v
                svv += v * v
                sup += u * p
                suq += u * q
                svp += v * p
                svq += v * q
            suu -= su * su / count
            suv -= su * sv / count
            svv -= sv * sv / count
            sup -= su * sp / count
            suq -= su * sq / count
            svp -= sv * sp / count
            svq -= sv * sq / count
            determinant = suu * svv - suv * suv
            spans_plane = determinant > _LINE * (suu + svv) * (suu + svv)
            if spans_plane and suu + svv > _SPOT * count:
                first = (svv * sup - suv * svp) / determinant
                last = (suu * svq - suv * suq) / determinant
                across = (svv * suq - suv * svq + suu * svp - suv * sup) / (determinant + determinant)
                mean = (first + last) / 2.0
                spread = math.sqrt((first - last) * (first - last) / 4.0 + across * across)
                curvatures[i, 0], curvatures[i, 1] = mean + spread, mean - spread
    return curvatures


@kernel
def curvature_histograms(
    curvatures: NDArray[np.float64], labels: NDArray[np.int32], n_segments: int
) -> NDArray[np.float64]:
    """Histograms of pairs of curvatures, each pair shared out over the four bins around it.

    Parameters
    ----------
    curvatures : (m, 2) float64
        Without unit, the larger first.
    labels : (m,) int32
        Segment of each point, -1 for none.
    n_segments : int

    Returns
    -------
    (n_segments, 66) float64
        Bin ``i (i + 1) / 2 + j`` for place i of the larger and j of the smaller one.
    """
    histograms = np.zeros((n_segments, N_BINS))
    for point in range(len(labels)):
        if labels[point] >= 0:
            i, beyond_i = _place(curvatures[point, 0])
            j, beyond_j = _place(curvatures[point, 1])
            histogram = histograms[labels[point]]
            histogram[_bin(i, j)] += (1.0 - beyond_i) * (1.0 - beyond_j)
            histogram[_bin(i, j + 1)] += (1.0 - beyond_i) * beyond_j
            histogram[_bin(i + 1, j)] += beyond_i * (1.0 - beyond_j)
            histogram[_bin(i + 1, j + 1)] += beyond_i * beyond_j
    return histograms


@kernel
def _place(curvature: float) -> tuple[int, float]:
    """The place below a curvature, and how far it lies on the way to the next one, 0 to 1."""
    place = PLACES // 2 + _STEPS_PER_UNIT * math.asinh(_FINENESS * curvature)
    place = min(max(place, 0.0), PLACES - 1.0)
    below = min(int(place), PLACES - 2)
    return below, place - below


@kernel
def _bin(i: int, j: int) -> int:
    high, low = max(i, j), min(i, j)
    return high * (high + 1) // 2 + low
