"""Kernel of distances between points."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def accumulate_distances(
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    segment_labels: NDArray[np.int64],
    smallest: float,
    places_per_doubling: int,
    histograms: NDArray[np.float64],
) -> None:
    """Add the distance of every two points to the histogram of their segments.

    Parameters
    ----------
    points : (3, m) float64
    weights : (m,) float64
        Points that each stands for; a pair weighs the product.
    segment_labels : (m,) int64
        Rising.
    smallest : float
        Distance at the first place; the others lie above it on the scale of the logarithm.
    places_per_doubling : int
    histograms : (s, s, places) float64, output
        One pair of segments each, the smaller first. A pair is shared linearly between two places.
    """
    last = histograms.shape[2] - 1
    for i in range(points.shape[1]):
        for k in range(i):
            dx, dy, dz = points[0, k] - points[0, i], points[1, k] - points[1, i], points[2, k] - points[2, i]
            squared = (dx * dx + dy * dy + dz * dz) / (smallest * smallest)
            # Half the logarithm of the square is the logarithm of the distance.
            place = 0.5 * places_per_doubling * math.log2(squared) if squared > 1.0 else 0.0
            place = min(place, float(last))
            below = min(int(place), last - 1)
            share = place - below
            weight = weights[i] * weights[k]
            histogram = histograms[segment_labels[k], segment_labels[i]]
            histogram[below] += (1.0 - share) * weight
            histogram[below + 1] += share * weight
