"""Average linkage."""

from __future__ import annotations

from numpy.typing import ArrayLike
from scipy.cluster.hierarchy import cut_tree, linkage
from scipy.spatial.distance import squareform

from shapeconcepts.evaluation.groupings.grouping import (
    Grouping,
    best_candidate,
    check_choice,
    checked_distances,
    without_small_groups,
)
from shapeconcepts.parameters import check_integer


def average_linkage(
    distances: ArrayLike, max_groups: int, choice: str = "silhouette", min_size: int = 2
) -> Grouping:
    """Group objects by average linkage, cut where a criterion without labels is best.

    Clusters below `min_size` are no groups and do not count.

    Parameters
    ----------
    distances : (n, n) array-like
        Symmetric, finite, at least 0.
    max_groups : int
        At least 2.
    choice : {"silhouette", "most groups"}
        Among the cuts with at most `max_groups` groups, the one with the largest mean silhouette; or the one
        with the most groups, and of those the one that covers the most objects.
    min_size : int
        At least 1.

    Raises
    ------
    ValueError
        If the distances are unsuitable, or a parameter is unknown or out of range.
    """
    matrix = checked_distances(distances, max_groups)
    check_choice(choice)
    check_integer("min_size", min_size, 1)
    cuts = cut_tree(linkage(squareform(matrix, checks=False), "average"))
    # From one cluster to one for each object.
    groupings = (without_small_groups(cut, min_size) for cut in cuts.T[::-1])
    allowed = {n: labels for n, labels in enumerate(groupings, start=1) if labels.max() < max_groups}
    best = best_candidate(allowed, matrix, choice)
    return Grouping(allowed[best], {"clusters": best, "min_size": min_size})
