"""A scene as the pixels of an image, whatever order its points are in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts.extraction.component_kernels import distances_and_jumps
from shapeconcepts.extraction.pixel_kernels import largest_coordinate, measured_points
from shapeconcepts.geometry.origin import nearest_tile
from shapeconcepts.scan import ScanError, measured_rows
from shapeconcepts.scene import Scene

# Images that depth cameras make: what has as many points, row by row, is one.
_IMAGE_SIZES = (
    (480, 640),
    (240, 320),
    (424, 512),
    (720, 1280),
    (480, 848),
    (576, 640),
    (512, 512),
    (1024, 1024),
)
# Times the distance between neighbours, of points in no order: few pixels of this size are empty.
_COARSER = 1.2
_MOST_PIXELS = 2**22
_N_SAMPLES, _MOST_LOOKED_AT = 400, 10_000
# Share of the points that a camera at the origin has in front of it, within this angle from the z axis.
_IN_FRONT, _IN_VIEW = 0.98, np.cos(np.radians(55.0))
# Metres above a scene from which it is looked at where nothing says where the sensor was.
_ABOVE = 1.0


# Metres.
LARGEST = 1e9


class PixelGrid(NamedTuple):
    """An organised scene.

    Attributes
    ----------
    points : (h, w, 3) float64
        From `origin`; NaN where nothing was measured.
    origin : (3,) float64
        A point near them, in the frame of the scene.
    viewpoint : (3,) float64
        From `origin`.
    pitch : float
        Angle between neighbouring pixels, radians.
    distances : (h, w) float32
        From the viewpoint, NaN where nothing was measured.
    jumps : (h, w) float32
        Difference of distance to a neighbour from which on that is another surface.
    is_camera_frame : bool
        Whether the points look like those of a camera: z forward, y down.
    up : (3,) float64
        Against gravity; as long as it is not known, zeros.
    """

    points: NDArray[np.float64]
    origin: NDArray[np.float64]
    viewpoint: NDArray[np.float64]
    pitch: float
    distances: NDArray[np.float32]
    jumps: NDArray[np.float32]
    is_camera_frame: bool
    up: NDArray[np.float64]


class ScenePixels(NamedTuple):
    """The grid of a scene, and the pixel that each of its points is in.

    Attributes
    ----------
    grid : PixelGrid
    pixels : (n,) int64
        Of each point, row by row; -1 where it was not measured.
    is_image : bool
        Whether the points are those of the pixels, each in its own.
    """

    grid: PixelGrid
    pixels: NDArray[np.int64]
    is_image: bool


def scene_pixels(scene: Scene) -> ScenePixels:
    """Put a scene into the pixels of an image.

    Organised scenes have them, and so have clouds of as many points as a depth camera's image, row by row.
    Others are seen from their viewpoint again, by pixels a little larger than the distance between points;
    without a viewpoint, from the origin if the points look like those of a camera, else from a metre above
    (z upwards). Where several points are in a pixel, the nearest stands for them.

    Raises
    ------
    ScanError
        If nothing was measured, or coordinates are too large to compute with.
    """
    points, title = scene.points.reshape(-1, 3), scene.name or "scene"
    is_measured = measured_rows(points)
    if not is_measured.any():
        raise ScanError(f"{title}: none of its {len(points)} points is finite")
    farthest = largest_coordinate(points, is_measured)
    if scene.viewpoint is not None:
        farthest = max(farthest, float(np.abs(scene.viewpoint).max()))
    if farthest > LARGEST:
        raise ScanError(f"{title}: coordinates up to {farthest:.3g}, expected metres (at most {LARGEST:.0e})")
    some = points[is_measured] if len(points) < _MOST_LOOKED_AT else _sample(points, is_measured)
    # Far from the origin, squares would round.
    origin = nearest_tile(some)
    viewpoint, is_camera_frame = _viewpoint(scene, some)
    viewpoint = viewpoint - origin
    shape = scene.points.shape[:2] if scene.is_organised else _image_shape(points, is_measured)
    if shape is not None:
        image = measured_points(points, is_measured, origin).reshape(*shape, 3)
        pixels = np.where(is_measured, np.arange(len(points)), -1)
        pitch = _pitch_of_image(image, viewpoint)
    else:
        image, pixels, pitch = _projected(points - origin, is_measured, viewpoint, is_camera_frame)
    distances, jumps = distances_and_jumps(image, viewpoint, pitch)
    grid = PixelGrid(image, origin, viewpoint, pitch, distances, jumps, is_camera_frame, np.zeros(3))
    return ScenePixels(grid, pixels, shape is not None)


def _sample(points: NDArray[np.float64], is_measured: NDArray[np.bool_]) -> NDArray[np.float64]:
    measured = np.flatnonzero(is_measured)
    return points[measured[:: -(-len(measured) // _MOST_LOOKED_AT)]]


def _viewpoint(scene: Scene, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], bool]:
    """Where the sensor was, and whether the frame is that of a camera."""
    origin = np.zeros(3) if scene.viewpoint is None else scene.viewpoint
    sights = points - origin
    cosines = sights[:, 2] / np.maximum(np.linalg.norm(sights, axis=1), 1e-300)
    is_camera_frame = bool((cosines > _IN_VIEW).mean() > _IN_FRONT)
    if scene.viewpoint is not None or is_camera_frame:
        return origin, is_camera_frame
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([*(low + high)[:2] / 2.0, high[2] + _ABOVE]), False


def _image_shape(points: NDArray[np.float64], is_measured: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Height and width of the image whose pixels the points are, row by row; None where they are none."""
    for height, width in _IMAGE_SIZES:
        if len(points) != height * width:
            continue
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)[is_measured[1:] & is_measured[:-1]]
        below = np.linalg.norm(points[width:] - points[:-width], axis=1)[
            is_measured[width:] & is_measured[:-width]
        ]
        # Neighbours in a column are as near as those in a row.
        if len(steps) and len(below) and np.median(below) < 5.0 * np.median(steps):
            return height, width
    return None


