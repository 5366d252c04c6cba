"""Kernel of refusal: classes that do not mix stay apart, whatever edge would join them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.annexation_kernels import find

# What mixes just enough is not refused by rounding.
_LESS = 1 - 1e-12


@kernel
def refused_edges(
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
    sizes: NDArray[np.int64],
    starts: NDArray[np.int64],
    nearest: NDArray[np.int32],
    reverse_starts: NDArray[np.int64],
    reverse: NDArray[np.int32],
    n_neighbours: int,
    least_mixing: float,
    least_size: float,
) -> NDArray[np.bool_]:
    """Let edges join classes one after the other, but for those that mix too little.

    Parameters
    ----------
    edges : (e, 2) int32
        A forest, in the order in which edges enter.
    lengths : (e,) float64
        Their divergences. An edge between objects that have nothing in common, at 1, is refused in any case.
    sizes : (v,) int64
        Objects at each vertex.
    starts : (v + 1,) int64
    nearest : (k,) int32
        Neighbours of each vertex, as in `Neighbourhoods`.
    reverse_starts : (v + 1,) int64
    reverse : (k,) int32
        In the same form, of whom each vertex is a neighbour.
    n_neighbours : int
        Objects in a neighbourhood.
    least_mixing : float
    least_size : float
        A class of fewer objects refuses nothing and is not refused.

    Returns
    -------
    (e,) bool
        The edges that are refused: the classes at their ends at that time stay apart.
    """
    parents = np.arange(len(sizes)).astype(np.int32)
    objects = sizes.copy()
    # Members of a class: a chain from its root.
    following = np.full(len(sizes), -1, np.int32)
    last = np.arange(len(sizes)).astype(np.int32)
    refused = np.zeros(len(edges), np.bool_)
    for e in range(len(edges)):
        a, b = find(parents, edges[e, 0]), find(parents, edges[e, 1])
        if objects[a] < objects[b]:
            a, b = b, a
        if lengths[e] >= 1.0:
            refused[e] = True
        elif objects[b] >= least_size:
            links, member = 0, b
            while member >= 0:
                links += sizes[member] * (
                    _objects_in(a, nearest[starts[member] : starts[member + 1]], parents, sizes)
                    + _objects_in(
                        a, reverse[reverse_starts[member] : reverse_starts[member + 1]], parents, sizes
                    )
                )
                member = following[member]
            share = 0.5 * float(links) / (float(objects[a]) * float(objects[b]))
            as_one = min(1.0, n_neighbours / (objects[a] + objects[b] - 1))
            refused[e] = share < least_mixing * as_one * _LESS
        if not refused[e]:
            parents[b] = a
            objects[a] += objects[b]
            following[last[a]] = b
            last[a] = last[b]
    return refused


@kernel
def _objects_in(
    root: int,
    vertices: NDArray[np.int32],
    parents: NDArray[np.int32],
    sizes: NDArray[np.int64],
) -> int:
    """Objects at those of some vertices that are in a class."""
    n = 0
    for vertex in vertices:
        if find(parents, vertex) == root:
            n += sizes[vertex]
    return n
