"""Kernels that go over all points of a scene once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def largest_coordinate(points: NDArray[np.float64], is_measured: NDArray[np.bool_]) -> float:
    """Largest amount of a coordinate of the points (n, 3) that were measured, metres."""
    largest = 0.0
    for i in range(len(points)):
        if is_measured[i]:
            for axis in range(3):
                largest = max(largest, abs(points[i, axis]))
    return largest


@kernel
def measured_points(
    points: NDArray[np.float64], is_measured: NDArray[np.bool_], origin: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points (n, 3) from an origin (3,), NaN where nothing was measured."""
    found = np.empty(points.shape)
    for i in range(len(points)):
        for axis in range(3):
            found[i, axis] = points[i, axis] - origin[axis] if is_measured[i] else np.nan
    return found
