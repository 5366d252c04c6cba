"""How well objects that were found in a scene agree with the true ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

MATCH = 0.75
TOUCHING = 0.01

_FIRST_OBJECT, _DECADE = 20, 10


@dataclass(frozen=True, eq=False)
class ObjectMatches:
    """Which true objects of a scene were found, and by what.

    Attributes
    ----------
    labels : (n_true,) int64
        True objects, each by the first label of its decade: 20, 30, …
    n_points : (n_true,) int64
        Points of each.
    found_by : (n_true,) int64
        Number of the predicted object that matches it, -1 for none.
    overlaps : (n_true,) float64
        Largest intersection over union with any predicted object, whether or not it matches.
    joined_in : (n_true,) int64
        Number of the predicted object that holds this object and others left together with it, -1 for none:
        its intersection over union with them all is that of a match.
    main_labels : (n_predicted,) int64
        True object of most points of each predicted object; 0 if most points are those of none.
    """

    labels: NDArray[np.int64]
    n_points: NDArray[np.int64]
    found_by: NDArray[np.int64]
    overlaps: NDArray[np.float64]
    joined_in: NDArray[np.int64]
    main_labels: NDArray[np.int64]

    @property
    def is_found(self) -> NDArray[np.bool_]:
        """Whether each true object was found, (n_true,)."""
        return self.found_by >= 0

    @property
    def is_right(self) -> NDArray[np.bool_]:
        """Whether each predicted object matches a true one, (n_predicted,)."""
        return np.isin(np.arange(len(self.main_labels)), self.found_by)


def match_objects(point_labels: ArrayLike, predicted: Sequence[ArrayLike]) -> ObjectMatches:
    """Match predicted objects and true ones, one to one, where intersection over union is 0.75 or more.

    Of all ways to match them, the one with the largest sum of intersections over unions is taken.

    Parameters
    ----------
    point_labels : array-like of int
        True label of each point of a scene: 0 for points that do not count, 1 to 9 the background, and every
        decade from 20 on one object.
    predicted : sequence of array-like of int
        Points of each predicted object, as places in the flat `point_labels`. One given twice counts once.

    Raises
    ------
    ValueError
        If a place is not one of a point.
    """
    flat = np.asarray(point_labels, dtype=np.int64).ravel()
    decades = np.where(flat >= _FIRST_OBJECT, flat // _DECADE * _DECADE, 0)
    labels, n_points = np.unique(decades[decades > 0], return_counts=True)
    shared = np.zeros((len(labels), len(predicted)), dtype=np.int64)
    sizes = np.zeros(len(predicted), dtype=np.int64)
    for number, places in enumerate(predicted):
        found = np.unique(np.asarray(places, dtype=np.int64))
        if len(found) and not (found[0] >= 0 and found[-1] < len(flat)):
            raise ValueError(
                f"predicted[{number}] must hold places from 0 to {len(flat) - 1}, "
                f"got {found[0]} to {found[-1]}"
            )
        sizes[number] = (flat[found] > 0).sum()
        shared[:, number] = (decades[found] == labels[:, None]).sum(axis=1)
    overlap = shared / np.maximum(n_points[:, None] + sizes - shared, 1)
    found_by = np.full(len(labels), -1)
    worth = np.where(overlap >= MATCH, overlap, 0.0)
    for row, column in zip(*linear_sum_assignment(worth, maximize=True), strict=True):
        if worth[row, column] > 0.0:
            found_by[row] = column
    main = np.zeros(len(predicted), dtype=np.int64)
    for number in range(len(predicted)):
        on_none = sizes[number] - shared[:, number].sum()
        if len(labels) and shared[:, number].max() > on_none:
            main[number] = labels[shared[:, number].argmax()]
    return ObjectMatches(
        labels=labels,
        n_points=n_points,
        found_by=found_by,
        overlaps=overlap.max(axis=1, initial=0.0),
        joined_in=_joined_in(shared, n_points, sizes),
        main_labels=main,
    )


def _joined_in(
    shared: NDArray[np.int64], n_points: NDArray[np.int64], sizes: NDArray[np.int64]
) -> NDArray[np.int64]:
    joined_in = np.full(len(n_points), -1)
    for number, size in enumerate(sizes):
        members = 2 * shared[:, number] > n_points
        inside = shared[members, number].sum()
        union = n_points[members].sum() + size - inside
        if members.sum() >= 2 and inside >= MATCH * union:
            joined_in[members] = number
    return joined_in


def touching_objects(points: NDArray[np.float64], point_labels: NDArray[np.int64]) -> set[int]:
    """Labels of the objects that have visible points within 1 cm of those of another object.

    Parameters
    ----------
    points : (..., 3) float64
        Metres; not finite where nothing was measured.
    point_labels : (...) int64
        As in `match_objects`.

    Returns
    -------
    set of int
        The first label of each object's decade.
    """
    points, flat = points.reshape(-1, 3), point_labels.ravel()
    is_object = (flat >= _FIRST_OBJECT) & np.isfinite(points).all(axis=1)
    points, decades = points[is_object], flat[is_object] // _DECADE * _DECADE
    labels = np.unique(decades).tolist()
    trees = {label: cKDTree(points[decades == label]) for label in labels}
    return {
        label
        for label in labels
        for other in labels
        if other != label
        and np.isfinite(trees[other].query(trees[label].data, distance_upper_bound=TOUCHING)[0]).any()
    }
