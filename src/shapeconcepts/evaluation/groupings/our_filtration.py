"""Our own filtration, of any rows."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import sparray, spmatrix

from shapeconcepts.concepts import Filtration
from shapeconcepts.evaluation.groupings.grouping import Grouping, best_candidate, checked_distances


def our_filtration(rows: ArrayLike | spmatrix | sparray) -> Grouping:
    """Group rows as the default preset groups stimuli: at the granularity that it chooses for these.

    Parameters
    ----------
    rows : (n, b) array-like or sparse matrix
        Non-negative. A row of zeros is in no group.

    Raises
    ------
    ValueError
        If `rows` is not a matrix of finite numbers of at least 0.
    """
    filtration = _filtered(rows)
    return Grouping(filtration.labels_.astype(np.int64), {"granularity": filtration.granularity_})


def our_filtration_by_silhouette(
    rows: ArrayLike | spmatrix | sparray, distances: ArrayLike, max_groups: int
) -> Grouping:
    """Group rows by the same filtration, at the granularity of the largest mean silhouette.

    Of rows with divergences of another scale than those of stimuli, its own choice says nothing.

    Parameters
    ----------
    rows : (n, b) array-like or sparse matrix
        Non-negative. A row of zeros is in no group.
    distances : (n, n) array-like
        Symmetric, finite, at least 0: what the silhouette is of.
    max_groups : int
        At least 2. Of cuts with more groups none is chosen, unless all have more.

    Raises
    ------
    ValueError
        If rows or distances are unsuitable, or `max_groups` is out of range.
    """
    matrix = checked_distances(distances, max_groups)
    filtration = _filtered(rows)
    # Just beyond each place where the cut changes.
    granularities = [0.0, *np.minimum(1.0001 * filtration._tree().granularities, 1.0).tolist()]
    cuts = {g: filtration.at_granularity(g).labels_.astype(np.int64) for g in granularities}
    allowed = {g: labels for g, labels in cuts.items() if labels.max() < max_groups} or cuts
    best = best_candidate(allowed, matrix, "silhouette")
    return Grouping(allowed[best], {"granularity": best})


def _filtered(rows: ArrayLike | spmatrix | sparray) -> Filtration:
    with warnings.catch_warnings():
        # No group is a result, too.
        warnings.simplefilter("ignore", UserWarning)
        return Filtration().fit(rows)
