"""The oriented points that descriptors work on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.segmentation.segmented_object import SegmentedObject


def checked_surface(
    points: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and normals as contiguous (m, 3) float64 arrays.

    Raises
    ------
    ValueError
        If a shape is not (m, 3) or the two differ, values are not finite, or normals are neither unit nor
        zero.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    normals = np.ascontiguousarray(normals, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have shape (m, 3), got {points.shape}")
    if normals.shape != points.shape:
        raise ValueError(f"normals must have the shape of points {points.shape}, got {normals.shape}")
    if not np.isfinite(points).all():
        raise ValueError("points must be finite, got NaN or infinity")
    squared_lengths = np.einsum("ij,ij->i", normals, normals)
    odd = ~((np.abs(squared_lengths - 1.0) < 1e-3) | (squared_lengths == 0.0))
    if odd.any():
        first = int(np.argmax(odd))
        raise ValueError(
            f"normals must be unit vectors (or zero), got {normals[first].tolist()} at row {first}"
        )
    return points, normals


def checked_labels(segmented: SegmentedObject) -> NDArray[np.int32]:
    """Segment labels as (m,) int32, one for each point, all below `n_segments`.

    Raises
    ------
    ValueError
        If there is not one label for each point, or a label names no segment.
    """
    labels = np.ascontiguousarray(segmented.segment_labels, dtype=np.int32)
    if labels.shape != (len(segmented.points),):
        raise ValueError(f"segment_labels must have shape ({len(segmented.points)},), got {labels.shape}")
    if len(labels) and labels.max() >= segmented.n_segments:
        raise ValueError(
            f"segment_labels must be below n_segments = {segmented.n_segments}, got {labels.max()}"
        )
    return labels
