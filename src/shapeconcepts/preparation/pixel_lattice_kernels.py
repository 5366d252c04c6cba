"""Kernels of `pixel_lattice`: proposing a pixel lattice from neighbouring points, and refining it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

_HYPOTHESIS_TOLERANCE = 0.15
_FIRST_LOOK = 32
_SECOND_LOOK = 96
_DAMPING = 1e-10
_TINY = 1e-300


@kernel
def propose_lattices(
    differences: NDArray[np.float64], probes: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Best square lattice, seen orthographically, with two differences of each point one step right and down.

    With d1 = s e_x + z1 v and d2 = s e_y + z2 v for orthonormal e_x, e_y and line of sight v, the squared
    pixel size s² is the smaller eigenvalue of the Gram matrix of d1 and d2, and v is known up to a mirror
    image.

    Parameters
    ----------
    differences : (p, k, 3) float64
        Vectors from p points to their k nearest neighbours.
    probes : (m, 3) float64
        Differences on which each proposal is tried.

    Returns
    -------
    scores : (p,) float64
        Probes that land on a lattice point other than the origin, less those that land on the origin (two
        points on one ray: hidden from each other), as a share of m.
    lattices : (p, 2, 3) float64
        Rows that map a difference to pixels.
    """
    n_points, n_neighbours = differences.shape[0], differences.shape[1]
    scores = np.zeros(n_points)
    lattices = np.zeros((n_points, 2, 3))
    if len(probes) == 0:
        return scores, lattices
    view = np.empty(3)
    rows = np.empty((2, 3))
    for point in range(n_points):
        for i in range(n_neighbours):
            for j in range(i):
                d1 = differences[point, i]
                d2 = differences[point, j]
                g11 = d1[0] * d1[0] + d1[1] * d1[1] + d1[2] * d1[2]
                g22 = d2[0] * d2[0] + d2[1] * d2[1] + d2[2] * d2[2]
                g12 = d1[0] * d2[0] + d1[1] * d2[1] + d1[2] * d2[2]
                determinant = g11 * g22 - g12 * g12
                half_trace = 0.5 * (g11 + g22)
                size2 = half_trace - math.sqrt(max(half_trace * half_trace - determinant, 0.0))
                if size2 <= 0.02 * min(g11, g22) or determinant <= 1e-6 * g11 * g22:
                    continue
                z1 = math.sqrt(max(g11 - size2, 0.0))
                z2 = math.copysign(math.sqrt(max(g22 - size2, 0.0)), g12)
                along1 = (z1 * g22 - z2 * g12) / determinant
                along2 = (z2 * g11 - z1 * g12) / determinant
                in_plane2 = along1 * z1 + along2 * z2
                across = math.sqrt(max(1.0 - in_plane2, 0.0) / determinant)
                for side in (-across, across):
                    for a in range(3):
                        b, c = (a + 1) % 3, (a + 2) % 3
                        normal = d1[b] * d2[c] - d1[c] * d2[b]
                        view[a] = along1 * d1[a] + along2 * d2[a] + side * normal
                    for a in range(3):
                        rows[0, a] = (d1[a] - z1 * view[a]) / size2
                        rows[1, a] = (d2[a] - z2 * view[a]) / size2
                    score = _score(rows, probes)
                    if score > scores[point]:
                        scores[point] = score
                        for a in range(3):
                            lattices[point, 0, a] = rows[0, a]
                            lattices[point, 1, a] = rows[1, a]
    return scores, lattices


@kernel
def _score(rows: NDArray[np.float64], probes: NDArray[np.float64]) -> float:
    hits = 0
    for k in range(len(probes)):
        # Hopeless proposals are given up early: by chance one probe in eleven is a hit.
        if (k == _FIRST_LOOK and hits < 0.18 * k) or (k == _SECOND_LOOK and hits < 0.2 * k):
            return 0.0
        u = rows[0, 0] * probes[k, 0] + rows[0, 1] * probes[k, 1] + rows[0, 2] * probes[k, 2]
        v = rows[1, 0] * probes[k, 0] + rows[1, 1] * probes[k, 1] + rows[1, 2] * probes[k, 2]
        column, row = math.floor(u + 0.5), math.floor(v + 0.5)
        if abs(u - column) < _HYPOTHESIS_TOLERANCE and abs(v - row) < _HYPOTHESIS_TOLERANCE:
            hits += -1 if column == 0 and row == 0 else 1
    return hits / len(probes)


