"""The same objects as worse scans: half of the points, a third of the view hidden, twice the noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts import Scan, segment
from shapeconcepts.evaluation import foreign_points
from shapeconcepts.evaluation.foreign_points import touching_part
from shapeconcepts.preparation import PreparedObject, prepare
from shapeconcepts.preparation.sensor_direction import estimate_viewpoint
from shapeconcepts.simulation.sensor_model import SensorModel

Change = Callable[[Scan, np.random.Generator], Scan]

HIDDEN_SHARE = 1 / 3
# Where only the direction of the sensor is known.
USUAL_DISTANCE = 1.0
# Planes that are fitted to tell the noise, and pixels of each.
N_FITS = 500
N_PIXELS = 25


def half_of_the_points(scan: Scan, rng: np.random.Generator) -> Scan:
    """Every second point, at random."""
    kept = np.zeros(len(scan), bool)
    kept[rng.permutation(len(scan))[: len(scan) // 2]] = True
    return _part(scan, kept)


def third_hidden(scan: Scan, rng: np.random.Generator) -> Scan:
    """Without the third of the points that is beyond a line across the image in a random direction."""
    return share_hidden(scan, rng, HIDDEN_SHARE)


def share_hidden(scan: Scan, rng: np.random.Generator, share: float) -> Scan:
    """Without a share of the points, those beyond a line across the image in a random direction."""
    viewpoint, _, _ = _seen(scan)
    across = rng.normal(size=2) @ _image(scan.points, viewpoint)[0]
    return _part(scan, across <= np.quantile(across, 1 - share))


def segments_hidden(scan: Scan, rng: np.random.Generator) -> Scan | None:
    """Without one of two segments, or two of more, at random; None where there is only one."""
    segmented = segment(scan)
    if segmented.n_segments < 2:
        return None
    hidden = rng.permutation(segmented.n_segments)[: 1 if segmented.n_segments == 2 else 2]
    of_point = np.append(segmented.segment_labels, -1)[segmented.point_to_voxel]
    return _part(scan, ~np.isin(of_point, hidden))


def twice_its_noise(scan: Scan, rng: np.random.Generator) -> Scan:
    """With noise in depth that makes the deviation of what the scan has twice as large."""
    viewpoint, _, _ = _seen(scan)
    rays, _ = _lines_of_sight(scan.points, viewpoint)
    return _noisier(scan, rays, depth_noise(scan.points, viewpoint), rng)


def kinect_noise_twice(scan: Scan, rng: np.random.Generator) -> Scan:
    """With noise in depth that makes the deviation of a Kinect (Nguyen et al. 2012) twice as large."""
    viewpoint, is_measured, prepared = _seen(scan)
    rays, distance = _lines_of_sight(scan.points, viewpoint)
    normals = prepared.normals[cKDTree(prepared.points).query(scan.points)[1]]
    angle = np.arccos(np.clip(np.abs(np.einsum("ij,ij->i", normals, rays)), 0, 1))
    known = distance if is_measured else np.full(len(scan), USUAL_DISTANCE)
    return _noisier(scan, rays, SensorModel().axial_noise(known, angle), rng)


CHANGES: dict[str, Change] = {
    "half of the points": half_of_the_points,
    "a third hidden": third_hidden,
    "twice its noise": twice_its_noise,
    "a Kinect's noise, twice": kinect_noise_twice,
}


def depth_noise(points: NDArray[np.float64], viewpoint: NDArray[np.float64]) -> float:
    """Standard deviation of the depth of neighbouring pixels from their plane, median over pixels."""
    image, depth = _image(points, viewpoint)
    some = image.T[:: max(1, len(points) // N_FITS)]
    rows = cKDTree(image.T).query(some, N_PIXELS)[1]
    offsets = image.T[rows] - some[:, None]
    planes = np.concatenate([np.ones((*rows.shape, 1)), offsets], axis=2)
    residuals = depth[rows] - np.einsum("ijk,ikl,il->ij", planes, np.linalg.pinv(planes), depth[rows])
    return float(np.median(np.sqrt((residuals**2).sum(axis=1) / (N_PIXELS - 3))))


def _noisier(
    scan: Scan, rays: NDArray[np.float64], deviation: float | NDArray[np.float64], rng: np.random.Generator
) -> Scan:
    """Variances add up: to two deviations, the square root of three is missing."""
    steps = np.sqrt(3) * deviation * rng.normal(size=len(scan))
    return replace(scan, points=scan.points + steps[:, None] * rays)


def _lines_of_sight(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions from the sensor, and distances."""
    rays = points - viewpoint
    distances = np.linalg.norm(rays, axis=1)
    return rays / distances[:, None], distances


def _image(
    points: NDArray[np.float64], viewpoint: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places in the image of a camera that looks at the points, (2, n), and depths."""
    rays = points - viewpoint
    axis = rays.mean(axis=0) / np.linalg.norm(rays.mean(axis=0))
    sides = np.linalg.svd(axis[None])[2][1:]
    depth = rays @ axis
    return sides @ rays.T / depth, depth


def _seen(scan: Scan) -> tuple[NDArray[np.float64], bool, PreparedObject]:
    """Where the sensor stood, or most likely did; whether its distance is known; and the object's normals."""
    prepared = prepare(scan)
    if scan.viewpoint is not None:
        return scan.viewpoint, True, prepared
    return *estimate_viewpoint(scan.points, prepared.points, prepared.normals), prepared


def _part(scan: Scan, kept: NDArray[np.bool_]) -> Scan:
    point_labels = None if scan.point_labels is None else scan.point_labels[kept]
    return replace(scan, points=scan.points[kept], point_labels=point_labels)


def foreign_object(scan: Scan, rng: np.random.Generator, share: float, others: Sequence[Scan]) -> Scan:
    """With a part of an object of another label beside it that touches it, so many of all points."""
    different = [one for one in others if one.label != scan.label]
    other = different[rng.integers(len(different))]
    return _joined(scan, touching_part(scan.points, _sight(scan), other.points, share, rng))


def table_strip(scan: Scan, rng: np.random.Generator, share: float) -> Scan:
    """With a strip of a plane below its lower rim in the image, so many of all points."""
    return _joined(scan, foreign_points.table_strip(scan.points, _sight(scan), share, rng))


def _sight(scan: Scan) -> NDArray[np.float64]:
    return scan.points.mean(axis=0) - _seen(scan)[0]


def _joined(scan: Scan, foreign: NDArray[np.float64]) -> Scan:
    return replace(scan, points=np.concatenate([scan.points, foreign]), point_labels=None)
