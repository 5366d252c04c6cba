"""Decides whether a sensor position can be believed.

Normals are turned towards the sensor, so a wrong position does more harm than none. Many files carry the
position (0, 0, 0) only because nobody set it: their clouds are centred on the object, or stand in the frame
of a table or a map.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Depth sensors measure nothing nearer than this, metres.
NEAREST = 0.25
# A cloud in other units is told by its size: this many radii away, only one side of it is seen.
NEAREST_IN_RADII = 3.0
# Tangent of the half angle of view. A Kinect's image corner is 34° off its axis, a wide depth camera's 45°.
FIELD_OF_VIEW = 1.0
# The sensor is at least this far outside the bounding box, as a share of its diagonal.
MARGIN = 0.1


def finite_rows(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Rows of an (n, 3) array without NaN and infinity."""
    # Ten times faster than all(axis=1).
    x, y, z = np.isfinite(points).T
    return x & y & z


def declared_viewpoint(
    points: NDArray[np.float64], position: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """The position that somebody set, if it is finite and clearly outside the cloud, else None.

    Parameters
    ----------
    points : (n, 3) float64
        The cloud; non-finite rows do not count.
    position : (3,) float64
        Sensor position in the same frame.
    """
    measured = finite_rows(points)
    if not measured.any() or not np.isfinite(position).all():
        return None
    low, high = _bounding_box(points, measured)
    with np.errstate(over="ignore"):
        outside = np.maximum(np.maximum(low - position, position - high), 0.0)
        gap, diagonal = np.linalg.norm(outside), np.linalg.norm(high - low)
    return position if gap > 0.0 and gap >= MARGIN * diagonal else None


def camera_frame_viewpoint(points: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The origin, if the cloud looks as if a camera there had seen it, else None.

    That is: every point lies in front (z forward) and within the field of view, and none is nearer than
    0.25 m or, for small objects or other units, than three times the object's radius. Points exactly at the
    origin are taken for missing measurements.

    Parameters
    ----------
    points : (n, 3) float64
        The cloud; non-finite rows do not count.
    """
    measured = finite_rows(points) & ((points[:, 0] != 0.0) | (points[:, 1] != 0.0) | (points[:, 2] != 0.0))
    if not measured.any():
        return None
    z = points[measured, 2]
    with np.errstate(over="ignore"):
        # One column at a time, as a cloud can fill the memory.
        off_axis = points[measured, 0] ** 2
        off_axis += points[measured, 1] ** 2
        if not ((z > 0.0) & (off_axis <= (FIELD_OF_VIEW * z) ** 2)).all():
            return None
        nearest = np.sqrt((off_axis + z * z).min())
        low, high = _bounding_box(points, measured)
        radius = np.linalg.norm(high - low) / 2.0
    # A single point has no size that its distance could be compared with.
    far_for_its_size = 0.0 < NEAREST_IN_RADII * radius <= nearest
    return np.zeros(3) if nearest >= NEAREST or far_for_its_size else None


def _bounding_box(
    points: NDArray[np.float64], measured: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    columns = (column[measured] for column in points.T)
    low, high = zip(*((column.min(), column.max()) for column in columns), strict=True)
    return np.array(low), np.array(high)
