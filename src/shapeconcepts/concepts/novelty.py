"""How likely a scan is one of something known: p-values that the training scans themselves calibrate."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.prototype_kernels import hellinger_divergences
from shapeconcepts.motifs.thinning import draws
from shapeconcepts.parallel import map_in_order

# More training scans are represented by a sample, so that a response does not become slower with them.
MOST_COMPARED = 4096
# So many members tell apart a rate of one in a hundred.
LEAST_MEMBERS = 99
_AT_ONCE = 64


class Novelty:
    """Calibrated novelty (Vovk et al., Algorithmic Learning in a Random World; Bates et al., 2023).

    The measure of novelty is how far a scan is from the nearest known one, both as wholes, in squared
    Hellinger distance of their descriptions. A training scan is as far from the nearest of the *others* as a
    new scan of something known would be from the nearest of all. So the p-value of a new scan is the share of
    training scans that are at least as far: of scans of something known, as many as the rate says have a
    p-value up to that rate.

    Parameters
    ----------
    histograms : (n, b) float16
        Description of each training object as a whole.
    distances : (n,) float64 or None
        As the attribute, if it is known.
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    distances : (n,) float64
        Of each training object to the nearest other one, 0 to 1.
    """

    def __init__(
        self,
        histograms: NDArray[np.float16],
        distances: NDArray[np.float64] | None = None,
        n_jobs: int | None = None,
    ) -> None:
        self._compared = np.arange(len(histograms))
        if len(histograms) > MOST_COMPARED:
            drawn = np.argsort(draws(histograms.astype(np.float32)), kind="stable")
            self._compared = np.sort(drawn[:MOST_COMPARED])
        self._roots = np.ascontiguousarray(_roots(histograms[self._compared]).T)
        if distances is None:
            starts = range(0, len(histograms), _AT_ONCE)
            distances_of = partial(self._training_distances, histograms)
            found = list(map_in_order(distances_of, starts, n_jobs, share_memory=True))
            distances = np.concatenate([np.empty(0), *found])
        self.distances = distances

    def distances_of(self, wholes: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far new objects (m, b), as wholes, are from the nearest training object, (m,) float64."""
        return self._to_all(wholes.astype(np.float16)).min(axis=1, initial=1.0)

    def p_values(
        self,
        distances: NDArray[np.float64],
        concepts: Sequence[int] | NDArray[np.integer],
        concept_of: NDArray[np.integer],
    ) -> NDArray[np.float64]:
        """Probability that a scan of something known is as far from all known ones, or farther.

        Parameters
        ----------
        distances : (m,) float64
            As `distances_of` gives them; NaN for a scan that is not described.
        concepts : (m,) int
            Concept of each scan, -1 for none. Where a concept has at least 99 members, they are what its
            scans are compared with, so that the promise holds for each such concept; else all training
            objects are.
        concept_of : (n,) int
            Concept of each training object, -1 for none.

        Returns
        -------
        (m,) float64
            At least 1 / (1 + the number of training objects compared with); NaN for NaN.
        """
        p_values = np.full(len(distances), np.nan)
        concepts = np.asarray(concepts)
        for concept in np.unique(concepts):
            own = np.flatnonzero(concepts == concept)
            known = np.sort(self._known(concept, concept_of))
            n_as_far = len(known) - np.searchsorted(known, distances[own], side="left")
            p_values[own] = (1 + n_as_far) / (1 + len(known))
        p_values[np.isnan(distances)] = np.nan
        return p_values

    def training_p_values(self, concept_of: NDArray[np.integer]) -> NDArray[np.float64]:
        """p-values of the training objects, each as if only the others were known.

        Parameters
        ----------
        concept_of : (n,) int
            Concept of each training object, -1 for none.

        Returns
        -------
        (n,) float64
            At least 1 / the number of training objects compared with.
        """
        p_values = np.empty(len(self.distances))
        for concept in np.unique(concept_of):
            own = concept_of == concept
            known = np.sort(self._known(concept, concept_of))
            # The object itself, which is among the known ones, is the one that counts in any case.
            n_as_far = len(known) - np.searchsorted(known, self.distances[own], side="left")
            p_values[own] = n_as_far / len(known)
        return p_values

    def _known(self, concept: int, concept_of: NDArray[np.integer]) -> NDArray[np.float64]:
        """Distances that a scan of a concept is ranked among."""
        members = self.distances[concept_of == concept]
        return members if concept >= 0 and len(members) >= LEAST_MEMBERS else self.distances

    def neighbours(
        self, histograms: NDArray[np.float16], n_nearest: int, n_jobs: int | None = None
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The nearest other training objects of each.

        Parameters
        ----------
        histograms : (n, b) float16
            As the parameter of the class.
        n_nearest : int
            Fewer if there are fewer.
        n_jobs : int or None
            As in joblib. The result does not depend on it.

        Returns
        -------
        (n, k) int64
            Training objects, the nearest first. Of more than 4096 a sample stands for all.
        (n, k) float64
            How far they are, 0 to 1.
        """
        nearest = partial(self._nearest, histograms, min(n_nearest, max(len(self._compared) - 1, 0)))
        starts = range(0, len(histograms), _AT_ONCE)
        found = list(map_in_order(nearest, starts, n_jobs, share_memory=True))
        return np.concatenate([one for one, _ in found]), np.concatenate([one for _, one in found])

    @property
    def smallest_rate(self) -> float:
        """The smallest rate of false alarms that so many training objects can promise."""
        return 1 / (1 + len(self.distances))

    def _training_distances(self, histograms: NDArray[np.float16], start: int) -> NDArray[np.float64]:
        return np.minimum(self._to_others(histograms, start).min(axis=1, initial=np.inf), 1.0)

    def _nearest(
        self, histograms: NDArray[np.float16], n_nearest: int, start: int
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        distances = self._to_others(histograms, start)
        order = np.argsort(distances, axis=1, kind="stable")[:, :n_nearest]
        return self._compared[order], np.clip(np.take_along_axis(distances, order, axis=1), 0.0, 1.0)

    def _to_others(self, histograms: NDArray[np.float16], start: int) -> NDArray[np.float64]:
        """Distances of training objects to those compared; infinite to itself."""
        distances = self._to_all(histograms[start : start + _AT_ONCE])
        own = np.arange(start, start + len(distances))
        distances[self._compared == own[:, None]] = np.inf
        return distances

    def _to_all(self, wholes: NDArray[np.float16]) -> NDArray[np.float64]:
        distances = np.empty((len(wholes), self._roots.shape[1]))
        hellinger_divergences(_roots(wholes), self._roots, distances)
        return distances


def _roots(histograms: NDArray[np.float16]) -> NDArray[np.float32]:
    """Square roots of histograms that sum to 1 again: half a precision lost a little of it."""
    rows = histograms.astype(np.float64)
    sums = rows.sum(axis=1, keepdims=True)
    roots: NDArray[np.float32] = np.sqrt(rows / np.where(sums > 0, sums, 1)).astype(np.float32)
    return roots
