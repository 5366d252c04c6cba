"""Kernel that enumerates the constellations of a segment graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def enumerate_constellations(
    n_segments: int, edges: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Sets of segments as bitmasks, with the motif level that first yields each.

    Parameters
    ----------
    n_segments : int
        At most 16: the kernel takes a byte for each of the ``2 ** n_segments`` sets.
    edges : (e, 2) int32
        Neighbouring segments.

    Returns
    -------
    constellations : (k,) int64
        Bit i stands for segment i. In the order of their motif level, rising within each.
    motif_levels : (k,) int32
    """
    # 0 where a set was not seen; the number of the level that yields it first otherwise.
    level_of = np.zeros(1 << n_segments, np.uint8)
    constellations = np.empty(1 << n_segments, np.int64)
    for segment in range(n_segments):
        level_of[1 << segment] = 1
    for e in range(len(edges)):
        level_of[(1 << edges[e, 0]) | (1 << edges[e, 1])] = 2
    level, start, end = 0, 0, 0
    while start < end or level < 2:
        level += 1
        start = end
        for constellation in range(1 << n_segments):
            if level_of[constellation] == level:
                constellations[end] = constellation
                end += 1
        if level == 1:
            continue
        for a in range(start, end):
            for b in range(start, a):
                union = constellations[a] | constellations[b]
                if constellations[a] & constellations[b] and level_of[union] == 0:
                    level_of[union] = level + 1
    motif_levels = np.empty(end, np.int32)
    for k in range(end):
        motif_levels[k] = level_of[constellations[k]]
    return constellations[:end].copy(), motif_levels
