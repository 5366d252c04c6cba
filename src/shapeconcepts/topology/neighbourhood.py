"""Neighbourhoods: the objects that are nearest to each object of a topological space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.topology.inverted_index_kernels import inverted_index
from shapeconcepts.topology.neighbourhood_kernels import most_similar_rows
from shapeconcepts.topology.space import TopologicalSpace

# Fewer neighbours say too little about a class.
FEWEST_NEIGHBOURS = 36
# So that the memory for sorting stays small.
_ROWS_AT_ONCE = 2048


class Neighbourhoods(NamedTuple):
    """The K nearest others of each object, by vertex of a space.

    Attributes
    ----------
    n_neighbours : int
        K. An object has fewer where fewer have anything in common with it.
    starts : (v + 1,) int64
    nearest : (k,) int32
        Vertices with neighbours of vertex i, from ``starts[i]`` to ``starts[i + 1]``, the nearest first.
    divergences : (k,) float64
        To these, bits, below 1.
    """

    n_neighbours: int
    starts: NDArray[np.int64]
    nearest: NDArray[np.int32]
    divergences: NDArray[np.float64]

    @classmethod
    def of(cls, space: TopologicalSpace, neighbours_per_root: float) -> Neighbourhoods:
        """Neighbourhoods in a fitted space, of the size of `neighbourhood_size`.

        Vertices are taken, the nearest first and of equally near ones the first, until they hold K objects
        beside one of the vertex itself.
        """
        n = len(space.multiplicities_)
        n_neighbours = neighbourhood_size(int(space.multiplicities_.sum()), neighbours_per_root)
        matrix = (
            space.rows_.indptr.astype(np.int64),
            space.rows_.indices.astype(np.int32),
            space.rows_.data,
            space.rows_.data * np.log2(space.rows_.data),
        )
        index = inverted_index(*matrix, space.rows_.shape[1])
        # The last is for lists that end early.
        objects = np.append(space.multiplicities_, 0)
        # Memory that is not written to takes no room.
        most = min(n_neighbours, n)
        nearest, divergences = np.empty(n * most, np.int32), np.empty(n * most)
        starts = np.zeros(n + 1, np.int64)
        for first in range(0, n, _ROWS_AT_ONCE):
            last = min(first + _ROWS_AT_ONCE, n)
            rows, far = most_similar_rows(first, last, most, *matrix, *index)
            order = np.lexsort((rows, far))
            rows, far = np.take_along_axis(rows, order, axis=1), np.take_along_axis(far, order, axis=1)
            before = np.cumsum(objects[rows], axis=1) - objects[rows] + objects[first:last, None] - 1
            is_near = (before < n_neighbours) & (rows < n)
            starts[first + 1 : last + 1] = starts[first] + np.cumsum(is_near.sum(axis=1))
            nearest[starts[first] : starts[last]] = rows[is_near]
            divergences[starts[first] : starts[last]] = far[is_near]
        return cls(n_neighbours, starts, nearest[: starts[n]], divergences[: starts[n]])


def neighbourhood_size(n_objects: int, per_root: float) -> int:
    """Number of an object's neighbours: so many times sqrt(n), at least 36, at most half of all objects."""
    wanted = max(round(per_root * n_objects**0.5), FEWEST_NEIGHBOURS)
    return max(min(wanted, n_objects // 2), 1)
