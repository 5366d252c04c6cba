"""A camera that looks down at a table."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.sensor_model import SensorModel

TILTS = (15.0, 60.0)
LARGEST_ROLL = 10.0
DISTANCES = (0.75, 1.5)


class Camera(NamedTuple):
    """Where a camera stands and how it is turned, in a world with x right, y ahead and z up.

    Attributes
    ----------
    position : (3,) float64
        Metres.
    axes : (3, 3) float64
        Columns are its right, down and forward.
    """

    position: NDArray[np.float64]
    axes: NDArray[np.float64]

    @property
    def up(self) -> NDArray[np.float64]:
        """Direction against gravity (3,) in the camera frame."""
        return self.axes[2].copy()

    def to_camera(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (n, 3) of the world in the camera frame."""
        return (points - self.position) @ self.axes

    def sees(self, point: NDArray[np.float64], sensor: SensorModel) -> bool:
        """Whether a point (3,) of the world lies in front of the camera and within its image."""
        x, y, z = self.to_camera(point[None])[0]
        if z <= 0.0:
            return False
        column = sensor.focal_length * x / z + sensor.center_x
        row = sensor.focal_length * y / z + sensor.center_y
        return bool(0 <= column <= sensor.width - 1 and 0 <= row <= sensor.height - 1)


def draw_camera(rng: np.random.Generator) -> Camera:
    """A camera that looks at the origin from 0.75 to 1.5 m, 15° to 60° downwards, rolled by up to 10°."""
    distance = rng.uniform(*DISTANCES)
    tilt = np.radians(rng.uniform(*TILTS))
    roll = np.radians(rng.uniform(-LARGEST_ROLL, LARGEST_ROLL))
    forward = np.array([0.0, np.cos(tilt), -np.sin(tilt)])
    right, down = np.array([1.0, 0.0, 0.0]), np.array([0.0, -np.sin(tilt), -np.cos(tilt)])
    rolled_right = np.cos(roll) * right + np.sin(roll) * down
    rolled_down = np.cos(roll) * down - np.sin(roll) * right
    return Camera(-distance * forward, np.column_stack([rolled_right, rolled_down, forward]))
