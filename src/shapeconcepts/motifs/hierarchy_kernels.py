"""Kernel of the edges within a motif level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def linked_vertices(
    constellations: NDArray[np.int64],
    motif_levels: NDArray[np.int32],
    segment_edges: NDArray[np.int32],
    vertices: NDArray[np.int64],
    n_vertices: int,
) -> NDArray[np.bool_]:
    """Which motif vertices an object links at some motif level.

    Parameters
    ----------
    constellations : (k,) int64
        Bitmasks in the order of their motif level, the segments first.
    motif_levels : (k,) int32
    segment_edges : (e, 2) int32
    vertices : (k,) int64
        Motif vertex of each constellation, below `n_vertices`.
    n_vertices : int

    Returns
    -------
    (n_vertices, n_vertices) bool
        Symmetric. At motif level 1 neighbouring segments link their vertices, above it every two
        constellations that share a segment.
    """
    is_linked = np.zeros((n_vertices, n_vertices), np.bool_)
    for e in range(len(segment_edges)):
        a, b = vertices[segment_edges[e, 0]], vertices[segment_edges[e, 1]]
        is_linked[a, b] = is_linked[b, a] = True
    for i in range(len(constellations)):
        if motif_levels[i] == 1:
            continue
        for j in range(i + 1, len(constellations)):
            if motif_levels[j] != motif_levels[i]:
                break
            if constellations[i] & constellations[j]:
                a, b = vertices[i], vertices[j]
                is_linked[a, b] = is_linked[b, a] = True
    return is_linked
