"""Kernels of surflet-pair relations."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

# A connection this close to the normal (sine below 1e-6) spans no plane with it.
_PARALLEL = 1e-12


@kernel
def _atan2(y: float, x: float) -> float:
    """Arctangent to 2e-5 rad (Abramowitz & Stegun 4.4.49), without branches."""
    wide, high = abs(x), abs(y)
    steep = high > wide
    large = high if steep else wide
    small = wide if steep else high
    t = small / large if large > 0.0 else 0.0
    s = t * t
    angle = t * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))))
    angle = 0.5 * math.pi - angle if steep else angle
    angle = math.pi - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@kernel
def surflet_relations(
    end: int, points: NDArray[np.float64], normals: NDArray[np.float64], relations: NDArray[np.float64]
) -> None:
    """Relations of a surflet to all that come before it (Wahl, Hillenbrand, Hirzinger, 3DIM 2003).

    Parameters
    ----------
    end : int
        The surflet.
    points, normals : (3, m) float64
    relations : (4, m) float64, output
        Columns before `end`: distance, theta in [-pi, pi], alpha and phi in [-1, 1].
    """
    x, y, z = points[0, end], points[1, end], points[2, end]
    nx, ny, nz = normals[0, end], normals[1, end], normals[2, end]
    # Counting from 0 and without branches, so that it compiles to vector instructions.
    for k in range(end):
        dx, dy, dz = points[0, k] - x, points[1, k] - y, points[2, k] - z
        mx, my, mz = normals[0, k], normals[1, k], normals[2, k]
        squared_distance = dx * dx + dy * dy + dz * dz
        near = nx * dx + ny * dy + nz * dz
        far = mx * dx + my * dy + mz * dz
        cosine = nx * mx + ny * my + nz * mz
        triple = (dy * nz - dz * ny) * mx + (dz * nx - dx * nz) * my + (dx * ny - dy * nx) * mz
        # The source of the frame is the surflet whose normal is farther from the connection; where both are
        # equally far, the one that sees the other in front.
        swapped = (abs(near) > abs(far)) | ((near == far) & (near < 0.0))
        along = -far if swapped else near
        other = -near if swapped else far
        squared_across = squared_distance - along * along
        # Without a plane across the connection there are no angles: all are zero.
        flat = squared_across <= _PARALLEL * squared_distance
        distance = math.sqrt(squared_distance)
        across = math.sqrt(1.0 if flat else squared_across)
        theta = _atan2((other - cosine * along) / across, cosine)
        relations[0, k] = distance
        relations[1, k] = 0.0 if flat else theta
        relations[2, k] = 0.0 if flat else triple / across
        relations[3, k] = 0.0 if flat else along / distance


@kernel
def largest_distance(points: NDArray[np.float64]) -> float:
    """Largest distance between two of the points, shape (3, m)."""
    largest = 0.0
    for i in range(points.shape[1]):
        for j in range(i + 1, points.shape[1]):
            dx, dy, dz = points[0, j] - points[0, i], points[1, j] - points[1, i], points[2, j] - points[2, i]
            largest = max(largest, dx * dx + dy * dy + dz * dz)
    return math.sqrt(largest)


@kernel
def accumulate_relations(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    weights: NDArray[np.float64],
    segment_labels: NDArray[np.int64],
    distance_range: float,
    histograms: NDArray[np.float64],
) -> None:
    """Add every pair of surflets to the histograms of its pair of segments.

    A pair is shared linearly between the two nearest bins of each axis.

    Parameters
    ----------
    points, normals : (3, m) float64
    weights : (m,) float64
        Points that each surflet stands for; a pair weighs the product.
    segment_labels : (m,) int64
        Rising.
    distance_range : float
        Distance at the end of the last bin; larger ones count as this.
    histograms : (s, s, distance bins + 2, 3, angle bins + 2) float64, output
        One pair of segments each, the smaller first; theta, alpha, phi for each distance. Both ends of an
        axis have an extra bin for the share that falls over the end.
    """
    m = points.shape[1]
    distance_bins, angle_bins = histograms.shape[2] - 2, histograms.shape[4] - 2
    distance_scale = distance_bins / distance_range
    theta_scale, cosine_scale = angle_bins / (2.0 * math.pi), 0.5 * angle_bins
    relations = np.empty((4, m))
    for i in range(m):
        surflet_relations(i, points, normals, relations)
        for k in range(i):
            histogram = histograms[segment_labels[k], segment_labels[i]]
            # Positions count from the centre of the extra bin in front.
            position = min(relations[0, k] * distance_scale, distance_bins) + 0.5
            level = int(position)
            upper = (position - level) * weights[i] * weights[k]
            lower = weights[i] * weights[k] - upper
            for angle in range(3):
                scale = theta_scale if angle == 0 else cosine_scale
                position = relations[angle + 1, k] * scale + (cosine_scale + 0.5)
                bin_ = int(position)
                share = position - bin_
                histogram[level, angle, bin_] += lower * (1.0 - share)
                histogram[level, angle, bin_ + 1] += lower * share
                histogram[level + 1, angle, bin_] += upper * (1.0 - share)
                histogram[level + 1, angle, bin_ + 1] += upper * share
