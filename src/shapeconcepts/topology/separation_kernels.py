"""Kernels of Ward's criterion on a tree: the order in which classes annex each other by their separation.

A class of many members grows with nearly every annexation, and with it grow the separations along all of its
edges. Brought up to date each time, the edges of a star would take quadratic time. So an edge *waits* behind
another one of its class that is not longer and does not lead to more members: it cannot enter earlier,
whatever becomes of the class that they share. The waiting edges form a pairing heap for each edge in the
queue.
"""

from __future__ import annotations

import heapq
import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.topology.annexation_kernels import find

# By how much lengths differ at least so that rounding makes no equal separations of them.
_LONGER = 1 + 1e-12


@kernel
def separation_order(
    edges: NDArray[np.int32], lengths: NDArray[np.float64], sizes: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Order in which classes annex each other, the least separated ones first.

    The separation of two classes of a and b members along an edge of length d is ``d sqrt(a b / (a + b))``.
    Classes only grow, and so do separations: an edge whose separation has grown since it was queued goes back
    into the queue, or waits.

    Parameters
    ----------
    edges : (e, 2) int32
        A forest.
    lengths : (e,) float64
    sizes : (v,) int64
        Members of the class of each vertex at the start.

    Returns
    -------
    order : (e,) int64
        Edges as they enter; of equally separated ones the first.
    separations : (e,) float64
        In this order, rising.
    """
    n_edges = len(edges)
    parents = np.arange(len(sizes)).astype(np.int32)
    members = sizes.copy()
    # The end of an edge in the class that it shares with those behind it, and the members beyond the other.
    shared = edges[:, 0].copy()
    beyond = np.zeros(n_edges, np.int64)
    first_waiting, next_waiting = np.full(n_edges, -1, np.int32), np.full(n_edges, -1, np.int32)
    # An edge of each class, behind which others wait.
    front = np.full(len(sizes), -1, np.int32)
    is_queued = np.ones(n_edges, np.bool_)
    # At first in sorted order, which costs less than a heap; those that come back are in the heap.
    at_start = np.empty(n_edges)
    for e in range(n_edges):
        at_start[e] = _separation(lengths[e], sizes[edges[e, 0]], sizes[edges[e, 1]])
    by_start = np.argsort(at_start, kind="mergesort")
    n_started = 0
    queue = [(0.0, 0)][:0]
    order, separations = np.empty(n_edges, np.int64), np.empty(n_edges)
    n = 0
    while n < n_edges:
        e = by_start[min(n_started, n_edges - 1)]
        queued = at_start[e]
        if n_started == n_edges or (len(queue) > 0 and queue[0] < (queued, e)):
            queued, e = heapq.heappop(queue)
        else:
            n_started += 1
        larger, smaller = find(parents, edges[e, 0]), find(parents, edges[e, 1])
        end = edges[e, 0]
        if members[larger] < members[smaller]:
            larger, smaller, end = smaller, larger, edges[e, 1]
        separation = _separation(lengths[e], members[larger], members[smaller])
        enters = separation <= queued
        if first_waiting[e] >= 0 and (
            enters or beyond[e] != members[smaller] or find(parents, shared[e]) != larger
        ):
            waiting = _successors(
                e, edges, lengths, parents, members, shared, beyond, first_waiting, next_waiting
            )
        else:
            waiting = [0][:0]
        if enters:
            is_queued[e] = False
            order[n], separations[n] = e, separation
            n += 1
            parents[smaller] = larger
            members[larger] += members[smaller]
        else:
            shared[e], beyond[e] = end, members[smaller]
            f = front[larger]
            if (
                f >= 0
                and f != e
                and is_queued[f]
                and find(parents, shared[f]) == larger
                and _precedes(f, e, lengths, beyond)
            ):
                is_queued[e] = False
                next_waiting[e] = first_waiting[f]
                first_waiting[f] = e
            else:
                heapq.heappush(queue, (separation, e))
                front[larger] = e
        for w in waiting:
            is_queued[w] = True
            a, b = find(parents, edges[w, 0]), find(parents, edges[w, 1])
            heapq.heappush(queue, (_separation(lengths[w], members[a], members[b]), w))
    return order, separations


@kernel
def _separation(length: float, a: int, b: int) -> float:
    # The quotient rounds once, so that rounding keeps separations rising with a and b.
    return length * math.sqrt(float(a) * float(b) / float(a + b))


@kernel
def _precedes(e: int, f: int, lengths: NDArray[np.float64], beyond: NDArray[np.int64]) -> bool:
    """Whether the first of two edges of a class never enters after the second."""
    return (
        lengths[e] <= lengths[f]
        and beyond[e] <= beyond[f]
        and (e < f or beyond[e] < beyond[f] or lengths[e] * _LONGER < lengths[f])
    )


@kernel
def _other_end(e: int, edges: NDArray[np.int32], end: int) -> int:
    return edges[e, 1] if edges[e, 0] == end else edges[e, 0]


@kernel
def _successors(
    e: int,
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
    parents: NDArray[np.int32],
    members: NDArray[np.int64],
    shared: NDArray[np.int32],
    beyond: NDArray[np.int64],
    first_waiting: NDArray[np.int32],
    next_waiting: NDArray[np.int32],
) -> list[int]:
    """Release the edges that wait behind one: some wait behind each other again, the others are returned."""
    successors = [0][:0]
    pairs = [0][:0]
    released = [first_waiting[e]]
    first_waiting[e] = -1
    held = -1
    while released:
        w = released.pop()
        while w >= 0:
            following = next_waiting[w]
            next_waiting[w] = -1
            now = members[find(parents, _other_end(w, edges, shared[w]))]
            if beyond[w] != now and first_waiting[w] >= 0:
                released.append(first_waiting[w])
                first_waiting[w] = -1
            beyond[w] = now
            if held < 0:
                held = w
            else:
                first, second = _joined(held, w, lengths, beyond, first_waiting, next_waiting)
                pairs.append(first)
                if second >= 0:
                    successors.append(second)
                held = -1
            w = following
    if held >= 0:
        pairs.append(held)
    last = pairs.pop()
    while pairs:
        last, second = _joined(pairs.pop(), last, lengths, beyond, first_waiting, next_waiting)
        if second >= 0:
            successors.append(second)
    successors.append(last)
    return successors


@kernel
def _joined(
    e: int,
    f: int,
    lengths: NDArray[np.float64],
    beyond: NDArray[np.int64],
    first_waiting: NDArray[np.int32],
    next_waiting: NDArray[np.int32],
) -> tuple[int, int]:
    """Let one of two edges of a class wait behind the other: that one, and -1; or both, if neither can."""
    if not _precedes(e, f, lengths, beyond):
        e, f = f, e
        if not _precedes(e, f, lengths, beyond):
            return e, f
    next_waiting[f] = first_waiting[e]
    first_waiting[e] = f
    return e, -1
