"""Decomposition of an object into constellations of segments, bottom-up."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.motifs.decomposition_kernels import enumerate_constellations

MAX_SEGMENTS = 16


class Decomposition(NamedTuple):
    """Constellations of an object's segments.

    Attributes
    ----------
    constellations : (k,) int64
        Sets of segments, each once: bit i stands for segment i. Ordered by motif level, then by value; the
        first ones are the segments themselves.
    motif_levels : (k,) int32
        The first motif level that yields each constellation, from 1.
    """

    constellations: NDArray[np.int64]
    motif_levels: NDArray[np.int32]


def decompose(segment_edges: ArrayLike, n_segments: int) -> Decomposition:
    """Decompose a segment graph (paper: Hierarchical Object Decomposition and Representation).

    Motif level 1 holds each segment alone, level 2 the two ends of each edge, and level l + 1 the unions of
    every two constellations of level l that share a segment. It ends where no two do. A constellation belongs
    to the first level that yields it.

    Parameters
    ----------
    segment_edges : (e, 2) array-like of int
        Pairs of neighbouring segments, in any order, repeated or not.
    n_segments : int
        0 to 16. The number of constellations can double with every segment: 12 segments that are all
        adjacent have 4,095.

    Returns
    -------
    Decomposition

    Raises
    ------
    ValueError
        If there are more than 16 segments, or the edges are no pairs of two different segments.
    """
    if not 0 <= n_segments <= MAX_SEGMENTS:
        raise ValueError(f"n_segments must be between 0 and {MAX_SEGMENTS}, got {n_segments!r}")
    edges = np.asarray(segment_edges)
    if edges.size == 0:
        edges = np.empty((0, 2), np.int32)
    if edges.ndim != 2 or edges.shape[1] != 2 or not np.issubdtype(edges.dtype, np.integer):
        raise ValueError(
            f"segment_edges must be integers of shape (e, 2), got {edges.dtype} of shape {edges.shape}"
        )
    if len(edges) and not (edges.min() >= 0 and edges.max() < n_segments):
        raise ValueError(f"segment_edges must name segments 0 to {n_segments - 1}, got {edges.tolist()}")
    if (edges[:, 0] == edges[:, 1]).any():
        raise ValueError(f"segment_edges must join two different segments, got {edges.tolist()}")
    return Decomposition(*enumerate_constellations(n_segments, np.ascontiguousarray(edges, np.int32)))


def segments_in(constellation: int) -> tuple[int, ...]:
    """Segments of a constellation given as a bitmask."""
    return tuple(i for i in range(int(constellation).bit_length()) if int(constellation) >> i & 1)
