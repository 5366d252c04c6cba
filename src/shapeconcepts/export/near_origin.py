"""Scans for formats of single precision, which hold coordinates near the origin only."""

from __future__ import annotations

import numpy as np

from shapeconcepts.geometry.origin import nearest_tile
from shapeconcepts.scan import Scan, ScanError, measured_rows


def near_origin(scan: Scan) -> tuple[Scan, tuple[float, float, float]]:
    """The points of a scan that were measured, moved near the origin where they are far away from it.

    They are rounded as they will be when they are written: what is computed from them fits.

    Returns
    -------
    scan : Scan
        Without point labels.
    origin : (float, float, float)
        Metres: what was taken off; zeros unless the scan is half a kilometre away.

    Raises
    ------
    ScanError
        If no point was measured.
    """
    points = scan.points[measured_rows(scan.points)]
    if len(points) == 0:
        raise ScanError(f"{scan.name}: holds no point with finite x, y and z")
    origin = nearest_tile(points)
    viewpoint = None if scan.viewpoint is None else scan.viewpoint - origin
    moved = Scan((points - origin).astype(np.float32), viewpoint, scan.name, scan.label)
    x, y, z = origin.tolist()
    return moved, (x, y, z)
