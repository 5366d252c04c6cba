"""Decides whether a sensor position can be believed.

Normals are turned towards the sensor, so a wrong position does more harm than none. Many files carry the
position (0, 0, 0) only because nobody set it: their clouds are centred on the object, or stand in the frame
of a table or a map.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import measured_rows

_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_IN_COMMENT = re.compile(
    r"\b(?:view[ _]?point|(?:sensor|camera)[ _](?:origin|position|cent(?:er|re)))\W+?"
    + r"[\s,;]+".join([_NUMBER] * 3)
    # Behind a decimal comma the number goes on.
    + r"(?![.,]?\d)",
    re.IGNORECASE,
)
# Depth sensors measure nothing nearer than this, metres.
NEAREST = 0.25
# A cloud in other units is told by its size: this many radii away, only one side of it is seen.
NEAREST_IN_RADII = 3.0
# Tangent of the half angle of view. A Kinect's image corner is 34° off its axis, a wide depth camera's 45°.
FIELD_OF_VIEW = 1.0
# The sensor is at least this far outside the bounding box, as a share of its diagonal.
MARGIN = 0.1


def viewpoint_of(
    points: NDArray[np.float64], declared: NDArray[np.float64] | None
) -> NDArray[np.float64] | None:
    """Where the sensor stood, by what a file declares or else by the cloud itself; None if it is not known.

    Parameters
    ----------
    points : (n, 3) float64
        The cloud, metres; what was not measured does not count.
    declared : (3,) float64 or None
        In the same frame.
    """
    return camera_frame_viewpoint(points) if declared is None else declared_viewpoint(points, declared)


def unless_default(position: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
    """A position; None for (0, 0, 0), which writers put there when they do not know."""
    return position if position is not None and position.any() else None


def viewpoint_in_comments(comments: Iterable[str]) -> NDArray[np.float64] | None:
    """The first three numbers behind "viewpoint", "sensor origin", "camera position" and the like."""
    for comment in comments:
        if found := _IN_COMMENT.search(comment):
            return np.array([float(number) for number in found.groups()])
    return None


def common_position(columns: Iterable[NDArray]) -> NDArray[np.float64] | None:
    """The position that three columns hold for every point, if it is one for all that know it."""
    position = []
    for column in columns:
        known = np.unique(column[np.isfinite(column)])
        if len(known) != 1:
            return None
        position.append(float(known[0]))
    return np.array(position)


def declared_viewpoint(
    points: NDArray[np.float64], position: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """The position that somebody set, if it is finite and clearly outside the cloud, else None.

    Parameters
    ----------
    points : (n, 3) float64
        The cloud; what was not measured does not count.
    position : (3,) float64
        Sensor position in the same frame.
    """
    measured = measured_rows(points)
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
    0.25 m or, for small objects or other units, than three times the object's radius.

    Parameters
    ----------
    points : (n, 3) float64
        The cloud; what was not measured does not count.
    """
    measured = measured_rows(points)
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
