"""Settling: what is at the border of a concept moves to the one that is nearest to it.

A tree joins an object to its class along a single edge, and annexes all that hangs behind it. So some objects
are among members of another concept. Each object moves to the concept whose n nearest members, or all where
it has fewer, are nearest on average; all at once, again and again, until none moves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.settling_kernels import settle_vertices
from shapeconcepts.topology.neighbourhood import Neighbourhoods

# Nearly always there are fewer than ten; objects that change places for ever are stopped.
MAX_ROUNDS = 50


def settled(
    concepts: NDArray[np.int32],
    sizes: NDArray[np.int64],
    neighbourhoods: Neighbourhoods,
    n_nearest: int,
    min_concept_size: int,
) -> NDArray[np.int32]:
    """Concepts of vertices after objects have settled.

    Members beyond an object's neighbourhood count as if they were at its end. An object in no concept joins
    one if it has a neighbour in any. A concept that becomes too small is dissolved.

    Parameters
    ----------
    concepts : (v,) int32
        Number of the concept of each vertex of a space, -1 for none.
    sizes : (v,) int64
        Objects at each vertex.
    neighbourhoods : Neighbourhoods
    n_nearest : int
        Members that an object is compared with: one may be odd, and all of them say little about a large
        concept's rim.
    min_concept_size : int

    Returns
    -------
    (v,) int32
        In the same numbers, some of which may no longer occur.
    """
    n_concepts = int(concepts.max(initial=-1)) + 1
    if n_concepts == 0:
        return concepts
    moved = settle_vertices(
        concepts, n_concepts, sizes, *neighbourhoods[1:], n_nearest, min_concept_size, MAX_ROUNDS
    )
    n_members = np.bincount(moved[moved >= 0], sizes[moved >= 0], n_concepts)
    return np.where((moved >= 0) & (n_members[moved] >= min_concept_size), moved, np.int32(-1))
