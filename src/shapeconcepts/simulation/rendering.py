"""Exact depth images of triangle meshes, and an occluder in front of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError
from shapeconcepts.simulation.sensor_kernels import NOTHING, rasterise
from shapeconcepts.simulation.sensor_model import SensorModel

OCCLUDER = -2

# Noise reaches a few pixels beyond the outline of the object.
_MARGIN = 4
_NEAREST_OCCLUDER = 0.1
# About two seconds. Thousands of long slivers stay below; a face that is repeated a thousand times does not.
_MOST_WORK = 2**29


class DepthImage(NamedTuple):
    """What is nearest at every pixel, in the part of the image that holds the object.

    Attributes
    ----------
    triangles : (h, w) int32
        Index of the triangle, negative where there is none.
    inverse_depth : (h, w) float64
        Its inverse depth at the pixel's centre in 1/m, 0 where there is nothing.
    column, row : int
        Pixel of the whole image that comes first.
    """

    triangles: NDArray[np.int32]
    inverse_depth: NDArray[np.float64]
    column: int
    row: int


def render(vertices: NDArray[np.float64], faces: NDArray[np.int64], sensor: SensorModel) -> DepthImage:
    """Exact depth image around a mesh whose vertices (v, 3) are in the camera frame.

    ScanError if its triangles overlap without end.
    """
    projected = _projected(vertices, sensor)
    size = np.array([sensor.width, sensor.height])
    low = np.floor(projected[:, :2].min(axis=0)).astype(int) - _MARGIN
    high = np.ceil(projected[:, :2].max(axis=0)).astype(int) + _MARGIN + 1
    low, high = np.clip(low, 0, size), np.clip(high, 0, size)
    projected[:, :2] -= low
    _check_work(projected[:, :2], faces, high - low)
    triangles, inverse_depth = rasterise(projected, faces, int(high[1] - low[1]), int(high[0] - low[0]))
    return DepthImage(triangles, inverse_depth, int(low[0]), int(low[1]))


def _check_work(projected: NDArray[np.float64], faces: NDArray[np.int64], size: NDArray[np.int64]) -> None:
    """Raise ScanError where the triangles cover the image (columns, rows) so often that it is no surface."""
    # One side of the image after the other, as there can be as many triangles as the memory holds.
    covered = np.ones(len(faces))
    for axis in range(2):
        place = np.clip(projected[:, axis], 0, size[axis])
        first, second, third = faces.T
        low = np.minimum(place[first], place[second])
        high = np.maximum(place[first], place[second])
        np.minimum(low, place[third], out=low)
        np.maximum(high, place[third], out=high)
        high -= low
        covered *= high
    n_pixels = covered.sum()
    if n_pixels > _MOST_WORK:
        raise ScanError(
            f"its {len(faces)} faces cover {n_pixels:.3g} pixels in sum, expected {_MOST_WORK:.3g} or less"
        )


def _projected(points: NDArray[np.float64], sensor: SensorModel) -> NDArray[np.float64]:
    """Column, row and inverse depth of points in the camera frame."""
    inverse_depth = 1.0 / points[:, 2]
    columns = sensor.focal_length * points[:, 0] * inverse_depth + sensor.center_x
    rows = sensor.focal_length * points[:, 1] * inverse_depth + sensor.center_y
    return np.column_stack([columns, rows, inverse_depth])


def put_in_front(image: DepthImage, share: float, rng: np.random.Generator) -> None:
    """Hide a share of the visible pixels behind a disc that enters the image from a random side."""
    rows, columns = np.nonzero(image.triangles != NOTHING)
    if not len(rows):
        return
    size = np.hypot(np.ptp(rows), np.ptp(columns)) + 1.0
    radius = size * rng.uniform(0.8, 3.0)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    toward = np.array([np.cos(angle), np.sin(angle)])
    grid_rows, grid_columns = np.indices(image.triangles.shape)
    offset_columns, offset_rows = grid_columns - columns.mean(), grid_rows - rows.mean()
    along = offset_columns * toward[0] + offset_rows * toward[1]
    across = offset_rows * toward[0] - offset_columns * toward[1]
    # The disc, moved in along `toward`, covers a pixel as soon as its centre is nearer than this.
    reach = along + np.sqrt(np.maximum(radius**2 - across**2, 0.0))
    hidden = reach > np.quantile(reach[rows, columns], 1.0 - share)
    nearest = image.inverse_depth.max()
    gap = rng.uniform(0.02, 0.25)
    image.inverse_depth[hidden] = 1.0 / max(1.0 / nearest - gap, _NEAREST_OCCLUDER)
    image.triangles[hidden] = OCCLUDER
