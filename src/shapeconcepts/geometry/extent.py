"""How large a cloud is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def robust_extent(coordinates: NDArray[np.float64]) -> float:
    """Diagonal of the box around all but the outermost 2 % at each end, so that no far stray point counts.

    Parameters
    ----------
    coordinates : (n, 3) float64
        Finite, n >= 1.
    """
    outside = len(coordinates) // 50
    ranks = [outside, len(coordinates) - 1 - outside]
    low, high = np.partition(coordinates, ranks, axis=0)[ranks]
    return float(np.linalg.norm(high - low))
