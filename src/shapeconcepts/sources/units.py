"""In which unit the coordinates of a file are, where nobody says it.

Files do not tell their unit. Of what depth sensors see, metres and millimetres are common, and nearly always
the numbers tell them apart: an object of 180 m, with a point every 1.5 m, was seen by no depth sensor. In
centimetres the points would be as far apart; there the points of a sensor are closer than one unit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts.geometry.extent import robust_extent
from shapeconcepts.io.viewpoint import viewpoint_of
from shapeconcepts.scan import measured_rows

METRE, MILLIMETRE = 1.0, 0.001
TAKEN_AS_MILLIMETRES = "taken as millimetres, another unit is set with units (--units m)"
TAKEN_AS_METRES = "taken as metres, another unit is set with units (--units mm, --units cm, --units in)"
# Units. Objects in metres are smaller.
_LARGEST_IN_METRES = 3.0
# Millimetres: extents and coordinates of what depth sensors see, and from which extent on centimetres would
# be furniture.
_SMALLEST, _FARTHEST = 20.0, 10_000.0
_LARGE = 100.0
# Millimetres between neighbouring points: hardly less in a large object; in any, if it were centimetres, no
# sensor sees so coarsely; more is a lidar's, or terrain.
_FINE, _SENSORS_OWN, _COARSE = 0.3, 1.0, 10.0
# Metres from the sensor: no depth sensor measures nearer; farther than the second, centimetres are excluded.
_NEAREST_SENSOR, _FAR_SENSOR = 0.1, 0.5
# Metres that depth sensors measure.
_REACH = 10.0
_N_PROBED = 500
# Of copies of a point, so many may be its nearest neighbours.
_N_NEIGHBOURS = 8


def unit_of_cloud(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64] | None
) -> tuple[float, tuple[str, ...]]:
    """Metres per unit of a cloud of one object, or of a scene, and what there is to say of it.

    Millimetres where it cannot be anything else: 20 to 10,000 units across and not farther from the origin,
    neighbouring points at most 10 apart, and

    * the sensor, where its position is known, 500 units away or more (5 m if it were centimetres); or
    * neighbouring points 1 apart or more (1 cm if it were centimetres, 1 m if it were metres); or
    * 100 units across or more, and neighbouring points 0.3 apart or more.

    Otherwise metres, with a notice where an object would be larger than 3 m: a car, or one in inches or
    centimetres.

    Parameters
    ----------
    points : (n, 3) float64
        As in the file; what was not measured does not count.
    viewpoint : (3,) float64 or None
        What the file declares.

    Returns
    -------
    metres : float
    notices : tuple of str
        See `Scan.notices`.
    """
    measured = measured_rows(points)
    seen = points if measured.all() else points[measured]
    with np.errstate(over="ignore"):
        # One column at a time: ten times faster.
        if len(seen) < 2 or np.linalg.norm([np.ptp(axis) for axis in seen.T]) <= _LARGEST_IN_METRES:
            return METRE, ()
        extent = robust_extent(seen)
        if extent <= _LARGEST_IN_METRES or not np.isfinite(extent):
            return METRE, ()
        if _is_in_millimetres(seen, viewpoint, extent):
            return MILLIMETRE, (f"has an extent of {extent:.3g}: {TAKEN_AS_MILLIMETRES}",)
        # A room as a depth sensor sees it: in any smaller unit, the sensor would be in the midst of it.
        distance = _distance_of_sensor(seen, viewpoint, METRE)
    if distance is not None and distance <= _REACH and extent <= _REACH:
        return METRE, ()
    return METRE, (f"has an extent of {extent:.3g}: {TAKEN_AS_METRES}",)


def unit_of_mesh(vertices: NDArray[np.float64]) -> tuple[float, tuple[str, ...]]:
    """Metres per unit of a mesh, and what there is to say of it; as `unit_of_cloud`.

    Vertices say nothing about a sensor: it is millimetres from 100 to 10,000 units across.

    Parameters
    ----------
    vertices : (v, 3) float64
    """
    known = vertices[np.isfinite(vertices).all(axis=1)]
    if len(known) == 0:
        return METRE, ()
    with np.errstate(over="ignore"):
        extent = float(np.linalg.norm(np.ptp(known, axis=0)))
    if extent <= _LARGEST_IN_METRES or not np.isfinite(extent):
        return METRE, ()
    if _LARGE <= extent <= _FARTHEST and np.abs(known).max() <= _FARTHEST:
        return MILLIMETRE, (f"has an extent of {extent:.3g}: {TAKEN_AS_MILLIMETRES}",)
    return METRE, (f"has an extent of {extent:.3g}: {TAKEN_AS_METRES}",)


def _is_in_millimetres(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64] | None, extent: float
) -> bool:
    if not (_SMALLEST <= extent <= _FARTHEST and np.median(np.abs(points), axis=0).max() <= _FARTHEST):
        return False
    distance = _distance_of_sensor(points, viewpoint, MILLIMETRE)
    if distance is not None and not _NEAREST_SENSOR <= distance <= _REACH:
        return False
    spacing = _spacing(points)
    if spacing > _COARSE:
        return False
    is_far = distance is not None and distance >= _FAR_SENSOR
    return is_far or spacing >= _SENSORS_OWN or (extent >= _LARGE and spacing >= _FINE)


def _distance_of_sensor(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64] | None, metres: float
) -> float | None:
    """Metres from the sensor to the middle of the points, if they are in this unit; None if it is unknown."""
    position = viewpoint_of(points * metres, None if viewpoint is None else viewpoint * metres)
    if position is None:
        return None
    return float(np.linalg.norm(position - np.median(points, axis=0) * metres))


def _spacing(points: NDArray[np.float64]) -> float:
    """Median distance of points to the nearest other one, copies left out."""
    probed = points[:: max(1, len(points) // _N_PROBED)]
    distances, _ = cKDTree(points).query(probed, min(_N_NEIGHBOURS, len(points)))
    nearest = np.where(distances > 0.0, distances, np.inf).min(axis=1)
    known = nearest[np.isfinite(nearest)]
    return float(np.median(known)) if len(known) else 0.0
