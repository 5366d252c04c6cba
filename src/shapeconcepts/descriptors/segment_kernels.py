"""Kernel over the points of segments."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def size_of_segments(points: NDArray[np.float64], labels: NDArray[np.int32]) -> float:
    """Root mean square distance of the points in segments from their centroid; 0 without any."""
    n = 0
    x = y = z = 0.0
    for i in range(len(points)):
        if labels[i] >= 0:
            n += 1
            x, y, z = x + points[i, 0], y + points[i, 1], z + points[i, 2]
    if n == 0:
        return 0.0
    x, y, z = x / n, y / n, z / n
    total = 0.0
    for i in range(len(points)):
        if labels[i] >= 0:
            total += (points[i, 0] - x) ** 2 + (points[i, 1] - y) ** 2 + (points[i, 2] - z) ** 2
    return math.sqrt(total / n)
