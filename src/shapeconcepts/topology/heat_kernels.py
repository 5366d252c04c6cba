"""Kernel of the distances within a tree whose edges all have length 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def distance_sums(edges: NDArray[np.int32], weights: NDArray[np.int64]) -> NDArray[np.int64]:
    """Sum of the distances from each vertex of a tree to all others, in two passes.

    Up the tree, every vertex learns the weight under it; down the tree, a step to a child comes nearer to
    what lies under the child by 1 and farther from everything else by 1.

    Parameters
    ----------
    edges : (n - 1, 2) int32
        A tree over the vertices 0 to n - 1.
    weights : (n,) int64
        How often each vertex counts.

    Returns
    -------
    (n,) int64
    """
    n = len(weights)
    starts = np.zeros(n + 1, np.int64)
    for e in range(len(edges)):
        starts[edges[e, 0] + 1] += 1
        starts[edges[e, 1] + 1] += 1
    for v in range(n):
        starts[v + 1] += starts[v]
    ends = starts[:-1].copy()
    neighbours = np.empty(2 * len(edges), np.int32)
    for e in range(len(edges)):
        a, b = edges[e, 0], edges[e, 1]
        neighbours[ends[a]], neighbours[ends[b]] = b, a
        ends[a] += 1
        ends[b] += 1

    parent = np.full(n, -1, np.int32)
    depth = np.zeros(n, np.int64)
    order = np.zeros(n, np.int32)
    n_seen = 1
    for k in range(n):
        v = order[k]
        for e in range(starts[v], starts[v + 1]):
            child = neighbours[e]
            if child != parent[v]:
                parent[child] = v
                depth[child] = depth[v] + 1
                order[n_seen] = child
                n_seen += 1

    weight_under = weights.copy()
    for k in range(n - 1, 0, -1):
        weight_under[parent[order[k]]] += weight_under[order[k]]
    sums = np.zeros(n, np.int64)
    total = 0
    for v in range(n):
        sums[0] += depth[v] * weights[v]
        total += weights[v]
    for k in range(1, n):
        v = order[k]
        sums[v] = sums[parent[v]] + total - 2 * weight_under[v]
    return sums
