"""Scans any triangle mesh as a Kinect-like sensor would."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.simulation.measurement import measure
from shapeconcepts.simulation.rendering import put_in_front, render
from shapeconcepts.simulation.sensor_model import SensorModel

KINECT = SensorModel()

ELEVATIONS = (10.0, 60.0)
DISTANCES = (0.6, 1.6)
DISTANCE_LIMITS = (0.4, 8.0)
EXTENT_LIMITS = (0.005, 6.0)

# Metres from the origin. Much farther out, rounding leaves nothing of a mesh, and sums overflow.
_FARTHEST_VERTEX = 1e9
_NEAREST_VERTEX = 0.1
# Triangles whose corners are copied at a time.
_AT_ONCE = 2**16


def scan_mesh(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    face_labels: ArrayLike | None = None,
    distance: float | None = None,
    view_direction: ArrayLike | None = None,
    occlusion: float = 0.0,
    noise: bool = True,
    sensor: SensorModel = KINECT,
    random_state: int | np.random.Generator | None = 0,
    name: str = "",
    label: str | None = None,
) -> Scan:
    """Scan a triangle mesh from one side.

    The sensor looks at the middle of the mesh's bounding box, with the z axis of the mesh upwards in the
    image. Both sides of a triangle are seen, so neither closed meshes nor a consistent winding are needed.

    Parameters
    ----------
    vertices : array-like of shape (v, 3)
        Metres, z upwards.
    faces : array-like of int, shape (f, 3)
        Rows of `vertices`.
    face_labels : array-like of int, shape (f,), optional
        Surface part of each face; becomes `Scan.point_labels`.
    distance : float, optional
        From the sensor to the middle of the mesh, 0.4 to 8 metres. By default drawn from 0.6 to 1.6 m, or
        just far enough for a large mesh to fit into the image.
    view_direction : array-like of shape (3,), optional
        From the mesh towards the sensor. By default drawn: any azimuth, 10° to 60° above the horizon.
    occlusion : float
        Share of the visible surface that something in front hides, 0 to 0.9.
    noise : bool
        False gives exact depth at every pixel centre, without lost points.
    sensor : SensorModel
        The camera and its noise.
    random_state : int, numpy.random.Generator or None
        Seed of everything that is drawn; None draws anew each time.
    name, label
        Passed on to the scan.

    Returns
    -------
    Scan
        Points in the camera frame (x right, y down, z forward, the sensor at the origin), in the order of
        the pixels, row by row.

    Raises
    ------
    ScanError
        If the mesh cannot be scanned, an argument is out of range, or nothing is visible.
    """
    title = name or "mesh"
    try:
        rng = np.random.default_rng(random_state)
    except (TypeError, ValueError):
        raise ScanError(
            f"{title}: random_state must be a whole number, 0 or more, a numpy.random.Generator or None, "
            f"got {random_state!r}"
        ) from None
    vertices, faces = _checked_mesh(title, vertices, faces)
    labels = None if face_labels is None else _checked_labels(title, face_labels, len(faces))
    if not 0.0 <= occlusion <= 0.9:
        raise ScanError(f"{title}: occlusion must be between 0 and 0.9, got {occlusion}")

    direction = _random_direction(rng) if view_direction is None else _unit(title, view_direction)
    if distance is None:
        distance = _random_distance(rng, vertices, sensor)
    elif not DISTANCE_LIMITS[0] <= distance <= DISTANCE_LIMITS[1]:
        raise ScanError(
            f"{title}: distance must be {DISTANCE_LIMITS[0]} to {DISTANCE_LIMITS[1]} m, got {distance}"
        )
    vertices = _to_camera(vertices, direction, distance)
    if vertices[:, 2].min() < _NEAREST_VERTEX:
        raise ScanError(
            f"{title}: at distance {distance:g} m, the mesh comes within {_NEAREST_VERTEX} m of the sensor"
        )

    try:
        image = render(vertices, faces, sensor)
    except ScanError as error:
        raise ScanError(f"{title}: {error}") from None
    if occlusion > 0.0:
        put_in_front(image, occlusion, rng)
    if noise:
        triangles, depth = measure(image, vertices, faces, sensor, rng)
    else:
        triangles, depth = image.triangles, 1.0 / np.where(image.triangles >= 0, image.inverse_depth, 1.0)
    rows, columns = np.nonzero(triangles >= 0)
    if not len(rows):
        raise ScanError(f"{title}: nothing of it is visible at distance {distance:g} m")
    z = depth[rows, columns]
    x = (columns + image.column - sensor.center_x) / sensor.focal_length * z
    y = (rows + image.row - sensor.center_y) / sensor.focal_length * z
    return Scan(
        np.column_stack([x, y, z]),
        viewpoint=np.zeros(3),
        name=name,
        label=label,
        point_labels=None if labels is None else labels[triangles[rows, columns]],
    )


def _checked_mesh(
    title: str, vertices: ArrayLike, faces: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The mesh without the vertices that no face uses."""
    try:
        vertices = np.asarray(vertices, dtype=np.float64)
        faces = np.ascontiguousarray(faces)
    except (TypeError, ValueError) as error:
        raise ScanError(f"{title}: vertices and faces must be arrays of numbers ({error})") from None
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise ScanError(f"{title}: vertices must have shape (v, 3), got {vertices.shape}")
    if len(faces) == 0:
        raise ScanError(f"{title}: the mesh has no faces")
    if faces.ndim != 2 or faces.shape[1] != 3 or not np.issubdtype(faces.dtype, np.integer):
        raise ScanError(f"{title}: faces must be integers of shape (f, 3), got {faces.dtype} {faces.shape}")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ScanError(
            f"{title}: faces must index the {len(vertices)} vertices, got {faces.min()} to {faces.max()}"
        )
    used = np.zeros(len(vertices), dtype=bool)
    used[faces] = True
    vertices, faces = vertices[used], np.take(np.cumsum(used) - 1, faces)
    if not np.isfinite(vertices).all():
        raise ScanError(f"{title}: a face has a vertex with a coordinate that is not finite")
    farthest = np.abs(vertices).max()
    if farthest > _FARTHEST_VERTEX:
        raise ScanError(
            f"{title}: a face has a vertex with the coordinate {farthest:g}, expected at most "
            f"{_FARTHEST_VERTEX:g} m"
        )
    extent = np.linalg.norm(np.ptp(vertices, axis=0))
    if not EXTENT_LIMITS[0] <= extent <= EXTENT_LIMITS[1]:
        raise ScanError(
            f"{title}: the mesh is {extent:g} m across, expected {EXTENT_LIMITS[0]} to {EXTENT_LIMITS[1]} m; "
            "its coordinates may not be in metres, which units tells (--units mm)"
        )
    if not any(_has_area(vertices[faces[row : row + _AT_ONCE]]) for row in range(0, len(faces), _AT_ONCE)):
        raise ScanError(f"{title}: every face has the area 0")
    return vertices, faces


