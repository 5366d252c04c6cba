"""Kernel of the search for the nearest visual word of each dictionary level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def nearest_words(
    rows: NDArray[np.float64], words: NDArray[np.float64], level_starts: NDArray[np.int64]
) -> NDArray[np.int32]:
    """Nearest word of each row at each level under L2, the first of equally near ones.

    Parameters
    ----------
    rows : (m, b) float64
    words : (w, b) float64
        The words of all levels, one level after the other.
    level_starts : (n + 1,) int64
        Level f holds ``words[level_starts[f]:level_starts[f + 1]]``.

    Returns
    -------
    (m, n) int32
        Number of the word within its level.
    """
    n_levels = len(level_starts) - 1
    nearest = np.empty((len(rows), n_levels), np.int32)
    for i in range(len(rows)):
        for level in range(n_levels):
            smallest = np.inf
            for w in range(level_starts[level], level_starts[level + 1]):
                squared_distance = 0.0
                for b in range(rows.shape[1]):
                    squared_distance += (rows[i, b] - words[w, b]) ** 2
                if squared_distance < smallest:
                    smallest = squared_distance
                    nearest[i, level] = w - level_starts[level]
    return nearest
