"""Kernels of Fast Point Feature Histograms, over pairs of neighbours that are each visited once."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

N_BINS = 11
CENTRE = N_BINS // 2

# Borders of the bins on one side of the central one. The bins are symmetric around zero, so a feature's bin
# is the sign of the feature and the number of borders below its size: no angle is ever computed.
_SQUARED_BORDERS = (np.arange(1, N_BINS, 2) / N_BINS) ** 2
_BORDER_SINES = np.sin(np.arange(1, N_BINS, 2) * math.pi / N_BINS)
_BORDER_COSINES = np.cos(np.arange(1, N_BINS, 2) * math.pi / N_BINS)
# A connection this close to the normal (sine below 1e-6) spans no plane with it.
_PARALLEL = 1e-12


@njit(cache=True, error_model="numpy")
def bin_features(
    n: int,
    connections: NDArray[np.float64],
    normal: NDArray[np.float64],
    partner_normals: NDArray[np.float64],
    bins: NDArray[np.uint32],
) -> None:
    """Bins of the pair features of one point and its partners.

    Parameters
    ----------
    n : int
        Number of partners; the arrays are buffers with at least as many columns.
    connections, partner_normals : (3, >= n) float64
        Vectors from the point to its partners, and their normals.
    normal : (3,) float64
    bins : (5, >= n) uint32, output
        Columns of theta, alpha and phi in the point's histogram, and of theta and phi in the partner's: where
        both normals are equally close, each is its own source and sees the other's frame mirrored.
    """
    nx, ny, nz = normal[0], normal[1], normal[2]
    for k in range(n):  # without branches, so that it compiles to vector instructions
        dx, dy, dz = connections[0, k], connections[1, k], connections[2, k]
        mx, my, mz = partner_normals[0, k], partner_normals[1, k], partner_normals[2, k]
        squared_distance = dx * dx + dy * dy + dz * dz
        near = nx * dx + ny * dy + nz * dz
        far = mx * dx + my * dy + mz * dz
        cosine = nx * mx + ny * my + nz * mz
        triple = (dy * nz - dz * ny) * mx + (dz * nx - dx * nz) * my + (dx * ny - dy * nx) * mz
        # The source of the Darboux frame is the point whose normal is closer to the connection.
        swapped = abs(near) < abs(far)
        along = -far if swapped else near
        other = -near if swapped else far
        squared_across = squared_distance - along * along
        if squared_across <= _PARALLEL * squared_distance:
            squared_across, along, other, triple = 0.0, 0.0, 0.0, 0.0
        turn = other - cosine * along
        level = cosine * math.sqrt(squared_across)
        theta, alpha, phi = 0, 0, 0
        for border in range(CENTRE):
            theta += abs(turn) * _BORDER_COSINES[border] > level * _BORDER_SINES[border]
            alpha += triple * triple > _SQUARED_BORDERS[border] * squared_across
            phi += along * along > _SQUARED_BORDERS[border] * squared_distance
        theta = theta if turn > 0.0 else -theta
        phi = phi if along > 0.0 else -phi
        mirror = -1 if near == far else 1
        bins[0, k] = CENTRE + theta
        bins[1, k] = N_BINS + CENTRE + (alpha if triple > 0.0 else -alpha)
        bins[2, k] = 2 * N_BINS + CENTRE + phi
        bins[3, k] = CENTRE + mirror * theta
        bins[4, k] = 2 * N_BINS + CENTRE + mirror * phi


@njit(cache=True, error_model="numpy")
def simplified_histograms(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    partners: NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Simplified Point Feature Histograms (Rusu 2009, section III) as counts.

    Parameters
    ----------
    points, normals : (m, 3) float64
    indptr : (m + 1,) int64
    partners : (indptr[m],) int32
        Every unordered pair of neighbours once, as in `shapeconcepts.neighbours.NeighbourPairs`.

    Returns
    -------
    counts : (m, 33) int32
        Histograms over a point's neighbours of theta, alpha and phi, 11 bins each.
    weight_sums : (m,) float64
        Sum of 1 / squared distance over a point's neighbours, coincident ones left out.
    """
    m = len(points)
    counts = np.zeros((m, 3 * N_BINS), np.int32)
    weight_sums = np.zeros(m)
    most = 0
    for i in range(m):
        most = max(most, indptr[i + 1] - indptr[i])
    connections = np.empty((3, most))
    partner_normals = np.empty((3, most))
    weights = np.empty(most)
    bins = np.empty((5, most), np.uint32)
    for i in range(m):
        start, n = indptr[i], indptr[i + 1] - indptr[i]
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for k in range(n):
            j = np.uint32(partners[start + k])  # an unsigned index needs no test for counting from the end
            connections[0, k], partner_normals[0, k] = points[j, 0] - x, normals[j, 0]
            connections[1, k], partner_normals[1, k] = points[j, 1] - y, normals[j, 1]
            connections[2, k], partner_normals[2, k] = points[j, 2] - z, normals[j, 2]
        bin_features(n, connections, normals[i], partner_normals, bins)
        for k in range(n):
            squared_distance = connections[0, k] ** 2 + connections[1, k] ** 2 + connections[2, k] ** 2
            weights[k] = 1.0 / squared_distance if squared_distance > 0.0 else 0.0
        own_counts = counts[i]
        weight_sum = 0.0
        for k in range(n):
            partner_counts = counts[np.uint32(partners[start + k])]
            own_counts[bins[0, k]] += 1
            own_counts[bins[1, k]] += 1
            own_counts[bins[2, k]] += 1
            partner_counts[bins[3, k]] += 1
            partner_counts[bins[1, k]] += 1
            partner_counts[bins[4, k]] += 1
            weight_sum += weights[k]
            weight_sums[np.uint32(partners[start + k])] += weights[k]
        weight_sums[i] += weight_sum
    return counts, weight_sums


