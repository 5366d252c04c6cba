"""What a Kinect-like sensor does to depth: noise, quantisation, lost points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_STEEPEST_NOISE_ANGLE = np.radians(82.0)


@dataclass(frozen=True)
class SensorModel:
    """A structured-light depth camera; the defaults describe the first Kinect.

    Parameters
    ----------
    width, height : int
        Size of the depth image, pixels.
    focal_length : float
        Focal length, pixels.
    center_x, center_y : float
        Principal point, pixels; the centre of pixel (0, 0) has the coordinates (0, 0).
    baseline : float
        Distance from the camera to the pattern projector on its right, metres [1]_.
    infrared_focal_length : float
        Focal length of the infrared camera that matches the pattern, pixels [1]_. Its depth image is
        resampled to the image described above.
    disparity_step : float
        Resolution of the pattern matching, pixels of the infrared camera [1]_.
    lateral_noise : float
        Standard deviation of the position in the image, pixels: 0.8 facing the sensor, more at an angle [2]_.
    grazing_limit : float
        Angle between surface normal and line of sight beyond which half of the points are lost, degrees.
    edge_loss : float
        Share of the points that would be lost where no neighbouring pixel continues the surface.
    speckle_loss : float
        Share of the points that are lost in specks all over the surface.

    References
    ----------
    .. [1] K. Khoshelham, S. Oude Elberink, "Accuracy and Resolution of Kinect Depth Data for Indoor
       Mapping Applications", Sensors 12(2), 2012.
    .. [2] C. V. Nguyen, S. Izadi, D. Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
       Tracking", 3DIMPVT 2012.
    """

    width: int = 640
    height: int = 480
    focal_length: float = 525.0
    center_x: float = 319.5
    center_y: float = 239.5
    baseline: float = 0.075
    infrared_focal_length: float = 580.0
    disparity_step: float = 0.125
    lateral_noise: float = 0.85
    grazing_limit: float = 78.0
    edge_loss: float = 0.8
    speckle_loss: float = 0.003

    def axial_noise(self, depth: NDArray, angle: NDArray) -> NDArray[np.float64]:
        """Standard deviation of the depth in metres (Nguyen et al. 2012, equation 3).

        Parameters
        ----------
        depth : array
            Metres.
        angle : array
            Between surface normal and line of sight, radians.
        """
        angle = np.minimum(angle, _STEEPEST_NOISE_ANGLE)
        facing = 0.0012 + 0.0019 * (depth - 0.4) ** 2
        return facing + 0.0001 / np.sqrt(depth) * (angle / (np.pi / 2 - angle)) ** 2

    def quantise(self, depth: NDArray) -> NDArray[np.float64]:
        """Depth, metres, rounded to whole steps of disparity, which are about `2.9 mm * depth²` apart."""
        depth_times_steps = self.infrared_focal_length * self.baseline / self.disparity_step
        return depth_times_steps / np.maximum(np.rint(depth_times_steps / depth), 1.0)

    def grazing_loss(self, angle: NDArray) -> NDArray[np.float64]:
        """Share of the points lost at an angle, radians, between surface normal and line of sight."""
        return 1.0 / (1.0 + np.exp((self.grazing_limit - np.degrees(angle)) / 2.0))
