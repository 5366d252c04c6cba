"""Kernel that gathers the vertices of a tree in small classes, so that few of them stand for many."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.annexation_kernels import find


@kernel
def gathered(
    edges: NDArray[np.int32], shortest_first: NDArray[np.int64], sizes: NDArray[np.int64], n_most: int
) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Join vertices along short edges until there are at most so many classes.

    No class grows beyond a size, so that what is dense is not gathered more than what is rare: twice the
    mean one, or as often twice that as is needed.

    Parameters
    ----------
    edges : (e, 2) int32
        A tree.
    shortest_first : (e,) int64
        Order of its edges.
    sizes : (v,) int64
        Objects at each vertex.
    n_most : int

    Returns
    -------
    class_of : (v,) int32
        The smallest vertex of the class of each vertex.
    within : (e,) bool
        Edges within classes.
    """
    n = len(sizes)
    parents = np.arange(n).astype(np.int32)
    objects = sizes.copy()
    within = np.zeros(len(edges), np.bool_)
    n_classes = n
    largest = 2.0 * objects.sum() / n_most
    while n_classes > n_most:
        for e in shortest_first:
            if within[e]:
                continue
            a, b = find(parents, edges[e, 0]), find(parents, edges[e, 1])
            if objects[a] + objects[b] <= largest:
                if b < a:
                    a, b = b, a
                parents[b] = a
                objects[a] += objects[b]
                within[e] = True
                n_classes -= 1
                if n_classes <= n_most:
                    break
        largest *= 2.0
    class_of = np.empty(n, np.int32)
    for vertex in range(n):
        class_of[vertex] = find(parents, vertex)
    return class_of, within
