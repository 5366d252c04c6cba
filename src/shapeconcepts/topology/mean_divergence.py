"""Order in which neighbouring classes of a space annex each other: by their mean divergence."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.topology.coarse_kernels import gathered
from shapeconcepts.topology.mean_divergence_kernels import mean_divergence_order
from shapeconcepts.topology.pairwise_kernels import pairwise_divergences
from shapeconcepts.topology.space import TopologicalSpace


class ClassOrder(NamedTuple):
    """Annexations by mean divergence, and the classes that each is of.

    Attributes
    ----------
    order : (e,) int64
        Edges of the tree as they enter.
    means : (e,) float64
        In this order, rising: the mean divergence between the classes at the ends of an edge, bits; of those
        that were gathered, its own.
    divergences : (m, m) float32
        Between the places that stand for all vertices: all of them, unless there are too many.
    members : (m,) int32
        Places in an order in which each class, at any time, is one stretch.
    stretches : (e, 3) int64
        In the order of entering: where in `members` the two classes begin, and where the second ends. Empty
        where both are gathered in one place.
    """

    order: NDArray[np.int64]
    means: NDArray[np.float64]
    divergences: NDArray[np.float32]
    members: NDArray[np.int32]
    stretches: NDArray[np.int64]


def mean_divergences(space: TopologicalSpace, max_vertices: int) -> ClassOrder:
    """Average linkage along the edges of a space's tree.

    Classes join along the edge between whose classes the mean divergence is smallest. Of more than
    `max_vertices` vertices, the nearest are gathered first, in small classes of about equal size, and one
    vertex of each stands for its class: the work beyond the tree does not grow with the number of objects.

    Parameters
    ----------
    space : TopologicalSpace
        Fitted.
    max_vertices : int
    """
    edges, lengths, sizes = space.edges_, space.divergences_, space.multiplicities_
    class_of, within = gathered(edges, np.argsort(lengths, kind="stable"), sizes, max_vertices)
    vertices, place_of = np.unique(class_of, return_inverse=True)
    weights = np.bincount(place_of, sizes, len(vertices)).astype(np.int64)
    inner, between = np.flatnonzero(within), np.flatnonzero(~within)
    gathered_at = np.zeros(len(vertices))
    np.maximum.at(gathered_at, place_of[edges[inner, 0]], lengths[inner])
    divergences = _pairwise(csr_matrix(space.rows_[vertices]))
    order, means, members, stretches = mean_divergence_order(
        place_of[edges[between]].astype(np.int32), divergences, weights, gathered_at
    )
    all_edges = np.concatenate([inner, between[order]])
    all_means = np.concatenate([lengths[inner], means])
    all_stretches = np.concatenate([np.zeros((len(inner), 3), np.int64), stretches])
    by_mean = np.argsort(all_means, kind="stable")
    return ClassOrder(all_edges[by_mean], all_means[by_mean], divergences, members, all_stretches[by_mean])


def _pairwise(rows: csr_matrix) -> NDArray[np.float32]:
    return pairwise_divergences(
        rows.indptr.astype(np.int64),
        rows.indices.astype(np.int32),
        rows.data,
        rows.data * np.log2(rows.data),
        rows.shape[1],
    )
