"""What points of an object must be."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def checked_points(points: ArrayLike) -> NDArray[np.float64]:
    """Points as an (m, 3) float64 array.

    Raises
    ------
    ValueError
        If the shape is not (m, 3) or coordinates are not finite.
    """
    checked = np.asarray(points, np.float64)
    if checked.ndim != 2 or checked.shape[1] != 3:
        raise ValueError(f"points must have shape (m, 3), got {checked.shape}")
    if not np.isfinite(checked).all():
        raise ValueError("points must be finite, got NaN or infinity")
    return checked