def _pitch_of_image(image: NDArray[np.float64], viewpoint: NDArray[np.float64]) -> float:
    some = image[:: max(image.shape[0] // 48, 1)] - viewpoint
    # Of next to nothing, squares are 0.
    rays = some / np.maximum(np.linalg.norm(some, axis=2, keepdims=True), 1e-300)
    angles = np.linalg.norm(rays[:, 1:] - rays[:, :-1], axis=2)
    angles = angles[angles > 0.0]
    return float(np.median(angles)) if len(angles) else 0.002


def _projected(
    points: NDArray[np.float64],
    is_measured: NDArray[np.bool_],
    viewpoint: NDArray[np.float64],
    is_camera_frame: bool,
) -> tuple[NDArray[np.float64], NDArray[np.int64], float]:
    """Image, pixel of each point and pitch of points in no order."""
    sights = points[is_measured] - viewpoint
    distances = np.linalg.norm(sights, axis=1)
    rays = sights / np.maximum(distances, 1e-300)[:, None]
    forward = np.array([0.0, 0.0, 1.0]) if is_camera_frame else rays.mean(axis=0)
    forward /= max(float(np.linalg.norm(forward)), 1e-300)
    # Rows of the image go down: along y in the frame of a camera, else against z.
    down = np.array([0.0, 1.0, 0.0]) if is_camera_frame else np.array([0.0, 0.0, -1.0])
    right = np.cross(down, forward)
    if np.linalg.norm(right) < 1e-3:
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    # Angles, so that what is beside or behind the sensor has a pixel, too.
    across = np.arctan2(rays @ right, rays @ forward)
    along = np.arcsin(np.clip(rays @ down, -1.0, 1.0))
    places = np.stack([along, across], axis=1)
    sample = places[:: max(len(places) // _N_SAMPLES, 1)]
    nearest = cKDTree(places).query(sample, 2)[0][:, 1] if len(places) > 1 else np.array([0.002])
    nearest = nearest[nearest > 0.0]
    pitch = _COARSER * float(np.median(nearest)) if len(nearest) else 0.002
    low = places.min(axis=0)
    pitch = max(pitch, float(np.sqrt(np.prod(np.ptp(places, axis=0) + pitch) / _MOST_PIXELS)))
    rows, columns = ((places - low) / pitch).astype(np.int64).T
    height, width = int(rows.max()) + 1, int(columns.max()) + 1
    own = rows * width + columns
    image = np.full((height * width, 3), np.nan)
    # The nearest is written last.
    order = np.argsort(-distances, kind="stable")
    image[own[order]] = points[is_measured][order]
    pixels = np.full(len(points), -1)
    pixels[is_measured] = own
    return image.reshape(height, width, 3), pixels, pitch
