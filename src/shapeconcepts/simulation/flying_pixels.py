"""Flying pixels: at depth edges, some pixels read a depth between the two surfaces, where nothing is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_EDGE = 0.03
_SHARE = 0.2
_BETWEEN = (0.15, 0.85)
_BESIDE = ((0, 1), (0, -1), (1, 0), (-1, 0))


def let_fly(
    depth: NDArray[np.float64], measured: NDArray[np.bool_], rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Move a share of the pixels at depth edges towards the other surface.

    Parameters
    ----------
    depth : (h, w) float64
        Metres; changed in place.
    measured : (h, w) bool
        Where there is a depth.
    rng : numpy.random.Generator

    Returns
    -------
    (h, w) bool
        Which pixels fly.
    """
    jump = np.zeros_like(depth)
    for shift in _BESIDE:
        beside = np.roll(depth, shift, axis=(0, 1)) - depth
        beside[~(measured & np.roll(measured, shift, axis=(0, 1)))] = 0.0
        # What comes in from the opposite side of the image.
        if shift[0]:
            beside[0 if shift[0] > 0 else -1] = 0.0
        else:
            beside[:, 0 if shift[1] > 0 else -1] = 0.0
        jump = np.where(np.abs(beside) > np.abs(jump), beside, jump)
    flying = (np.abs(jump) > _EDGE * np.maximum(depth, 1.0)) & (rng.random(depth.shape) < _SHARE)
    depth[flying] += rng.uniform(*_BETWEEN, flying.sum()) * jump[flying]
    return flying
