"""Kernels that cut an organised cloud into square cells, and grow planar regions of flat ones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.depth_noise import depth_noise
from shapeconcepts.geometry.normal_kernels import smallest_eigenvectors
from shapeconcepts.kernels import kernel

N_MOMENTS = 10


@kernel
def cell_moments(points: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Sums over the points of square cells.

    Parameters
    ----------
    points : (h, w, 3) float64
        NaN where nothing was measured.
    size : int
        Of a cell, pixels.

    Returns
    -------
    (rows, columns, 10) float64
        Number, sums of x, y, z, and of xx, xy, xz, yy, yz, zz.
    """
    height, width = points.shape[:2]
    rows, columns = height // size, width // size
    moments = np.zeros((rows, columns, N_MOMENTS))
    for i in range(rows * size):
        for j in range(columns * size):
            x, y, z = points[i, j, 0], points[i, j, 1], points[i, j, 2]
            if math.isnan(x):
                continue
            cell = moments[i // size, j // size]
            cell[0] += 1.0
            cell[1] += x
            cell[2] += y
            cell[3] += z
            cell[4] += x * x
            cell[5] += x * y
            cell[6] += x * z
            cell[7] += y * y
            cell[8] += y * z
            cell[9] += z * z
    return moments


@kernel
def fit_planes(moments: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Planes of least squares through the points behind moments.

    Parameters
    ----------
    moments : (m, 10) float64
        As of `cell_moments`, each of three points or more.

    Returns
    -------
    planes : (m, 6) float64
        Mean point and unit normal, of either sign.
    thickness : (m,) float64
        Root of the mean squared distance from the plane.
    """
    m = len(moments)
    covariances = np.empty((6, m))
    planes = np.empty((m, 6))
    for i in range(m):
        n = moments[i, 0]
        x, y, z = moments[i, 1] / n, moments[i, 2] / n, moments[i, 3] / n
        planes[i, 0], planes[i, 1], planes[i, 2] = x, y, z
        covariances[0, i] = moments[i, 4] / n - x * x
        covariances[1, i] = moments[i, 5] / n - x * y
        covariances[2, i] = moments[i, 6] / n - x * z
        covariances[3, i] = moments[i, 7] / n - y * y
        covariances[4, i] = moments[i, 8] / n - y * z
        covariances[5, i] = moments[i, 9] / n - z * z
    normals = smallest_eigenvectors(covariances.copy())
    thickness = np.empty(m)
    for i in range(m):
        a, b, c = normals[i]
        planes[i, 3], planes[i, 4], planes[i, 5] = a, b, c
        squares = (
            a * a * covariances[0, i]
            + b * b * covariances[3, i]
            + c * c * covariances[5, i]
            + 2.0 * (a * b * covariances[1, i] + a * c * covariances[2, i] + b * c * covariances[4, i])
        )
        thickness[i] = math.sqrt(max(squares, 0.0))
    return planes, thickness


@kernel
def grow_regions(
    moments: NDArray[np.float64],
    planes: NDArray[np.float64],
    flatness: NDArray[np.float64],
    noise: NDArray[np.float64],
    order: NDArray[np.int64],
    n_columns: int,
    least_cosine: float,
) -> NDArray[np.int32]:
    """Regions of neighbouring flat cells that lie on one plane.

    Parameters
    ----------
    moments : (m, 10) float64
        Of the cells, row by row.
    planes : (m, 6) float64
        As of `fit_planes`.
    flatness : (m,) float64
        Up to 1 where a cell is flat.
    noise : (m,) float64
        Metres from a plane within which a cell's mean lies on it.
    order : (k,) int64
        Flat cells, the flattest first.
    n_columns : int
        Cells in a row.
    least_cosine : float
        Of the angle between the normals of a cell and of the region.

    Returns
    -------
    (m,) int32
        Number of each cell's region, -1 for none.
    """
    regions = np.full(len(moments), -1, np.int32)
    n_rows = len(moments) // n_columns
    waiting = np.empty(len(moments), np.int64)
    n_regions = 0
    for seed in order:
        if regions[seed] >= 0:
            continue
        total = moments[seed : seed + 1].copy()
        plane = planes[seed].copy()
        fitted_to = total[0, 0]
        regions[seed] = n_regions
        waiting[0] = seed
        first, last = 0, 1
        while first < last:
            cell = waiting[first]
            first += 1
            row, column = cell // n_columns, cell % n_columns
            for step in range(4):
                other_row = row + (step == 0) - (step == 1)
                other_column = column + (step == 2) - (step == 3)
                if not (0 <= other_row < n_rows and 0 <= other_column < n_columns):
                    continue
                other = other_row * n_columns + other_column
                if regions[other] >= 0 or flatness[other] > 1.0:
                    continue
                cosine = 0.0
                apart = 0.0
                for axis in range(3):
                    cosine += plane[3 + axis] * planes[other, 3 + axis]
                    apart += plane[3 + axis] * (planes[other, axis] - plane[axis])
                if abs(cosine) < least_cosine or abs(apart) > noise[other]:
                    continue
                regions[other] = n_regions
                waiting[last] = other
                last += 1
                for moment in range(total.shape[1]):
                    total[0, moment] += moments[other, moment]
                if total[0, 0] > 1.2 * fitted_to:
                    refitted, _ = fit_planes(total)
                    plane[:] = refitted[0]
                    fitted_to = total[0, 0]
        n_regions += 1
    return regions


@kernel
def cell_noise(planes: NDArray[np.float64], viewpoint: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard deviation of the depth at the mean of each cell (m,), metres."""
    noise = np.empty(len(planes))
    for i in range(len(planes)):
        squares = 0.0
        for axis in range(3):
            squares += (planes[i, axis] - viewpoint[axis]) ** 2
        noise[i] = depth_noise(math.sqrt(squares))
    return noise
