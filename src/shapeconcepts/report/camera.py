"""Where an object is looked at from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def view_axes(
    points: NDArray[np.float64], normals: NDArray[np.float64], viewpoint: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Axes of an orthographic camera that sees the object as the sensor did.

    The camera looks from the viewpoint to the middle of the points; where the viewpoint is not known, against
    the mean normal, since a single view only holds surface that faced the sensor. A viewpoint at the origin
    means an optical frame (y down); any other frame is taken to have z up.

    Parameters
    ----------
    points, normals : (m, 3) float64
        Points in metres, unit normals towards the sensor.
    viewpoint : (3,) float64 or None
        Position of the sensor in the frame of the points.

    Returns
    -------
    (3, 3) float64
        Rows: right, up, and towards the camera; orthonormal.

    Raises
    ------
    ValueError
        If the viewpoint is too far away to compute with.
    """
    towards = normals.mean(axis=0) if viewpoint is None else viewpoint - points.mean(axis=0)
    with np.errstate(over="ignore"):
        distance = np.linalg.norm(towards)
    if not np.isfinite(distance):
        raise ValueError(f"viewpoint must be near enough to look from, got {viewpoint}")
    if distance < 1e-9:
        towards = np.array([0.0, 0.0, 1.0])
    towards = towards / np.linalg.norm(towards)

    optical_frame = viewpoint is not None and not viewpoint.any()
    up = np.array([0.0, -1.0, 0.0]) if optical_frame else np.array([0.0, 0.0, 1.0])
    if abs(up @ towards) > 0.99:
        up = np.array([0.0, 0.0, -1.0]) if optical_frame else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])
