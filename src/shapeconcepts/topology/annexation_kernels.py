"""Kernel of the filtration: classes that annex each other, edge by edge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def find(parents: NDArray[np.int32], vertex: int) -> int:
    """Root of a vertex in a union-find forest, halving the path on the way."""
    while parents[vertex] != vertex:
        parents[vertex] = parents[parents[vertex]]
        vertex = parents[vertex]
    return vertex


@kernel
def annex(
    edges: NDArray[np.int32], sizes: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64], NDArray[np.int64]]:
    """Join classes along edges: the one with fewer members dies, or the later one of equals.

    Parameters
    ----------
    edges : (e, 2) int32
        Edges of a forest in the order of their time.
    sizes : (v,) int64
        Members of the class of each vertex at the start.

    Returns
    -------
    dying, surviving : (e,) int32
        Representatives: each class keeps the vertex that it started with.
    dying_sizes, surviving_sizes : (e,) int64
        Members just before.
    """
    parents = np.arange(len(sizes)).astype(np.int32)
    members = sizes.copy()
    n = len(edges)
    dying, surviving = np.empty(n, np.int32), np.empty(n, np.int32)
    dying_sizes, surviving_sizes = np.empty(n, np.int64), np.empty(n, np.int64)
    for e in range(n):
        a, b = find(parents, edges[e, 0]), find(parents, edges[e, 1])
        if members[a] < members[b] or (members[a] == members[b] and a > b):
            a, b = b, a
        surviving[e], dying[e] = a, b
        surviving_sizes[e], dying_sizes[e] = members[a], members[b]
        parents[b] = a
        members[a] += members[b]
    return dying, surviving, dying_sizes, surviving_sizes
