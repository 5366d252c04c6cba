"""What the sensor reads where there is an exact depth image."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from shapeconcepts.simulation.rendering import DepthImage
from shapeconcepts.simulation.sensor_kernels import NOTHING, continuity, lit_by_projector
from shapeconcepts.simulation.sensor_model import SensorModel

_SAME_SURFACE = 0.02


def measure(
    image: DepthImage,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    sensor: SensorModel,
    rng: np.random.Generator,
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Triangle (negative: none) and depth that the sensor reads at each pixel of an exact depth image."""
    shape = image.triangles.shape
    axial, down, right, luck = _correlated_noise(rng, 4, shape)
    lit = lit_by_projector(sensor.focal_length * sensor.baseline * image.inverse_depth)
    edge_loss = sensor.edge_loss * (1.0 - continuity(image.inverse_depth, _SAME_SURFACE))

    grid_rows, grid_columns = np.indices(shape)
    rows = np.clip(np.rint(grid_rows + sensor.lateral_noise * down).astype(int), 0, shape[0] - 1)
    columns = np.clip(np.rint(grid_columns + sensor.lateral_noise * right).astype(int), 0, shape[1] - 1)
    triangles = image.triangles[rows, columns]
    hit = (triangles >= 0) & lit[rows, columns]

    exact, angle = _surface(image, vertices[faces[triangles[hit]]], hit, sensor)
    kept_share = (
        (1.0 - edge_loss[rows, columns][hit])
        * (1.0 - sensor.grazing_loss(angle))
        * (1.0 - sensor.speckle_loss)
    )
    kept = luck[hit] < ndtri(kept_share)
    depth = np.zeros(shape)
    depth[hit] = sensor.quantise(exact + sensor.axial_noise(exact, angle) * axial[hit])
    hit[hit] = kept
    return np.where(hit, triangles, NOTHING), depth


def _surface(
    image: DepthImage, corners: NDArray[np.float64], where: NDArray[np.bool_], sensor: SensorModel
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Depth and angle of incidence where the lines of sight of some pixels meet one triangle's plane each.

    A plane is not followed beyond the depths of its triangle.
    """
    rows, columns = np.nonzero(where)
    sight = np.column_stack(
        [
            (columns + image.column - sensor.center_x) / sensor.focal_length,
            (rows + image.row - sensor.center_y) / sensor.focal_length,
            np.ones(len(rows)),
        ]
    )
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across = np.einsum("ij,ij->i", normals, sight)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.einsum("ij,ij->i", normals, corners[:, 0]) / across
    nearest, farthest = corners[:, :, 2].min(axis=1), corners[:, :, 2].max(axis=1)
    depth = np.clip(np.nan_to_num(depth, nan=np.inf), nearest, farthest)
    cosine = np.abs(across) / (np.linalg.norm(normals, axis=1) * np.linalg.norm(sight, axis=1))
    return depth, np.arccos(np.minimum(cosine, 1.0))


def _correlated_noise(rng: np.random.Generator, n_fields: int, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Standard normal images that neighbouring pixels share, since the sensor matches windows, not pixels."""
    white = rng.standard_normal((n_fields, shape[0] + 2, shape[1] + 2))
    mixed = white[:, :-2] + 2.0 * white[:, 1:-1] + white[:, 2:]
    return (mixed[:, :, :-2] + 2.0 * mixed[:, :, 1:-1] + mixed[:, :, 2:]) / 6.0
