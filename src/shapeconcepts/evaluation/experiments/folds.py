"""Folds of a cross-validation with the same share of every label."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

from shapeconcepts.evaluation.splits import Split


def stratified_folds(
    labels: NDArray[np.str_], n_folds: int, random_state: int, instances: NDArray[np.str_] | None = None
) -> list[Split]:
    """Objects to learn from and objects left out, for each fold.

    Parameters
    ----------
    labels : (n,) str
        At least two of each.
    n_folds : int
        As many, or as many as the rarest label has objects or instances, but at least two.
    random_state : int
    instances : (n,) str, optional
        All objects of an instance are in one fold.
    """
    units = labels if instances is None else _labels_of_instances(labels, instances)
    n = max(2, min(n_folds, *Counter(units.tolist()).values()))
    if instances is None:
        folds = StratifiedKFold(n, shuffle=True, random_state=random_state).split(labels, labels)
    else:
        splitter = StratifiedGroupKFold(n, shuffle=True, random_state=random_state)
        folds = splitter.split(labels, labels, instances)
    return [(fitted, left_out) for fitted, left_out in folds]


def _labels_of_instances(labels: NDArray[np.str_], instances: NDArray[np.str_]) -> NDArray[np.str_]:
    """Label of each instance."""
    return labels[np.unique(instances, return_index=True)[1]]
