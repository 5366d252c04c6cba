"""How well groups and predictions agree with labels that the groups were made without."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.metrics import adjusted_mutual_info_score


@dataclass(frozen=True)
class GroupingScores:
    """Agreement of a grouping with labels; a group has at least two objects.

    Attributes
    ----------
    n_groups : int
    mean_purity : float
        Mean over groups of the purity (paper, equation 4), in (0, 1]. NaN without groups.
    pure_share : float
        Share of groups whose objects all have one label. NaN without groups.
    coverage : float
        Share of the objects that are in a group.
    explained : float
        Share of all objects that are in a group whose majority label is theirs.
    adjusted_mutual_information : float
        Mutual information of groups and labels, 0 for chance and 1 for equal partitions, normalised by the
        arithmetic mean of the entropies (Vinh et al. 2010).
    b_cubed_f1 : float
        Harmonic mean of B-cubed precision and recall (Bagga & Baldwin 1998), in (0, 1].
    """

    n_groups: int
    mean_purity: float
    pure_share: float
    coverage: float
    explained: float
    adjusted_mutual_information: float
    b_cubed_f1: float


def grouping_scores(groups: ArrayLike, labels: ArrayLike) -> GroupingScores:
    """Scores of a grouping.

    Parameters
    ----------
    groups : (n,) array-like of int
        Group of each object, -1 for none. An object alone in its group counts as in none.
    labels : (n,) array-like of str
        For the two scores of partitions, mutual information and B-cubed, an object in no group is a group of
        its own.

    Raises
    ------
    ValueError
        If there are no objects, the lengths differ, or a group is not an integer of at least -1.
    """
    group_of, label_of = _checked(groups, labels)
    n = len(group_of)
    counts = np.zeros((group_of.max() + 1, label_of.max() + 1), np.int64)
    np.add.at(counts, (group_of, label_of), 1)
    sizes = counts.sum(axis=1)
    majorities = counts.max(axis=1)
    is_group = sizes >= 2
    purities = majorities[is_group] / sizes[is_group]
    n_groups = len(purities)
    precision = float((counts**2 / sizes[:, None]).sum() / n)
    recall = float((counts**2 / counts.sum(axis=0)).sum() / n)
    return GroupingScores(
        n_groups=n_groups,
        mean_purity=float(purities.mean()) if n_groups else np.nan,
        pure_share=float((purities == 1).mean()) if n_groups else np.nan,
        coverage=float(sizes[is_group].sum() / n),
        explained=float(majorities[is_group].sum() / n),
        adjusted_mutual_information=float(adjusted_mutual_info_score(label_of, group_of)),
        b_cubed_f1=2 * precision * recall / (precision + recall),
    )


def purity(labels: ArrayLike) -> float:
    """Largest share of one label among the labels of a group (paper, equation 4), in (0, 1].

    Raises
    ------
    ValueError
        If there are no labels.
    """
    values = np.asarray(labels)
    if values.ndim != 1 or len(values) == 0:
        raise ValueError(f"labels must be a sequence of at least one, got shape {values.shape}")
    counts = np.unique(values, return_counts=True)[1]
    return float(counts.max() / len(values))


def rank_score(size: int, purity: float, epsilon: float = 1e-3) -> float:
    """Rank of a group, ``size / (1 - purity + epsilon)`` (paper, equation 5): larger for larger, purer ones.

    Raises
    ------
    ValueError
        If `size` is below 1, `purity` is not in (0, 1], or `epsilon` not in (0, 1).
    """
    if size < 1:
        raise ValueError(f"size must be at least 1, got {size!r}")
    if not 0 < purity <= 1:
        raise ValueError(f"purity must be above 0 and at most 1, got {purity!r}")
    if not 0 < epsilon < 1:
        raise ValueError(f"epsilon must be between 0 and 1, got {epsilon!r}")
    return size / (1 - purity + epsilon)


def mean_error_over_labels(true: ArrayLike, predicted: ArrayLike) -> tuple[dict[str, float], float]:
    """Share of wrong predictions for each true label, and the mean of these shares.

    Every label weighs the same, however many objects have it.

    Parameters
    ----------
    true, predicted : (n,) array-like of str

    Returns
    -------
    errors : dict
        Label to error in [0, 1], by sorted label.
    mean : float

    Raises
    ------
    ValueError
        If there are no objects or the lengths differ.
    """
    truth, answers = np.asarray(true), np.asarray(predicted)
    if truth.ndim != 1 or truth.shape != answers.shape or len(truth) == 0:
        raise ValueError(
            "true and predicted must be sequences of one length of at least 1, "
            f"got shapes {truth.shape} and {answers.shape}"
        )
    errors = {str(label): float((answers[truth == label] != label).mean()) for label in np.unique(truth)}
    return errors, float(np.mean(list(errors.values())))


def _checked(groups: ArrayLike, labels: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Groups and labels as indices from 0; objects in no group, or alone in theirs, get one of their own."""
    given, names = np.asarray(groups), np.asarray(labels)
    if given.ndim != 1 or given.shape != names.shape or len(given) == 0:
        raise ValueError(
            "groups and labels must be sequences of one length of at least 1, "
            f"got shapes {given.shape} and {names.shape}"
        )
    if not np.issubdtype(given.dtype, np.integer) or given.min() < -1:
        raise ValueError(f"groups must be integers of at least -1, got {given.tolist()}")
    group_of = np.unique(given, return_inverse=True)[1]
    in_none = given == -1
    group_of[in_none] = group_of.max() + 1 + np.arange(in_none.sum())
    return np.unique(group_of, return_inverse=True)[1], np.unique(names, return_inverse=True)[1]
