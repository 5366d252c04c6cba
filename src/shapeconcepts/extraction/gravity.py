"""Which way is up in a scene, where nothing says so."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.planar_regions import PlanarRegion

# Square metres from which on a plane counts.
_LEAST_AREA = 0.01
_PARALLEL = np.cos(np.radians(10.0))
# Of a camera that is held upright, whatever it looks down at: planes that face upwards face up in the image,
# and walls do not, unless the camera is rolled.
_UPWARDS_IN_IMAGE = np.sin(np.radians(12.0))
_STRAIGHT_DOWN = np.cos(np.radians(25.0))
_ALONG_AXIS = np.cos(np.radians(20.0))


def upward(
    regions: list[PlanarRegion], is_camera_frame: bool, known: NDArray[np.float64] | None
) -> NDArray[np.float64] | None:
    """Direction against gravity, a unit vector, or None where no plane tells.

    Planes that are parallel vote with their areas. In the frame of a camera, which is taken to be held
    upright (x to the right, y down, z forward), those that face up in the image can be horizontal, so that
    a wall that is larger than the table is not; where there are none, those that a camera sees that looks
    straight down. In other frames those across the z axis can, as robots have it upwards.

    Parameters
    ----------
    regions : list of PlanarRegion
    is_camera_frame : bool
    known : (3,) float64 or None
        Direction that is known, of which a plane can be off by some degrees.
    """
    large = [region for region in regions if region.area >= _LEAST_AREA]
    if known is not None:
        candidates = [region for region in large if region.normal @ known > _ALONG_AXIS]
        return _most_area(candidates) if candidates else known
    if not is_camera_frame:
        return _most_area([region for region in large if region.normal[2] > _ALONG_AXIS])
    upwards = [region for region in large if -region.normal[1] > _UPWARDS_IN_IMAGE]
    if not upwards:
        upwards = [region for region in large if -region.normal[2] > _STRAIGHT_DOWN]
    return _most_area(upwards)


def _most_area(regions: list[PlanarRegion]) -> NDArray[np.float64] | None:
    """Mean normal of the parallel planes that have the largest area together."""
    best, largest = None, 0.0
    for region in regions:
        parallel = [other for other in regions if other.normal @ region.normal > _PARALLEL]
        area = sum(other.area for other in parallel)
        if area > largest:
            mean = np.sum([other.area * other.normal for other in parallel], axis=0)
            best, largest = mean / np.linalg.norm(mean), area
    return best
