"""Takes point clouds of other libraries for scans."""

from __future__ import annotations

import numpy as np

from shapeconcepts.io.viewpoint import camera_frame_viewpoint
from shapeconcepts.scan import Scan, ScanError, measured_rows


def as_scan(value: object) -> Scan:
    """Take an (n, 3) array, or an object with `.points` such as `open3d.geometry.PointCloud`, for a scan.

    Parameters
    ----------
    value : Scan, (n, 3) array-like, or object with `.points`
        Coordinates in metres. A Scan is returned as it is.

    Returns
    -------
    Scan
        Arrays say nothing about the sensor: its position is the origin where the points look like a camera
        frame (see `read_scan`), otherwise unknown.

    Raises
    ------
    ScanError
        If there is no finite point in it, or it is something else.
    """
    if isinstance(value, Scan):
        return value
    points = getattr(value, "points", value)
    try:
        scan = Scan(np.array(points, dtype=np.float64))
    except (ScanError, TypeError, ValueError):
        raise ScanError(
            f"expected a Scan, an (n, 3) array or a point cloud with .points, got {type(value).__name__}"
            + (f" of shape {value.shape}" if isinstance(value, np.ndarray) else "")
        ) from None
    if not measured_rows(scan.points).any():
        raise ScanError(f"a {type(value).__name__} with {len(scan)} points holds none that is finite")
    return Scan(scan.points, camera_frame_viewpoint(scan.points))
