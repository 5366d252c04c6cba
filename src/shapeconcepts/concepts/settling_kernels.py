"""Kernel of settling: objects move to the concept that is nearest to them, until none does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

# Of concepts that are equally near but for this, an object stays in its own, or takes the first.
_ROUNDING = 1e-12


@kernel
def settle_vertices(
    concepts: NDArray[np.int32],
    n_concepts: int,
    sizes: NDArray[np.int64],
    starts: NDArray[np.int64],
    nearest: NDArray[np.int32],
    divergences: NDArray[np.float64],
    n_nearest: int,
    min_size: int,
    max_rounds: int,
) -> NDArray[np.int32]:
    """Let all vertices move at once, round by round.

    Parameters
    ----------
    concepts : (v,) int32
        Concept of each vertex, -1 for none.
    n_concepts : int
    sizes : (v,) int64
        Objects at each vertex.
    starts, nearest, divergences
        Neighbours of each vertex, as in `Neighbourhoods`.
    n_nearest : int
        Members of a concept that an object is compared with.
    min_size : int
        A concept of fewer objects is dissolved.
    max_rounds : int

    Returns
    -------
    (v,) int32
        Concepts in the same numbers.
    """
    settled = concepts.copy()
    n_members = np.zeros(n_concepts, np.int64)
    n_found, sums = np.zeros(n_concepts, np.int64), np.zeros(n_concepts)
    for _ in range(max_rounds):
        n_members[:] = 0
        for vertex in range(len(sizes)):
            if settled[vertex] >= 0:
                n_members[settled[vertex]] += sizes[vertex]
        for vertex in range(len(sizes)):
            if settled[vertex] >= 0 and n_members[settled[vertex]] < min_size:
                settled[vertex] = -1
        before = settled.copy()
        for vertex in range(len(sizes)):
            start, end = starts[vertex], starts[vertex + 1]
            own = before[vertex]
            n_found[:] = 0
            sums[:] = 0.0
            if own >= 0:
                n_found[own] = min(sizes[vertex] - 1, n_nearest)
            for k in range(start, end):
                concept = before[nearest[k]]
                if concept >= 0:
                    n = min(sizes[nearest[k]], n_nearest - n_found[concept])
                    n_found[concept] += n
                    sums[concept] += n * divergences[k]
            # The others are at least as far as the last neighbour.
            farthest = divergences[end - 1] if end > start else 0.0
            best, least = own, np.inf
            if own >= 0 and n_found[own] > 0:
                wanted = min(n_members[own] - 1, n_nearest)
                least = (sums[own] + (wanted - n_found[own]) * farthest) / wanted
            for concept in range(n_concepts):
                if concept != own and n_found[concept] > 0:
                    wanted = min(n_members[concept], n_nearest)
                    mean = (sums[concept] + (wanted - n_found[concept]) * farthest) / wanted
                    if mean < least - _ROUNDING:
                        best, least = concept, mean
            settled[vertex] = best
        if np.array_equal(settled, before):
            break
    return settled