@njit(cache=True, error_model="numpy")
def neighbour_means(
    points: NDArray[np.float64],
    indptr: NDArray[np.int64],
    partners: NDArray[np.int32],
    histograms: NDArray[np.float64],
    weight_sums: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Mean histogram of each point's neighbours, weighted by 1 / squared distance; zero without any."""
    means = np.zeros_like(histograms)
    n_bins = histograms.shape[1]
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for k in range(indptr[i], indptr[i + 1]):
            j = partners[k]
            dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            squared_distance = dx * dx + dy * dy + dz * dz
            if squared_distance > 0.0:
                here = 1.0 / (squared_distance * weight_sums[i])
                there = 1.0 / (squared_distance * weight_sums[j])
                for b in range(n_bins):
                    means[i, b] += here * histograms[j, b]
                    means[j, b] += there * histograms[i, b]
    return means


@njit(cache=True, error_model="numpy")
def segment_sums(
    points: NDArray[np.float64],
    indptr: NDArray[np.int64],
    partners: NDArray[np.int32],
    histograms: NDArray[np.float64],
    weight_sums: NDArray[np.float64],
    segment_labels: NDArray[np.int32],
    n_segments: int,
) -> NDArray[np.float64]:
    """Sum the FPFH of each segment's points: own histogram plus weighted mean of the neighbours' histograms.

    The sum is linear in the histograms, so it takes one number per point and segment, its share, and not one
    histogram per pair of neighbours.

    Returns
    -------
    (n_segments, b) float64
    """
    # Points of no segment collect in a last column that is left out in the end.
    shares = np.zeros((len(points), n_segments + 1))
    columns = np.empty(len(points), np.uint32)
    scales = np.empty(len(points))
    for i in range(len(points)):
        columns[i] = segment_labels[i] if segment_labels[i] >= 0 else n_segments
        scales[i] = 1.0 / weight_sums[i] if weight_sums[i] > 0.0 else 0.0
        shares[i, columns[i]] = 1.0
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        own_shares = shares[i]
        for k in range(indptr[i], indptr[i + 1]):
            j = np.uint32(partners[k])
            dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            squared_distance = dx * dx + dy * dy + dz * dz
            weight = 1.0 / squared_distance if squared_distance > 0.0 else 0.0
            shares[j, columns[i]] += weight * scales[i]
            own_shares[columns[j]] += weight * scales[j]
    n_bins = histograms.shape[1]
    sums = np.zeros((n_segments, n_bins))
    for i in range(len(points)):
        for segment in range(n_segments):
            share = shares[i, segment]
            if share > 0.0:
                for b in range(n_bins):
                    sums[segment, b] += share * histograms[i, b]
    return sums
