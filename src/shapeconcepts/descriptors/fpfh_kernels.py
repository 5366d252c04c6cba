"""Kernels of Fast Point Feature Histograms, over points sorted by grid cell.

All points of a cell have the same candidates for neighbours. Once these are copied together, each point runs
over all of them, the ones beyond the radius included, in loops without branches or jumps in memory: that is
faster than lists of the neighbours alone. Such loops compile to vector instructions, which take twice as many
numbers in single as in double precision.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.pair_feature_kernels import (
    N_BINS,
    pair_bins,
    pair_weights,
    point_histogram,
    share_of,
    sum_of,
)
from shapeconcepts.geometry.neighbour_kernels import copy_nearby
from shapeconcepts.kernels import kernel

_ZERO = np.float32(0.0)


@kernel
def simplified_histograms(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Simplified Point Feature Histograms (Rusu 2009, section III).

    Parameters
    ----------
    surface : (6, m) float64
        Points and normals in the order of a `shapeconcepts.geometry.neighbours.CellGrid`.
    cells, indptr, candidates
        Of the grid.
    radius : float

    Returns
    -------
    histograms : (m, 33) float64
        Histograms over a point's neighbours of theta, alpha and phi, 11 bins each, 100 for each angle.
    weight_sums : (m,) float64
        Sum of squared radius / squared distance over a point's neighbours, coincident ones left out.
    """
    m = surface.shape[1]
    histograms = np.empty((m, 3 * N_BINS))
    weight_sums = np.empty(m)
    nearby = np.empty((6, m + 8), np.float32)
    bins = np.empty((3, m + 8), np.uint8)
    weights = np.empty(m + 8, np.float32)
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            nx, ny, nz = np.float32(surface[3, i]), np.float32(surface[4, i]), np.float32(surface[5, i])
            pair_bins(n, x, y, z, nx, ny, nz, nearby, bins, weights)
            for angle in range(3):
                point_histogram(n, bins, angle, histograms, i)
            weight_sums[i] = sum_of(n, weights)
    return histograms, weight_sums


@kernel
def neighbour_means(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
    histograms: NDArray[np.float64],
    weight_sums: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Mean histogram of each point's neighbours, weighted by 1 / squared distance; zero without any.

    The parameters are those and the results of `simplified_histograms`.
    """
    m = surface.shape[1]
    means = np.zeros_like(histograms)
    nearby = np.empty((6, m + 8), np.float32)
    weights = np.empty(m + 8, np.float32)
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            pair_weights(n, x, y, z, nearby, weights)
            for k in range(n):
                if weights[k] > _ZERO:
                    weight = weights[k] / weight_sums[i]
                    for b in range(histograms.shape[1]):
                        means[i, b] += weight * histograms[near_cell[k], b]
    return means


@kernel
def segment_sums(
    surface: NDArray[np.float64],
    cells: NDArray[np.int64],
    indptr: NDArray[np.int64],
    candidates: NDArray[np.uint32],
    radius: float,
    histograms: NDArray[np.float64],
    n_segments: int,
) -> NDArray[np.float64]:
    """Sum the FPFH of each segment's points: own histogram plus weighted mean of the neighbours' histograms.

    The sum is linear in the histograms, so it takes one number per point and segment, its share, and not one
    histogram per pair of neighbours.

    Parameters
    ----------
    surface : (5, m) float64
        Points, segment labels, and 1 / weight sum (0 without weights) in the order of the grid.
    cells, indptr, candidates, radius, histograms
        As of `simplified_histograms`.
    n_segments : int

    Returns
    -------
    (n_segments, 33) float64
    """
    m = surface.shape[1]
    n_bins = histograms.shape[1]
    sums = np.zeros((n_segments, n_bins))
    nearby = np.empty((5, m + 8), np.float32)
    weights = np.empty(m + 8, np.float32)
    is_near = np.empty(n_segments, np.bool_)
    for cell in range(len(cells) - 1):
        near_cell = candidates[indptr[cell] : indptr[cell + 1]]
        start = cells[cell]
        n = copy_nearby(surface, near_cell, start, radius, nearby)
        is_near[:] = False
        for k in range(n):
            if nearby[3, k] >= _ZERO:
                is_near[np.int64(nearby[3, k])] = True
        for i in range(start, cells[cell + 1]):
            x = np.float32((surface[0, i] - surface[0, start]) * (1.0 / radius))
            y = np.float32((surface[1, i] - surface[1, start]) * (1.0 / radius))
            z = np.float32((surface[2, i] - surface[2, start]) * (1.0 / radius))
            pair_weights(n, x, y, z, nearby, weights)
            for segment in range(n_segments):
                if is_near[segment]:
                    share = np.float64(surface[3, i] == segment)
                    share += share_of(n, weights, nearby[4], nearby[3], np.float32(segment))
                    for b in range(n_bins):
                        sums[segment, b] += share * histograms[i, b]
    return sums
