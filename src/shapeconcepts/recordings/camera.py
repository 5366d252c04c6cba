"""The camera of a depth image, by its CameraInfo messages."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError


class Camera(NamedTuple):
    """A pinhole camera: focal lengths, principal point and size of the image in pixels."""

    focal: tuple[float, float]
    centre: tuple[float, float]
    size: tuple[int, int]
    is_distorted: bool = False

    def points(self, depths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (h, w, 3) of depths (h, w) in the frame of the camera: x right, y down, z forward, metres.

        Raises
        ------
        ScanError
            If the image has another size than the camera's; without a name.
        """
        height, width = depths.shape
        if any(self.size) and self.size != (width, height):
            raise ScanError(
                f"is an image of {width} x {height} pixels, its CameraInfo is for "
                f"{self.size[0]} x {self.size[1]}"
            )
        points = np.empty((height, width, 3))
        with np.errstate(over="ignore", invalid="ignore"):
            np.multiply((np.arange(width) - self.centre[0]) / self.focal[0], depths, out=points[..., 0])
            rows = (np.arange(height) - self.centre[1]) / self.focal[1]
            np.multiply(rows[:, None], depths, out=points[..., 1])
        points[..., 2] = depths
        return points


def camera_of(message: Any, is_rectified: bool) -> Camera:
    """Camera of a CameraInfo message, of which the image may be a part, or binned.

    Parameters
    ----------
    message : sensor_msgs/CameraInfo
        As rosbags makes it.
    is_rectified : bool
        Whether the images are those of the camera that P describes, instead of K and D.

    Raises
    ------
    ScanError
        If it is not calibrated; without a name.
    """
    matrix = np.asarray(_of_either_case(message, "k"), dtype=np.float64).reshape(3, 3)
    distortion = np.asarray(_of_either_case(message, "d"), dtype=np.float64)
    if is_rectified:
        projection = np.asarray(_of_either_case(message, "p"), dtype=np.float64).reshape(3, 4)
        # Some drivers leave it 0.
        matrix = projection[:, :3] if projection[0, 0] > 0.0 else matrix
    focal, centre = matrix[(0, 1), (0, 1)], matrix[(0, 1), (2, 2)]
    if not (np.isfinite(matrix).all() and (focal > 0.0).all()):
        raise ScanError(
            f"is a CameraInfo that is not calibrated: focal lengths must be > 0, got {focal.tolist()}"
        )
    region = message.roi
    # 0 stands for the whole image, and for no binning.
    binning = np.maximum((message.binning_x, message.binning_y), 1)
    is_part = region.width and region.height
    size = (region.width, region.height) if is_part else (message.width, message.height)
    corner = (region.x_offset, region.y_offset) if is_part else (0, 0)
    focal, centre = focal / binning, (centre - corner) / binning
    return Camera(
        (float(focal[0]), float(focal[1])),
        (float(centre[0]), float(centre[1])),
        (int(size[0] // binning[0]), int(size[1] // binning[1])),
        bool(distortion.any()) and not is_rectified,
    )


def _of_either_case(message: Any, name: str) -> Any:
    """A field that is K in ROS 1, and k in ROS 2."""
    return getattr(message, name) if hasattr(message, name) else getattr(message, name.upper())
