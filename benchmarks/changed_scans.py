"""The same objects as worse scans: half of the points, a third of the view hidden, twice the noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts import Scan
from shapeconcepts.datasets.sensor_model import SensorModel
from shapeconcepts.preparation import PreparedObject, prepare
from shapeconcepts.preparation.sensor_direction import estimate_viewpoint

Change = Callable[[Scan, np.random.Generator], Scan]

HIDDEN_SHARE = 1 / 3
# Where only the direction of the sensor is known.
USUAL_DISTANCE = 1.0


def half_of_the_points(scan: Scan, rng: np.random.Generator) -> Scan:
    """Every second point, at random."""
    kept = np.zeros(len(scan), bool)
    kept[rng.permutation(len(scan))[: len(scan) // 2]] = True
    return _part(scan, kept)


def third_hidden(scan: Scan, rng: np.random.Generator) -> Scan:
    """Without the third of the points that is beyond a line across the image in a random direction."""
    viewpoint, _, _ = _seen(scan)
    rays = scan.points - viewpoint
    axis = rays.mean(axis=0)
    across = np.cross(axis, rng.normal(size=3))
    in_image = rays @ across / (rays @ axis)
    return _part(scan, in_image <= np.quantile(in_image, 1 - HIDDEN_SHARE))


def twice_the_noise(scan: Scan, rng: np.random.Generator) -> Scan:
    """With a Kinect's noise in depth (Nguyen et al. 2012) once more, so that its deviation is twice as large.

    Each point moves along its line of sight. Variances add up: to two deviations, the square root of three is
    missing.
    """
    viewpoint, is_measured, prepared = _seen(scan)
    rays = scan.points - viewpoint
    distance = np.linalg.norm(rays, axis=1)
    rays /= distance[:, None]
    normals = prepared.normals[cKDTree(prepared.points).query(scan.points)[1]]
    angle = np.arccos(np.clip(np.abs(np.einsum("ij,ij->i", normals, rays)), 0, 1))
    deviation = SensorModel().axial_noise(distance if is_measured else np.array(USUAL_DISTANCE), angle)
    steps = np.sqrt(3) * deviation * rng.normal(size=len(scan))
    return replace(scan, points=scan.points + steps[:, None] * rays)


CHANGES: dict[str, Change] = {
    "half of the points": half_of_the_points,
    "a third hidden": third_hidden,
    "twice the noise": twice_the_noise,
}


def _seen(scan: Scan) -> tuple[NDArray[np.float64], bool, PreparedObject]:
    """Where the sensor stood, or most likely did; whether its distance is known; and the object's normals."""
    prepared = prepare(scan)
    if scan.viewpoint is not None:
        return scan.viewpoint, True, prepared
    return *estimate_viewpoint(scan.points, prepared.points, prepared.normals), prepared


def _part(scan: Scan, kept: NDArray[np.bool_]) -> Scan:
    point_labels = None if scan.point_labels is None else scan.point_labels[kept]
    return replace(scan, points=scan.points[kept], point_labels=point_labels)
