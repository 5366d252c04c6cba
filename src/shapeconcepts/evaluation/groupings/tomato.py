"""ToMATo: persistence-based clustering."""

from __future__ import annotations

from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from gudhi.clustering.tomato import Tomato

# Smallest mean squared distance to the neighbours: equal rows are not infinitely dense.
_SMALLEST_SPREAD = 1e-9


def tomato(distances: ArrayLike, max_groups: int, choice: str = "silhouette") -> Grouping:
    """Group objects by ToMATo (Chazal, Guibas, Oudot, Skraba 2013) as in GUDHI.

    The graph joins every object to its k nearest. The density is the negative logarithm of their mean squared
    distance. k is chosen from 4, 6, 8, 12 and 16. If the graphs of all of these have more than `max_groups`
    components, k is raised until they fit.

    Parameters
    ----------
    distances : (n, n) array-like
        Symmetric, finite, at least 0.
    max_groups : int
        At least 2.
    choice : {"silhouette", "most groups"}
        As many groups as there are peaks of the density above the largest gap of their prominences, from 2 to
        `max_groups`, and the k with the largest mean silhouette; or the most prominent peaks, `max_groups` if
        there are as many, and the k with the most groups.

    Raises
    ------
    ValueError
        If the distances are unsuitable, or a parameter is unknown or out of range.
    """
    matrix = checked_distances(distances, max_groups)
    check_choice(choice)
    nearest_first = by_nearness(matrix)
    candidates: dict[int, NDArray[np.int64]] = {}
    for counts in neighbour_counts(len(matrix)):
        for k in counts:
            labels = _labels(matrix, nearest_first[:, :k], max_groups, choice)
            if labels.max() < max_groups:
                candidates[k] = labels
        if candidates:
            break
    best = best_candidate(candidates, matrix, choice)
    return Grouping(candidates[best], {"neighbours": best})


def _labels(
    distances: NDArray[np.float64], neighbours: NDArray[np.int64], max_groups: int, choice: str
) -> NDArray[np.int64]:
    check_libraries("gudhi")
    # It comes with an extra: without it, all other groupings work.
    from gudhi.clustering.tomato import Tomato

    spreads = (np.take_along_axis(distances, neighbours, axis=1) ** 2).mean(axis=1)
    densities = -np.log(np.maximum(spreads, _SMALLEST_SPREAD))
    clusterer = Tomato(graph_type="manual", density_type="manual")
    clusterer.fit(neighbours_both_ways(neighbours), weights=densities)
    if choice == "silhouette":
        clusterer.n_clusters_ = _number_of_peaks(clusterer, float(np.ptp(densities)), max_groups)
    else:
        clusterer.n_clusters_ = min(max_groups, clusterer.n_leaves_)
    return without_small_groups(clusterer.labels_, min_size=2)


def _number_of_peaks(clusterer: Tomato, density_range: float, max_groups: int) -> int:
    """Number of peaks above the largest gap of prominences, from 2 (or all components) to `max_groups`."""
    n_components = len(clusterer.max_weight_per_cc_)
    finite = clusterer.diagram_[:, 0] - clusterer.diagram_[:, 1] if len(clusterer.diagram_) else np.empty(0)
    # The highest peak of a component never dies; it is as prominent as the whole range of densities.
    prominences = np.concatenate([np.full(n_components, density_range), np.sort(finite)[::-1], [0.0]])
    gaps = prominences[:-1] - prominences[1:]
    fewest = max(2, n_components)
    allowed = gaps[fewest - 1 : max(max_groups, fewest)]
    return fewest + int(np.argmax(allowed)) if len(allowed) else n_components