@kernel
def refine_camera(
    starts: NDArray[np.float64],
    ends: NDArray[np.float64],
    camera: NDArray[np.float64],
    tolerances: NDArray[np.float64],
) -> tuple[int, float]:
    """Gauss-Newton steps that bring the pixel differences of neighbouring points close to whole numbers.

    A point p is seen at pixel (camera[0] . p, camera[1] . p) / (1 + camera[2] . p), up to a constant.

    Parameters
    ----------
    starts, ends : (m, 3) float64
        Two neighbouring points each.
    camera : (3, 3) float64
        Improved in place.
    tolerances : (k,) float64
        For each step, the distance in pixels from a whole, non-zero difference from which a pair is left out
        (Tukey's biweight).

    Returns
    -------
    n_matches : int
        Pairs within the tolerance of the last step, before it.
    error : float
        Their root mean square distance to a whole difference, in pixels.
    """
    matrix = np.empty((9, 9))
    vector = np.empty(9)
    n_matches, error = 0, 0.0
    for step in range(len(tolerances)):
        n_matches, error = _lattice_equations(starts, ends, camera, tolerances[step], matrix, vector)
        _solve_damped(matrix, vector)
        for a in range(3):
            for b in range(3):
                camera[a, b] -= vector[3 * a + b]
    return n_matches, error


@kernel
def _lattice_equations(
    starts: NDArray[np.float64],
    ends: NDArray[np.float64],
    camera: NDArray[np.float64],
    tolerance: float,
    matrix: NDArray[np.float64],
    vector: NDArray[np.float64],
) -> tuple[int, float]:
    """Fill in the normal equations of one step; the number of matches and their error."""
    for a in range(9):
        vector[a] = 0.0
        for b in range(9):
            matrix[a, b] = 0.0
    step = np.empty(3)
    slope_u = np.empty(3)
    slope_v = np.empty(3)
    n_matches = 0
    squared_error = 0.0
    for k in range(len(starts)):
        up, vp, wp = _project(camera, starts[k])
        uq, vq, wq = _project(camera, ends[k])
        if wp <= 0.0 or wq <= 0.0:
            continue
        column, row = math.floor(uq - up + 0.5), math.floor(vq - vp + 0.5)
        error_u = uq - up - column
        error_v = vq - vp - row
        error2 = error_u * error_u + error_v * error_v
        if not error2 < tolerance * tolerance or (column == 0 and row == 0):
            continue
        n_matches += 1
        squared_error += error2
        weight = (1.0 - error2 / (tolerance * tolerance)) ** 2
        for a in range(3):
            start, end = starts[k, a] / wp, ends[k, a] / wq
            step[a] = end - start
            slope_u[a] = up * start - uq * end
            slope_v[a] = vp * start - vq * end
        for a in range(3):
            weighted_step = weight * step[a]
            vector[a] += weighted_step * error_u
            vector[3 + a] += weighted_step * error_v
            vector[6 + a] += weight * (slope_u[a] * error_u + slope_v[a] * error_v)
            for b in range(3):
                matrix[a, b] += weighted_step * step[b]
                matrix[6 + b, a] += weighted_step * slope_u[b]
                matrix[6 + b, 3 + a] += weighted_step * slope_v[b]
                matrix[6 + a, 6 + b] += weight * (slope_u[a] * slope_u[b] + slope_v[a] * slope_v[b])
    for a in range(3):
        for b in range(3):
            matrix[3 + a, 3 + b] = matrix[a, b]
    return n_matches, math.sqrt(squared_error / max(n_matches, 1))


@kernel
def _project(camera: NDArray[np.float64], point: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = point[0], point[1], point[2]
    w = 1.0 + camera[2, 0] * x + camera[2, 1] * y + camera[2, 2] * z
    if w <= 0.0:
        return 0.0, 0.0, w
    u = camera[0, 0] * x + camera[0, 1] * y + camera[0, 2] * z
    v = camera[1, 0] * x + camera[1, 1] * y + camera[1, 2] * z
    return u / w, v / w, w


@kernel
def _solve_damped(matrix: NDArray[np.float64], vector: NDArray[np.float64]) -> None:
    """Overwrite `vector` with the solution; of `matrix` only the lower triangle is read. Scaled Cholesky."""
    n = len(vector)
    scale = np.empty(n)
    for a in range(n):
        scale[a] = 1.0 / math.sqrt(max(matrix[a, a], _TINY))
    for a in range(n):
        for b in range(a + 1):
            value = matrix[a, b] * scale[a] * scale[b]
            if a == b:
                # Holds what the points leave open, such as the way out of the plane they all lie on.
                value += _DAMPING
            for c in range(b):
                value -= matrix[a, c] * matrix[b, c]
            matrix[a, b] = math.sqrt(max(value, _DAMPING)) if a == b else value / matrix[b, b]
    for a in range(n):
        value = vector[a] * scale[a]
        for c in range(a):
            value -= matrix[a, c] * vector[c]
        vector[a] = value / matrix[a, a]
    for a in range(n - 1, -1, -1):
        value = vector[a]
        for c in range(a + 1, n):
            value -= matrix[c, a] * vector[c]
        vector[a] = value / matrix[a, a]
    for a in range(n):
        vector[a] *= scale[a]
