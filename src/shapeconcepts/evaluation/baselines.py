"""What our groups and features are measured against: rows of whole objects, grouped as usual."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import sparray, spmatrix

from shapeconcepts.descriptors import DescribedObject, describe
from shapeconcepts.evaluation.ensemble_of_shape_functions import ensemble_of_shape_functions
from shapeconcepts.evaluation.groupings import (
    Grouping,
    average_linkage,
    hdbscan,
    k_means,
    leiden,
    our_filtration,
    our_filtration_by_silhouette,
    plscan,
    tomato,
)
from shapeconcepts.evaluation.groupings.grouping import CHOICES
from shapeconcepts.evaluation.point_nn import point_nn
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.topology import jensen_shannon_divergences
from shapeconcepts.topology.divergence import normalised_rows

WHOLE_OBJECT = "whole object"
STIMULI = "motif stimuli"
OUR_FILTRATION = "our filtration"

_METHODS = {"average linkage": average_linkage, "HDBSCAN": hdbscan, "ToMATo": tomato, "Leiden": leiden}


def baseline_rows(objects: Sequence[SegmentedObject]) -> dict[str, NDArray[np.float64]]:
    """Whole-object features of the same prepared points that motifs are made of.

    Parameters
    ----------
    objects : sequence of SegmentedObject
        At least one.

    Returns
    -------
    dict of name to (n, b) float64
        "mean FPFH" (33 bins), "surflet" (135), "ESF" (640) and "Point-NN" (1152). Rows are at least 0 and sum
        to 1, or are zero where an object has too few points.
    """
    return {
        "mean FPFH": whole_object_rows([describe(one, "fpfh") for one in objects]),
        "surflet": whole_object_rows([describe(one, "surflet") for one in objects]),
        "ESF": np.stack([ensemble_of_shape_functions(one.points) for one in objects]),
        "Point-NN": np.stack([point_nn(one.points) for one in objects]),
    }


def whole_object_rows(described: Sequence[DescribedObject]) -> NDArray[np.float64]:
    """Histograms of all segments together: what motifs have before any dictionary and any constellation.

    Parameters
    ----------
    described : sequence of DescribedObject
        At least one, all by the same descriptor.

    Returns
    -------
    (n, b) float64
        Rows sum to 1, or are zero where an object has too few points.
    """
    return np.stack([one.description.whole() for one in described])


def grouping_baselines(rows: ArrayLike | spmatrix | sparray, max_groups: int) -> dict[str, Grouping]:
    """Rows grouped by the usual methods, and by our filtration, all without labels.

    Most methods leave something open. It is chosen twice: the silhouette stands for groups that are apart;
    the most groups that are allowed stand beside it because the share of explained objects rises with the
    number of groups. PLSCAN chooses by itself. Our filtration
    does so, too, but for rows of stimuli; of others the silhouette says where it is cut.

    Parameters
    ----------
    rows : (n, b) array-like or sparse matrix
        Non-negative, at least two rows; only their directions count. k-means compares them by Hellinger's
        distance, the others by the square root of the Jensen-Shannon divergence.
    max_groups : int
        At least 2; see `most_groups`. Our filtration knows no limit.

    Returns
    -------
    dict of name to Grouping
        Such as "k-means, silhouette", "HDBSCAN, most groups", "PLSCAN" and "our filtration".
    """
    histograms = normalised_rows(rows, "rows")
    divergences = jensen_shannon_divergences(histograms)
    # The two triangles differ in the last bit.
    distances = np.sqrt((divergences + divergences.T) / 2)
    np.fill_diagonal(distances, 0)
    dense = histograms.toarray()
    groupings = {f"k-means, {choice}": k_means(dense, max_groups, choice) for choice in CHOICES}
    for name, method in _METHODS.items():
        for choice in CHOICES:
            groupings[f"{name}, {choice}"] = method(distances, max_groups, choice)
    groupings["PLSCAN"] = plscan(distances, max_groups)
    groupings[OUR_FILTRATION] = our_filtration(rows)
    groupings[f"{OUR_FILTRATION}, silhouette"] = our_filtration_by_silhouette(rows, distances, max_groups)
    return groupings
