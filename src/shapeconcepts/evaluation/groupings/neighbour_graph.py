"""The graph of nearest neighbours that some methods group."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

_NEIGHBOUR_COUNTS = (4, 6, 8, 12, 16)


def neighbour_counts(n_objects: int) -> Iterator[list[int]]:
    """Numbers of neighbours to try together, then ever larger ones to try while none will do.

    Without an end: all other objects as neighbours make one group.
    """
    last = n_objects - 1
    counts = [k for k in _NEIGHBOUR_COUNTS if k <= last] or [last]
    while True:
        yield counts
        counts = [min(2 * counts[-1], last)]


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
