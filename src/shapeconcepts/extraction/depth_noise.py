"""How far from a surface a depth camera measures, by distance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def depth_noise(distance: float) -> float:
    """Standard deviation of a depth in metres, of depth cameras that triangulate.

    Noise across a facing surface (Nguyen et al. 2012, equation 3), and the rounding of a first Kinect's
    disparity (Khoshelham & Oude Elberink 2012), 2.9 mm at 1 m, as if it were spread evenly.

    Parameters
    ----------
    distance : float
        Metres.
    """
    facing = 0.0012 + 0.0019 * (distance - 0.4) ** 2
    rounding = 0.00087 * distance**2
    return math.sqrt(facing * facing + rounding * rounding)


@kernel
def depth_noises(distances: NDArray[np.float32], times: float) -> NDArray[np.float32]:
    """Times the noise at each distance, (h, w) float32; NaN where there is none."""
    noises = np.empty(distances.shape, np.float32)
    for i in range(distances.shape[0]):
        for j in range(distances.shape[1]):
            noises[i, j] = times * depth_noise(distances[i, j])
    return noises