def _has_area(corners: NDArray[np.float64]) -> bool:
    """Whether any of some triangles (f, 3, 3) has an area."""
    first, second, third = np.moveaxis(corners, 1, 0)
    return bool(np.cross(second - first, third - first).any())


def _checked_labels(title: str, face_labels: ArrayLike, n_faces: int) -> NDArray[np.int64]:
    labels = np.asarray(face_labels)
    if labels.shape != (n_faces,) or not np.issubdtype(labels.dtype, np.integer):
        raise ScanError(
            f"{title}: face_labels must be integers of shape ({n_faces},), got {labels.dtype} {labels.shape}"
        )
    return labels.astype(np.int64)


def _unit(title: str, direction: ArrayLike) -> NDArray[np.float64]:
    direction = np.asarray(direction, dtype=np.float64)
    if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
        raise ScanError(f"{title}: view_direction must be 3 finite numbers, not all 0, got {direction}")
    return direction / np.linalg.norm(direction)


def _random_direction(rng: np.random.Generator) -> NDArray[np.float64]:
    azimuth = rng.uniform(0.0, 2.0 * np.pi)
    elevation = np.radians(rng.uniform(*ELEVATIONS))
    return np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )


def _random_distance(rng: np.random.Generator, vertices: NDArray[np.float64], sensor: SensorModel) -> float:
    radius = np.linalg.norm(np.ptp(vertices, axis=0)) / 2.0
    half_view = np.arctan(min(sensor.width, sensor.height) / 2.0 / sensor.focal_length)
    return max(rng.uniform(*DISTANCES), radius / np.sin(half_view))


def _to_camera(
    vertices: NDArray[np.float64], direction: NDArray[np.float64], distance: float
) -> NDArray[np.float64]:
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    forward = -direction
    right = np.cross(forward, (0.0, 0.0, 1.0))
    if np.linalg.norm(right) < 1e-9:
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    return (vertices - middle) @ np.column_stack([right, down, forward]) + (0.0, 0.0, distance)
