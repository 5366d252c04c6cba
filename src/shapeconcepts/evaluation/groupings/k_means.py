"""k-means on histograms."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.distance import pdist, squareform
from sklearn.cluster import KMeans

from shapeconcepts.evaluation.groupings.grouping import (
    Grouping,
    check_choice,
    mean_silhouette,
    without_small_groups,
)
from shapeconcepts.parallel import libraries_in_one_thread
from shapeconcepts.parameters import check_integer

_STARTS = 10


def k_means(rows: ArrayLike, max_groups: int, choice: str = "silhouette", random_state: int = 0) -> Grouping:
    """Group histograms by k-means (Lloyd, the best of ten k-means++ starts) in Hellinger's space.

    Parameters
    ----------
    rows : (n, b) array-like
        Non-negative rows that sum to 1. Square roots are taken: their Euclidean distance is Hellinger's.
    max_groups : int
        At least 2.
    choice : {"silhouette", "most groups"}
        The number of clusters with the largest mean silhouette, from 2 to `max_groups`; or `max_groups`. An
        object alone in its cluster is in no group.
    random_state : int
        Seed of the starts.

    Raises
    ------
    ValueError
        If `rows` is not a matrix of at least two rows of finite numbers of at least 0, or a parameter is
        unknown or out of range.
    """
    check_integer("max_groups", max_groups, 2)
    check_choice(choice)
    histograms = np.asarray(rows, np.float64)
    if histograms.ndim != 2 or len(histograms) < 2:
        raise ValueError(f"rows must be a matrix of at least 2 rows, got shape {histograms.shape}")
    if not (np.isfinite(histograms).all() and histograms.min(initial=0) >= 0):
        raise ValueError("rows must hold finite numbers of at least 0, got others")
    points = np.sqrt(histograms)
    # k-means cannot make more groups than there are different rows.
    most = min(max_groups, len(np.unique(points, axis=0)))
    if most < 2:
        return Grouping(np.zeros(len(points), np.int64), {"clusters": 1})
    candidates = range(2, most + 1) if choice == "silhouette" else [most]
    with libraries_in_one_thread():
        if points.shape[1] > len(points):
            # Distances are all that counts, and in the span of the rows they are the same.
            axes, lengths, _ = np.linalg.svd(points, full_matrices=False)
            points = axes * lengths
        clusterings = {
            k: KMeans(k, n_init=_STARTS, random_state=random_state).fit_predict(points) for k in candidates
        }
    distances = squareform(pdist(points))
    best = max(clusterings, key=lambda k: mean_silhouette(distances, clusterings[k]))
    return Grouping(without_small_groups(clusterings[best], min_size=2), {"clusters": best})
