"""What our groups and features are measured against: histograms of whole objects, grouped as usual."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.descriptors import describe
from shapeconcepts.evaluation.ensemble_of_shape_functions import ensemble_of_shape_functions
from shapeconcepts.evaluation.groupings import Grouping, average_linkage, hdbscan, k_means, tomato
from shapeconcepts.evaluation.groupings.grouping import CHOICES
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.topology import jensen_shannon_divergences


def baseline_rows(objects: Sequence[SegmentedObject]) -> dict[str, NDArray[np.float64]]:
    """Whole-object histograms of the same prepared points that motifs are made of.

    Parameters
    ----------
    objects : sequence of SegmentedObject
        At least one.

    Returns
    -------
    dict of name to (n, b) float64
        "mean FPFH" (33 bins), "surflet" (135) and "ESF" (640). Rows sum to 1, or are zero where an object has
        too few points.
    """
    return {
        "mean FPFH": np.stack([describe(one, "fpfh").description.whole() for one in objects]),
        "surflet": np.stack([describe(one, "surflet").description.whole() for one in objects]),
        "ESF": np.stack([ensemble_of_shape_functions(one.points) for one in objects]),
    }


def grouping_baselines(rows: ArrayLike, max_groups: int) -> dict[str, Grouping]:
    """Histograms grouped by the usual methods, each with two choices of its parameters without labels.

    The silhouette stands for groups that are apart. The most groups that are allowed stand beside it because
    the share of explained objects rises with the number of groups.

    Parameters
    ----------
    rows : (n, b) array-like
        Non-negative rows that sum to 1, at least two. k-means compares them by Hellinger's distance, the
        others by the square root of the Jensen-Shannon divergence.
    max_groups : int
        At least 2; see `most_groups`.

    Returns
    -------
    dict of name to Grouping
        Such as "k-means, silhouette" and "HDBSCAN, most groups".
    """
    divergences = jensen_shannon_divergences(rows)
    # The two triangles differ in the last bit.
    distances = np.sqrt((divergences + divergences.T) / 2)
    np.fill_diagonal(distances, 0)
    methods = {"average linkage": average_linkage, "HDBSCAN": hdbscan, "ToMATo": tomato}
    groupings = {f"k-means, {choice}": k_means(rows, max_groups, choice) for choice in CHOICES}
    for name, method in methods.items():
        for choice in CHOICES:
            groupings[f"{name}, {choice}"] = method(distances, max_groups, choice)
    return groupings
