"""Mixing: whether two classes are one, by how often their objects are each other's neighbours.

Of all pairs of an object of class A and one of class B, the share in which the second is a neighbour of the
first, or the first of the second, each counting half, is compared with what it would be if the two were one
class within which neighbours are spread evenly: K / (|A| + |B| - 1) for K neighbours of each object, and 1
where the class is smaller than a neighbourhood.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.concepts.mixing_kernels import refused_edges
from shapeconcepts.topology.neighbourhood import Neighbourhoods
from shapeconcepts.topology.space import TopologicalSpace

# A class that is a smaller part of a neighbourhood has too few objects to be one of its own.
SMALL_PART = 1 / 16


def refusals(
    space: TopologicalSpace,
    order: NDArray[np.int64],
    neighbourhoods: Neighbourhoods,
    least_mixing: float,
    min_concept_size: int,
) -> NDArray[np.bool_]:
    """Which edges of a space's tree are refused when they enter in an order.

    An edge is refused where the two classes at its ends, as they are when it enters, mix by less than
    `least_mixing`: they stay apart. A class of fewer than `min_concept_size` objects, or of less than a
    sixteenth of a neighbourhood, refuses nothing and is not refused; but objects without anything in common,
    at divergence 1, are joined by no edge.

    Parameters
    ----------
    space : TopologicalSpace
        Fitted.
    order : (e,) int64
        Of its edges.
    neighbourhoods : Neighbourhoods
        Of its vertices.
    least_mixing : float
    min_concept_size : int

    Returns
    -------
    (e,) bool
        In this order.
    """
    starts, nearest = neighbourhoods.starts, neighbourhoods.nearest
    shape = (len(starts) - 1, len(starts) - 1)
    reverse = csr_matrix((np.ones(len(nearest), bool), nearest, starts), shape).tocsc()
    return refused_edges(
        space.edges_[order],
        space.divergences_[order],
        space.multiplicities_,
        starts,
        nearest,
        reverse.indptr.astype(np.int64),
        reverse.indices,
        neighbourhoods.n_neighbours,
        least_mixing,
        max(min_concept_size, SMALL_PART * neighbourhoods.n_neighbours),
    )
