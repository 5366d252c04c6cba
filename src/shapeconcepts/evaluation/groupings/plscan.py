"""PLSCAN: HDBSCAN at the scale that persists."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix

from shapeconcepts.evaluation.groupings.grouping import Grouping, checked_distances, without_small_groups
from shapeconcepts.evaluation.libraries import check_libraries

# As fast_hdbscan has it.
_MIN_CLUSTER_SIZE = 5
# A sparse matrix has no entry where two objects are at 0.
_SMALLEST_DISTANCE = 1e-9


def plscan(distances: ArrayLike, max_groups: int) -> Grouping:
    """Group objects by PLSCAN (Bot, McInnes, Aerts, arXiv:2512.16558) as in fast_hdbscan.

    Of all minimum cluster sizes of HDBSCAN from 5 on, it takes those whose clusters persist the longest: what
    it chooses, it chooses by itself. If these are more than `max_groups`, the next persistent ones count; if
    all are, the size that it starts from is doubled until they fit.

    Parameters
    ----------
    distances : (n, n) array-like
        Symmetric, finite, at least 0.
    max_groups : int
        At least 2.

    Raises
    ------
    ValueError
        If the distances are unsuitable, or `max_groups` is out of range.
    ModuleNotFoundError
        If fast_hdbscan is not installed.
    """
    matrix = checked_distances(distances, max_groups)
    check_libraries("fast_hdbscan")
    # It comes with an extra: without it, other groupings work.
    from fast_hdbscan import PLSCAN

    apart = np.maximum(matrix, _SMALLEST_DISTANCE)
    np.fill_diagonal(apart, 0)
    graph = csr_matrix(apart)
    size = _MIN_CLUSTER_SIZE
    while True:
        clusterer = PLSCAN(base_min_cluster_size=size, metric="precomputed").fit(graph)
        layers = [without_small_groups(labels, min_size=2) for labels in clusterer.cluster_layers_]
        persistence = {
            number: float(value)
            for number, value in enumerate(clusterer.layer_persistence_scores_)
            if layers[number].max() < max_groups
        }
        if persistence:
            best = max(persistence, key=persistence.__getitem__)
            return Grouping(layers[best], {"layer": best + 1, "layers": len(layers)})
        size *= 2
