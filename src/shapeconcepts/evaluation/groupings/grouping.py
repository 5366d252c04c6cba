"""A grouping, the limit on its number of groups, and the criterion by which its parameters are chosen."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.metrics import silhouette_samples

from shapeconcepts.parameters import check_integer

MOST_GROUPS = 36
OBJECTS_PER_GROUP = 8
# How the number of groups is chosen where a method leaves it open.
CHOICES = ("silhouette", "most groups")

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, eq=False)
class Grouping:
    """Groups of objects.

    Attributes
    ----------
    labels : (n,) int64
        Group of each object, from 0, -1 for none.
    parameters : dict
        What was chosen, by name.
    """

    labels: NDArray[np.int64]
    parameters: dict[str, object] = field(default_factory=dict)

    @property
    def n_groups(self) -> int:
        """Number of groups."""
        return int(self.labels.max(initial=-1)) + 1


def most_groups(n_objects: int) -> int:
    """The most groups that a grouping may have: one for eight objects, from 2 to the paper's 36."""
    return max(2, min(MOST_GROUPS, n_objects // OBJECTS_PER_GROUP))


def without_small_groups(labels: ArrayLike, min_size: int) -> NDArray[np.int64]:
    """Number the groups of at least `min_size` objects from 0 in their order; all others become -1."""
    given = np.asarray(labels)
    names, group_of, counts = np.unique(given, return_inverse=True, return_counts=True)
    is_kept = (counts >= min_size) & (names >= 0)
    return np.where(is_kept, np.cumsum(is_kept) - 1, -1)[group_of].astype(np.int64)


def mean_silhouette(distances: NDArray[np.float64], labels: NDArray[np.int64]) -> float:
    """Mean over all objects of how much nearer their own group is than the next one (Rousseeuw 1987).

    Parameters
    ----------
    distances : (n, n) float64
    labels : (n,) int64
        An object in no group counts 0, as one alone in its group does.

    Returns
    -------
    float
        From -1 to 1; -1 with fewer than two groups.
    """
    grouped = np.flatnonzero(labels >= 0)
    n_groups = len(np.unique(labels[grouped]))
    if n_groups < 2:
        return -1.0
    if n_groups == len(grouped):
        return 0.0
    samples = silhouette_samples(distances[np.ix_(grouped, grouped)], labels[grouped], metric="precomputed")
    return float(samples.sum() / len(labels))


def best_candidate(
    candidates: Mapping[Key, NDArray[np.int64]], distances: NDArray[np.float64], choice: str
) -> Key:
    """Key of the labels that are best by a criterion of `CHOICES`, the first of equal ones.

    These are the largest mean silhouette; or the most groups, and of those the most objects in groups.
    """
    if choice == "silhouette":
        return max(candidates, key=lambda one: mean_silhouette(distances, candidates[one]))
    return max(candidates, key=lambda one: (candidates[one].max(), np.count_nonzero(candidates[one] >= 0)))


def checked_distances(distances: ArrayLike, max_groups: int) -> NDArray[np.float64]:
    """Distances as (n, n) float64, with an exact diagonal.

    Raises
    ------
    ValueError
        If they are not square, not symmetric or not finite numbers of at least 0, there are fewer than two
        objects, or `max_groups` is below 2.
    """
    check_integer("max_groups", max_groups, 2)
    matrix = np.array(distances, np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or len(matrix) < 2:
        raise ValueError(f"distances must be a square matrix of at least 2 rows, got shape {matrix.shape}")
    if not (np.isfinite(matrix).all() and matrix.min() >= 0 and np.allclose(matrix, matrix.T)):
        raise ValueError("distances must be finite, at least 0 and symmetric, got others")
    np.fill_diagonal(matrix, 0)
    return matrix


def check_choice(choice: str) -> None:
    """Raise a ValueError if `choice` is none of `CHOICES`."""
    if choice not in CHOICES:
        raise ValueError(f"choice must be one of {', '.join(map(repr, CHOICES))}, got {choice!r}")
