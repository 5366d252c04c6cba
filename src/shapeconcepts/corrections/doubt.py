"""How sure it is where each scan belongs, by the most alike scans of each concept."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.corrections.edit import NONE
from shapeconcepts.corrections.replay import Corrected

# Neighbours of a concept that a scan's distance to it is the mean of: one may be wrong itself.
_SEVERAL = 3


class Likeness(NamedTuple):
    """The most alike other scans of each scan, as whole objects.

    Attributes
    ----------
    neighbours : (n, k) int64
        Scans, the most alike first; -1 in the row of a scan that was skipped.
    distances : (n, k) float64
        0 to 1, see `Novelty`; 1 in the row of a scan that was skipped.
    """

    neighbours: NDArray[np.int64]
    distances: NDArray[np.float64]


def doubts(corrected: Corrected, likeness: Likeness) -> NDArray[np.float64]:
    """How much nearer each scan is to another concept than to its own, (n,) float64 from 0 to 1.

    Above a half the other one is nearer. 1 for a scan in no concept; 0 where the user said where it belongs,
    and for one that was skipped.
    """
    keys = corrected.keys
    of_neighbours = np.where(likeness.neighbours >= 0, keys[likeness.neighbours], NONE)
    rows, concepts, means = _means_of_first(likeness.distances, of_neighbours)
    is_own = concepts == keys[rows]
    own, other = np.full(len(keys), np.inf), np.full(len(keys), np.inf)
    own[rows[is_own]] = means[is_own]
    np.minimum.at(other, rows[~is_own], means[~is_own])
    with np.errstate(invalid="ignore"):
        found = own / np.maximum(own + other, 1e-12)
    found[np.isinf(own)] = 1.0
    found[np.isinf(own) & np.isinf(other)] = 0.5
    found[keys == NONE] = 1.0
    found[corrected.is_certain | corrected.is_foreign | (likeness.neighbours[:, :1] < 0).all(axis=1)] = 0.0
    return found


def confident(
    corrected: Corrected, likeness: Likeness, undecided: NDArray[np.int64], rate: float
) -> NDArray[np.int64]:
    """Named concept that each undecided scan can only be in, by its key; -1 where there is none.

    A scan may be in a concept if its p-value is above the rate: the share of the concept's scans that are as
    far from the nearest other one (conformal prediction, as `Novelty`); of a concept with too few scans to
    tell such a rate, the share of all. A concept without a name is one that a scan may be in, too, unless
    the user put some of its scans into a named one: then it is known to be a mixture.

    Parameters
    ----------
    corrected : Corrected
    likeness : Likeness
    undecided : (m,) int64
        Scans that are in no named concept.
    rate : float
        0 to 1.
    """
    keys = corrected.keys
    of_neighbours = np.where(likeness.neighbours >= 0, keys[likeness.neighbours], NONE)
    to_own = _first(likeness.distances, (of_neighbours == keys[:, None]) & (of_neighbours != NONE))
    is_named = np.isin(keys, [key for key, name in corrected.names.items() if name])
    taken_out = is_named & corrected.is_certain & (keys != corrected.learned_keys)
    mixtures = set(corrected.learned_keys[taken_out].tolist())
    everywhere = np.sort(to_own[keys != NONE])
    found, n_possible = np.full(len(undecided), NONE), np.zeros(len(undecided), int)
    for key in np.unique(keys[keys != NONE]).tolist():
        has_name = bool(corrected.names.get(key))
        if not has_name and key in mixtures:
            continue
        known = np.sort(to_own[keys == key])
        if rate * (1 + len(known)) < 1:
            known = everywhere
        distances = _first(likeness.distances[undecided], of_neighbours[undecided] == key)
        n_as_far = len(known) - np.searchsorted(known, distances, side="left")
        is_possible = (1 + n_as_far) / (1 + len(known)) > rate
        n_possible += is_possible
        if has_name:
            found[is_possible] = key
    return np.where(n_possible == 1, found, NONE)


def _first(distances: NDArray[np.float64], is_there: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The first distance of each row that is there; infinite where none is."""
    if distances.shape[1] == 0:
        return np.full(len(distances), np.inf)
    at = is_there.argmax(axis=1)
    rows = np.arange(len(distances))
    return np.where(is_there[rows, at], distances[rows, at], np.inf)


def _means_of_first(
    distances: NDArray[np.float64], keys: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Mean of the first few distances of each row to each concept in it: row, key and mean of each."""
    n, k = keys.shape
    if k == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
    order = np.argsort(keys, axis=1, kind="stable")
    keys, distances = np.take_along_axis(keys, order, axis=1), np.take_along_axis(distances, order, axis=1)
    begins = np.ones((n, k), bool)
    begins[:, 1:] = keys[:, 1:] != keys[:, :-1]
    column = np.arange(k)
    rank = column - np.maximum.accumulate(np.where(begins, column, 0), axis=1)
    is_taken = (rank < _SEVERAL).ravel()
    group = np.cumsum(begins.ravel()) - 1
    sums = np.bincount(group[is_taken], distances.ravel()[is_taken])
    means = sums / np.bincount(group[is_taken])
    rows, found = np.repeat(np.arange(n), k)[begins.ravel()], keys.ravel()[begins.ravel()]
    is_concept = found != NONE
    return rows[is_concept], found[is_concept], means[is_concept]
