"""Kernel of average linkage along a tree: neighbouring classes join in the order of their mean divergence."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.annexation_kernels import find


@kernel
def mean_divergence_order(
    edges: NDArray[np.int32],
    divergences: NDArray[np.float32],
    weights: NDArray[np.int64],
    heights: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int32], NDArray[np.int64]]:
    """Let the classes at the ends of an edge join, those of the smallest mean divergence first.

    Parameters
    ----------
    edges : (e, 2) int32
        A forest.
    divergences : (v, v) float32
        Symmetric.
    weights : (v,) int64
        Objects at each vertex: in a mean, each pair of objects counts once.
    heights : (v,) float64
        When each vertex is there: 0, or the mean at which the last of its own parts joined.

    Returns
    -------
    order : (e,) int64
        Edges as they enter; of equal means the first.
    means : (e,) float64
        In this order, the mean divergence between the two classes. A class can join another that is nearer
        than its own parts were to each other; the later mean counts as the larger of both, so that no class
        joins before its parts.
    members : (v,) int32
        Vertices in an order in which each class, at any time, is one stretch.
    stretches : (e, 3) int64
        In the order of entering: where in `members` the class of more objects begins, where the other one
        does, which follows it, and where that ends.
    """
    n, n_edges = len(weights), len(edges)
    sums = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            sums[i, j] = np.float64(divergences[i, j]) * np.float64(weights[i] * weights[j])
    parents = np.arange(n).astype(np.int32)
    objects = weights.copy()
    counts = np.ones(n, np.int64)
    heights = heights.copy()
    # Members of a class, and edges that leave it: chains from its root.
    next_member, last_member = np.full(n, -1, np.int32), np.arange(n).astype(np.int32)
    next_edge, last_edge = np.full(2 * n_edges, -1, np.int64), np.full(n, -1, np.int64)
    first_edge = np.full(n, -1, np.int64)
    for half in range(2 * n_edges):
        vertex = edges[half // 2, half % 2]
        if last_edge[vertex] >= 0:
            next_edge[last_edge[vertex]] = half
        else:
            first_edge[vertex] = half
        last_edge[vertex] = half

    current = np.empty(n_edges)
    queue = [(0.0, 0)][:0]
    for e in range(n_edges):
        current[e] = divergences[edges[e, 0], edges[e, 1]]
        queue.append((current[e], e))
    heapq.heapify(queue)
    order, means = np.empty(n_edges, np.int64), np.empty(n_edges)
    roots, part_counts = np.empty((n_edges, 2), np.int32), np.empty((n_edges, 2), np.int64)
    entered = np.zeros(n_edges, np.bool_)
    k = 0
    while k < n_edges:
        mean, e = heapq.heappop(queue)
        if entered[e] or mean != current[e]:
            continue
        entered[e] = True
        a, b = find(parents, edges[e, 0]), find(parents, edges[e, 1])
        if objects[a] < objects[b] or (objects[a] == objects[b] and a > b):
            a, b = b, a
        order[k], means[k] = e, max(mean, max(heights[a], heights[b]))
        roots[k, 0], roots[k, 1], part_counts[k, 0], part_counts[k, 1] = a, b, counts[a], counts[b]
        heights[a] = means[k]
        k += 1
        parents[b] = a
        objects[a] += objects[b]
        counts[a] += counts[b]
        next_member[last_member[a]] = b
        last_member[a] = last_member[b]
        next_edge[last_edge[a]] = first_edge[b]
        last_edge[a] = last_edge[b]
        for j in range(n):
            sums[a, j] += sums[b, j]
        for j in range(n):
            sums[j, a] += sums[j, b]
        # Edges within the class drop out of its chain.
        previous, half = -1, first_edge[a]
        while half >= 0:
            following = next_edge[half]
            f = half // 2
            if entered[f]:
                if previous >= 0:
                    next_edge[previous] = following
                else:
                    first_edge[a] = following
                if following < 0:
                    last_edge[a] = previous
            else:
                other = find(parents, edges[f, 1 - half % 2])
                current[f] = sums[a, other] / np.float64(objects[a] * objects[other])
                heapq.heappush(queue, (current[f], f))
                previous = half
            half = following

    members, positions = np.empty(n, np.int32), np.empty(n, np.int64)
    position = 0
    for root in range(n):
        if parents[root] == root:
            vertex = root
            while vertex >= 0:
                members[position], positions[vertex] = vertex, position
                position += 1
                vertex = next_member[vertex]
    stretches = np.empty((n_edges, 3), np.int64)
    for k in range(n_edges):
        stretches[k, 0] = positions[roots[k, 0]]
        stretches[k, 1] = positions[roots[k, 1]]
        stretches[k, 2] = stretches[k, 1] + part_counts[k, 1]
    return order, means, members, stretches
