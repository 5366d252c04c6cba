"""Groups of objects: what a part of a spanning tree's edges connects."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


class Groups(NamedTuple):
    """Connected components of the vertices of a topological space.

    Attributes
    ----------
    n_groups : int
    of_vertex : (v,) int32
        Group of each vertex; groups are numbered by their smallest vertex.
    of_object : (n,) int32
        Group of each object, -1 for one without a place.
    """

    n_groups: int
    of_vertex: NDArray[np.int32]
    of_object: NDArray[np.int32]

    @classmethod
    def connected_by(
        cls, edges: NDArray[np.int32], n_vertices: int, vertex_of_object: NDArray[np.int32]
    ) -> Groups:
        """What edges (e, 2) connect."""
        adjacency = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (n_vertices, n_vertices))
        n_groups, of_vertex = connected_components(adjacency, directed=False)
        # The last entry is for objects without a place, whose vertex is -1.
        return cls(n_groups, of_vertex, np.append(of_vertex, -1)[vertex_of_object])

    def of_size(self, smallest: int) -> NDArray[np.int64]:
        """Groups of at least so many objects, the largest first."""
        sizes = np.bincount(self.of_object[self.of_object >= 0], minlength=self.n_groups)
        largest_first = np.argsort(-sizes, kind="stable")
        return largest_first[sizes[largest_first] >= smallest]


def members_of_groups(
    group_of: NDArray[np.int32], n_groups: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Positions by group, rising within each, and where each group starts; group -1 is left out."""
    starts = np.concatenate([[0], np.cumsum(np.bincount(group_of[group_of >= 0], minlength=n_groups))])
    return np.argsort(group_of, kind="stable")[len(group_of) - starts[-1] :], starts
