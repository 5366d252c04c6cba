"""Leiden: communities of a graph of nearest neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.evaluation.groupings.grouping import (
    Grouping,
    best_candidate,
    check_choice,
    checked_distances,
    without_small_groups,
)
from shapeconcepts.evaluation.groupings.neighbour_graph import (
    by_nearness,
    neighbour_counts,
    neighbours_both_ways,
)
from shapeconcepts.evaluation.libraries import check_libraries

# From a few communities of hundreds of objects to dozens.
_RESOLUTIONS = tuple((2.0 ** np.arange(-3, 6.5, 0.5)).tolist())
# As often as leidenalg goes over a graph; next to nothing moves after that.
_ITERATIONS = 2


def leiden(
    distances: ArrayLike, max_groups: int, choice: str = "silhouette", random_state: int = 0
) -> Grouping:
    """Group objects by the communities of their neighbour graph (Traag, Waltman, van Eck 2019).

    The graph joins every object to its k nearest, all edges weigh the same, and communities maximise the
    modularity at a resolution. k is chosen from 4, 6, 8, 12 and 16, the resolution from 1/8 up to the last
    before there are more than `max_groups` groups. If there are more already at the first, k is raised until
    they fit.

    Parameters
    ----------
    distances : (n, n) array-like
        Symmetric, finite, at least 0.
    max_groups : int
        At least 2.
    choice : {"silhouette", "most groups"}
        The k and resolution with the largest mean silhouette over all objects; or those with the most
        groups, and of these the ones that cover the most objects. An object alone is in no group.
    random_state : int
        Seed of the order in which objects move.

    Raises
    ------
    ValueError
        If the distances are unsuitable, or a parameter is unknown or out of range.
    ModuleNotFoundError
        If graspologic-native is not installed.
    """
    matrix = checked_distances(distances, max_groups)
    check_choice(choice)
    nearest_first = by_nearness(matrix)
    candidates: dict[tuple[int, float], NDArray[np.int64]] = {}
    for counts in neighbour_counts(len(matrix)):
        for k in counts:
            graph = neighbours_both_ways(nearest_first[:, :k])
            for resolution in _RESOLUTIONS:
                labels = without_small_groups(communities(graph, resolution, random_state), min_size=2)
                # Beyond, groups become fewer again as their objects end up alone.
                if labels.max() >= max_groups:
                    break
                candidates[k, resolution] = labels
        if candidates:
            break
    k, resolution = best_candidate(candidates, matrix, choice)
    return Grouping(candidates[k, resolution], {"neighbours": k, "resolution": resolution})


def communities(
    neighbours: Sequence[Sequence[int]], resolution: float, random_state: int = 0
) -> NDArray[np.int64]:
    """Community of each vertex of a graph, (n,) int64, by Leiden as in graspologic-native.

    Parameters
    ----------
    neighbours : sequence of sequence of int
        Of each vertex, rising; each edge stands with both of its ends, and there is at least one.
    resolution : float
        Above 0. The modularity is the share of edges within communities, less `resolution` times the share
        that is expected by the degrees alone (Reichardt & Bornholdt 2006): more is more communities.
    random_state : int
        Seed.
    """
    check_libraries("graspologic_native")
    # It comes with an extra: without it, other groupings work.
    from graspologic_native import leiden_csr

    row_ends = np.cumsum([0, *map(len, neighbours)])
    columns = np.concatenate([np.asarray(row, np.int32) for row in neighbours])
    _, community_of = leiden_csr(
        row_ends,
        columns,
        np.ones(len(columns)),
        len(neighbours),
        resolution=resolution,
        iterations=_ITERATIONS,
        seed=random_state,
    )
    return np.array([community_of[vertex] for vertex in range(len(neighbours))], np.int64)
