"""Divisive clustering by 2-means that start from the principal axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MAX_ROUNDS = 100


def split_in_two(rows: NDArray[np.float64]) -> NDArray[np.bool_] | None:
    """Split rows by 2-means, started at the plane through the mean across the principal axis.

    The result depends on no random number.

    Parameters
    ----------
    rows : (m, b) float64

    Returns
    -------
    (m,) bool or None
        Which rows lie on the far side of the axis; None where all rows are equal.
    """
    if len(rows) < 2 or np.array_equal(rows.min(axis=0), rows.max(axis=0)):
        return None
    mean = rows.mean(axis=0)
    centred = rows - mean
    axis = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    del centred
    if axis[np.abs(axis).argmax()] < 0:
        axis = -axis
    is_far = rows @ axis > mean @ axis
    for _ in range(MAX_ROUNDS):
        if is_far.all() or not is_far.any():
            return None
        near_mean, far_mean = rows[~is_far].mean(axis=0), rows[is_far].mean(axis=0)
        # On the far side of the plane midway between the means.
        nearer_to_far = rows @ (far_mean - near_mean) > (far_mean @ far_mean - near_mean @ near_mean) / 2.0
        if np.array_equal(nearer_to_far, is_far):
            break
        is_far = nearer_to_far
    return is_far


def divide(rows: NDArray[np.float64], n_levels: int) -> NDArray[np.int32]:
    """Split every cluster in two, level after level.

    Parameters
    ----------
    rows : (m, b) float64
    n_levels : int

    Returns
    -------
    (m, n_levels) int32
        Cluster of each row at each level, numbered so that the halves of a cluster follow each other. A
        cluster of equal rows stays whole.
    """
    clusters = np.empty((len(rows), n_levels), np.int32)
    members = [np.arange(len(rows))]
    for level in range(n_levels):
        halves: list[NDArray[np.int64]] = []
        for cluster in members:
            is_far = split_in_two(rows[cluster])
            halves += [cluster] if is_far is None else [cluster[~is_far], cluster[is_far]]
        for number, cluster in enumerate(halves):
            clusters[cluster, level] = number
        members = halves
    return clusters
