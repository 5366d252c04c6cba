"""The graph of nearest neighbours that some methods group."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Numbers of neighbours that are tried.
NEIGHBOUR_COUNTS = (4, 6, 8, 12, 16)


def by_nearness(distances: NDArray[np.float64]) -> NDArray[np.int64]:
    """All other objects of each object, the nearest first; (n, n - 1) int64.

    Parameters
    ----------
    distances : (n, n) float64
        At least 0.
    """
    own_first = distances + np.diag(np.full(len(distances), -1.0))
    return np.argsort(own_first, axis=1, kind="stable")[:, 1:]


def neighbours_both_ways(neighbours: NDArray[np.int64]) -> list[list[int]]:
    """Neighbours of each object in the graph that has an edge where one is among the nearest of the other.

    Parameters
    ----------
    neighbours : (n, k) int64
        The nearest of each object.
    """
    joined: list[set[int]] = [set(row.tolist()) for row in neighbours]
    for one, row in enumerate(neighbours.tolist()):
        for other in row:
            joined[other].add(one)
    return [sorted(row) for row in joined]
