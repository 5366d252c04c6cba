"""HDBSCAN."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.cluster import HDBSCAN

from shapeconcepts.evaluation.groupings.grouping import (
    Grouping,
    best_candidate,
    check_choice,
    checked_distances,
    without_small_groups,
)

_MIN_CLUSTER_SIZES = range(3, 9)


def hdbscan(distances: ArrayLike, max_groups: int, choice: str = "silhouette") -> Grouping:
    """Group objects by HDBSCAN (Campello, Moulavi, Sander 2013) as in scikit-learn, excess of mass.

    The minimum cluster size is chosen from 3 to 8. If all of these give too many groups, it is raised until
    they fit.

    Parameters
    ----------
    distances : (n, n) array-like
        Symmetric, finite, at least 0.
    max_groups : int
        At least 2.
    choice : {"silhouette", "most groups"}
        The size with the largest mean silhouette over all objects, where one in no group counts 0; or the one
        with the most groups, and of those the one that covers the most objects.

    Raises
    ------
    ValueError
        If the distances are unsuitable, or a parameter is unknown or out of range.
    """
    matrix = checked_distances(distances, max_groups)
    check_choice(choice)
    candidates: dict[int, NDArray[np.int64]] = {}
    for size in range(min(_MIN_CLUSTER_SIZES.start, len(matrix)), len(matrix) + 1):
        if size >= _MIN_CLUSTER_SIZES.stop and candidates:
            break
        labels = _labels(matrix, size)
        if labels.max() < max_groups:
            candidates[size] = labels
    best = best_candidate(candidates, matrix, choice)
    return Grouping(candidates[best], {"min_cluster_size": best})


def _labels(distances: NDArray[np.float64], min_cluster_size: int) -> NDArray[np.int64]:
    clusterer = HDBSCAN(min_cluster_size=min_cluster_size, metric="precomputed", copy=True)
    return without_small_groups(clusterer.fit_predict(distances), min_size=2)
