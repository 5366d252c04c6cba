"""Where the sensor stood, for clouds that come without its position, and which way normals point then."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.preparation.pixel_lattice import viewpoint_from_pixel_lattice

_N_DIRECTIONS = 300
_N_FINER_DIRECTIONS = 60
_FINER_RADIUS = 0.16
_N_VOXELS = 1000
_GRAZING = 0.2
_OUTWARDNESS_WEIGHT = 0.5
_UNDECIDED_OUTWARDNESS = 0.05
_DISTANCE_IN_RADII = 10.0
_WELL_SEEN = 0.97


def estimate_viewpoint(
    points: NDArray[np.float64], voxel_points: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], bool]:
    """Position of the sensor that saw a single-view point cloud.

    Raw depth images tell it exactly, by their pixel lattice (see `viewpoint_from_pixel_lattice`). Where the
    points were resampled, the surface tells the direction: hardly any normal of what a sensor sees is
    perpendicular to its line of sight, and surfaces bulge towards it more often than away. Where even that
    does not tell front from back, the sensor is taken to look along +z, as depth cameras do.

    Parameters
    ----------
    points : (n, 3) float64
        Finite points of one object as measured, n >= 1.
    voxel_points : (m, 3) float64
        Points with normals on the same object, m >= 1, in an order that does not depend on how it stands.
    normals : (m, 3) float64
        Unit normals of `voxel_points`; their signs do not matter.

    Returns
    -------
    viewpoint : (3,) float64
    is_measured : bool
        True where the pixel lattice gave the viewpoint. False where it is only the likeliest direction, at
        ten times the object's mean radius: a bowl seen from above and a dome are then the same.
    """
    viewpoint, is_certain = viewpoint_from_pixel_lattice(points)
    if viewpoint is not None and is_certain:
        return viewpoint, True
    return _viewpoint_from_surface(voxel_points, normals, viewpoint)


def orient_normals(
    points: NDArray[np.float64], normals: NDArray[np.float64], viewpoint: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Normals of a surface, each turned to the side of the viewpoint.

    Parameters
    ----------
    points, normals : (m, 3) float64
    viewpoint : (3,) float64

    Returns
    -------
    (m, 3) float64
    """
    towards = np.einsum("ij,ij->i", normals, viewpoint - points)
    return np.where(towards[:, None] < 0.0, -normals, normals)


def _viewpoint_from_surface(
    points: NDArray[np.float64], normals: NDArray[np.float64], candidate: NDArray[np.float64] | None
) -> tuple[NDArray[np.float64], bool]:
    """The candidate if the surface is seen well from it (True), else one in the best direction (False).

    That direction has the fewest grazing and the most outward normals, and is on the side of the candidate.
    """
    centre = points.mean(axis=0)
    radius = float(np.linalg.norm(points - centre, axis=1).mean()) or 1.0
    # Spread over the object, as neighbours follow each other; and the same points wherever it stands.
    rows = np.linspace(0, len(points) - 1, min(_N_VOXELS, len(points))).astype(np.int64)
    offsets, normals = (points[rows] - centre) / radius, normals[rows]

    direction, outwardness = _best_direction(_hemisphere(), offsets, normals)
    direction, outwardness = _best_direction(_around(direction), offsets, normals)
    if candidate is not None:
        towards = (candidate - centre) / radius - offsets
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        seen = _visibility(np.einsum("ij,ij->i", normals, towards)[:, None])
        if seen[0] > _WELL_SEEN * _visibility(normals @ direction[:, None])[0]:
            return candidate, True
        is_behind = direction @ (candidate - centre) < 0.0
    elif abs(outwardness) > _UNDECIDED_OUTWARDNESS:
        is_behind = outwardness < 0.0
    else:
        is_behind = direction[2] > 0.0
    return centre + _DISTANCE_IN_RADII * radius * (-direction if is_behind else direction), False


def _best_direction(
    directions: NDArray[np.float64], offsets: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Axis that suits the normals best, and how far outward (> 0) they point when turned along it."""
    cosines = normals @ directions.T
    outward = np.einsum("ij,ij->i", normals, offsets)
    outwardness = outward @ np.sign(cosines) / len(normals)
    best = int(np.argmax(_visibility(cosines) + _OUTWARDNESS_WEIGHT * np.abs(outwardness)))
    return directions[best], float(outwardness[best])


def _visibility(cosines: NDArray[np.float64]) -> NDArray[np.float64]:
    """For each column, the share of normals that are not at a grazing angle, softly counted."""
    squared = cosines * cosines
    return (squared / (squared + _GRAZING**2)).mean(axis=0)


def _hemisphere() -> NDArray[np.float64]:
    """Evenly spread axes: the half with z < 0 of a Fibonacci sphere."""
    index = np.arange(_N_DIRECTIONS) + 0.5
    z = index / _N_DIRECTIONS - 1.0
    turn = index * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - z * z)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])


def _around(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Directions within `_FINER_RADIUS` radians of one, evenly spread, itself first."""
    side = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    side /= np.linalg.norm(side)
    index = np.arange(_N_FINER_DIRECTIONS)
    radius = _FINER_RADIUS * np.sqrt(index / _N_FINER_DIRECTIONS)
    turn = index * np.pi * (3.0 - np.sqrt(5.0))
    offsets = np.outer(np.cos(turn), side) + np.outer(np.sin(turn), np.cross(direction, side))
    spread = direction + radius[:, None] * offsets
    return spread / np.linalg.norm(spread, axis=1, keepdims=True)
