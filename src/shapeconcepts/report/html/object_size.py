"""How large an object is, along axes of its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.segmentation import SegmentedObject

# Segments from large to small whose normals may be an axis.
_LARGEST_SEGMENTS = 3
# Of a quarter turn.
_STEPS = 30
# Sides are told by fewer points than most objects have.
_ENOUGH_POINTS = 1500


def object_sides(segmented: SegmentedObject) -> tuple[float, float, float]:
    """Sides of a tight box around an object, the longest first, metres.

    Principal axes would be those of the surface that was seen: of a crate seen from a corner, its diagonals.
    So normals of its largest segments may be an axis of the box, too, and that with the least sum of sides is
    taken. The few points that lie far from all others do not count.

    Parameters
    ----------
    segmented : SegmentedObject

    Returns
    -------
    tuple of 3 float
    """
    every = -(-len(segmented.points) // _ENOUGH_POINTS)
    points = _without_far_points(segmented.points[::every])
    points = points - points.mean(axis=0)
    boxes = [_box_along(points, frame) for frame in _frames(segmented, points)]
    longest, middle, shortest = sorted(min(boxes, key=sum), reverse=True)
    return longest, middle, shortest


def _without_far_points(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points not farther from the median than twice as far as nearly all are."""
    distances = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    usual = np.quantile(distances, 0.95, method="lower")
    return points[distances <= 2 * usual]


def _frames(segmented: SegmentedObject, points: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Axes, (3, 3), of which the first is one of the box's."""
    principal = np.linalg.eigh(points.T @ points)[1].T
    frames = [np.roll(principal, turn, axis=0) for turn in range(3)]
    for segment in range(min(segmented.n_segments, _LARGEST_SEGMENTS)):
        normals = segmented.normals[segmented.segment_labels == segment]
        frames.append(np.linalg.svd(normals.mean(axis=0)[None])[2])
    return frames


def _box_along(points: NDArray[np.float64], frame: NDArray[np.float64]) -> list[float]:
    """Sides of the box with the least sum of them that has the first axis of the frame."""
    angles = np.arange(_STEPS) * (np.pi / 2 / _STEPS)
    turns = np.exp(1j * angles)
    first, second, third = frame
    across = np.outer(turns.real, second) + np.outer(turns.imag, third)
    along = np.outer(turns.real, third) - np.outer(turns.imag, second)
    widths, lengths = np.ptp(across @ points.T, axis=1), np.ptp(along @ points.T, axis=1)
    best = int(np.argmin(widths + lengths))
    return [float(np.ptp(points @ first)), float(widths[best]), float(lengths[best])]
