"""What a model says of scans: stimuli, responses, concepts, p-values, and why."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import TransformerMixin
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts import Concept
from shapeconcepts.concepts.recognition import Recognition, concept_shares, foreign_segments
from shapeconcepts.concepts.whole_objects import whole_divergences
from shapeconcepts.descriptors import DescribedObject, describe_scan, describe_scans, scans_in
from shapeconcepts.model_file.state import Update
from shapeconcepts.motifs import Explanation
from shapeconcepts.motifs.stimuli import with_empty_rows
from shapeconcepts.parameters import check_integer
from shapeconcepts.scan import ScanError


class Answers(TransformerMixin):
    """The part of a model that answers, by what `ModelState` holds, in attributes with a trailing `_`."""

    n_jobs: int | None
    segmenter_: Any
    descriptor_: Any
    ensemble_: Any
    filtration_: Any
    response_: Any
    novelty_: Any
    stimuli_: csr_matrix
    labels_: NDArray[np.int32]
    scan_names_: list[str]
    scan_labels_: list[str | None]
    skipped_: dict[int, str]
    n_identities_: int
    history_: tuple[Update, ...]
    concepts_: list[Concept]

    def consolidate(self) -> Any:
        """Let what is known tell of all scans."""
        raise NotImplementedError

    def stimuli(self, X: Iterable[object]) -> csr_matrix:
        """Stimuli of scans: what the responses are computed from.

        Parameters, errors and warnings are those of `transform`.

        Returns
        -------
        (m, n_motifs) csr_matrix of float64
            The row of a scan that cannot be described is empty.
        """
        return self._rows(self._described(X), self.ensemble_.transform)

    def transform(self, X: Iterable[object]) -> NDArray[np.float64]:
        """Responses of the concepts to scans (paper: equation 3); smaller is more alike.

        Parameters
        ----------
        X : iterable of Scan, (n, 3) array, point cloud, SegmentedObject or DescribedObject

        Returns
        -------
        (m, n_concepts) float64
            NaN in the row of a scan without any stimulus.

        Raises
        ------
        ScanError
            If no scan can be described.
        ValueError
            If X is a single scan.

        Warns
        -----
        ScanWarning
            If a scan cannot be described.
        """
        stimuli = self.stimuli(X)
        return self.response_.transform(stimuli)

    def transform_tree(self, X: Iterable[object] | None = None, n_groups: int = 256) -> NDArray[np.float64]:
        """Responses of groups within groups, coarse to fine: features to tell scans apart by.

        Each group of `concept_tree_`, and each that formed within the smallest of them, gives two: the mean
        distance to its members by stimuli, as a concept's response, and that of whole objects.

        Parameters, errors and warnings are those of `transform`, and more:

        Parameters
        ----------
        X : iterable or None
            None: the training scans, each compared with the others only, as a new scan would be.
        n_groups : int
            The coarsest so many, if there are more.

        Returns
        -------
        (m, 2 k) float64
            Of k groups: the responses by stimuli, coarse to fine, then by whole objects.

        Raises
        ------
        ValueError
            If there is no tree, as a time makes the concepts, or `n_groups` is not a positive integer.
        """
        check_is_fitted(self, "filtration_")
        check_integer("n_groups", n_groups, 1)
        self.consolidate()
        tree = self.filtration_.group_tree().coarsest(n_groups)
        members = self.response_.prototype_rows_
        described = None if X is None else self._described(X)
        stimuli = self.stimuli_ if described is None else self._rows(described, self.ensemble_.transform)
        own = np.arange(len(self.labels_)) if described is None else np.full(len(described), -1)
        by_stimuli = self.response_.distances(stimuli)
        is_object = ~np.isin(np.arange(len(self.labels_)), list(self.skipped_))
        histograms = self.ensemble_.hierarchies_.object_histograms
        by_whole = whole_divergences(histograms, is_object, members, described)
        return np.concatenate(
            [tree.mean_distances(distances, members, own) for distances in (by_stimuli, by_whole)], axis=1
        )

    def predict(self, X: Iterable[object], unknown_rate: float | None = None) -> NDArray[np.int64]:
        """Concept of whose members each scan reminds most, -1 for a scan unlike all.

        Parameters, errors and warnings are those of `recognise`.

        Returns
        -------
        (m,) int64
            Position in `concepts_`, or -1.
        """
        return self.recognise(X, unknown_rate).concepts

    def recognise(self, X: Iterable[object], unknown_rate: float | None = None) -> Recognition:
        """Concepts of scans, responses, how much each scan reminds of each concept's members, and p-values.

        A scan of which a part is hidden reminds of what the imagined occlusions of training scans left. Where
        the stimuli are of motifs, the concept is the one whose nearest training scans are nearest.

        Parameters, errors and warnings are those of `transform`, and more:

        Parameters
        ----------
        X : iterable
        unknown_rate : float or None
            Share of scans of something known that may be called unknown, 0 to 1: those with a p-value up to
            it. It holds for scans like those in training, not where more is hidden, or noise is stronger.
            A scan that reminds only of training scans in no concept is in none, too, whatever its p-value.
            None: a scan is unknown where it is farther from every training scan than any of these from its
            neighbours, which promises nothing.

        Raises
        ------
        ValueError
            If `unknown_rate` is no number from 0 to 1, or the ensemble is one of one's own.

        Warns
        -----
        UserWarning
            If there are too few training scans to promise such a rate: nothing is called unknown.
        """
        check_is_fitted(self, "filtration_")
        self._check_rate(unknown_rate)
        described = self._described(X)
        stimuli = self._rows(described, self.ensemble_.transform)
        concepts, responses = self.response_.predict(stimuli), self.response_.transform(stimuli)
        shares, is_known = None, concepts >= 0
        if getattr(self.ensemble_, "knows_objects", False):
            reminders = self._rows(described, self.ensemble_.reminders)
            shares = concept_shares(reminders, self._concept_of_object, len(self.concepts_))
        if shares is not None and self.concepts_:
            concepts = np.where(shares.any(axis=1), shares.argmax(axis=1), -1)
        p_values = self._p_values(described, concepts)
        if unknown_rate is not None and p_values is not None:
            is_known = p_values > unknown_rate
        return Recognition(np.where(is_known, concepts, -1), responses, shares, p_values)

    def _check_rate(self, unknown_rate: float | None) -> None:
        if unknown_rate is None:
            return
        is_number = isinstance(unknown_rate, Real) and not isinstance(unknown_rate, bool)
        if not is_number or not 0 <= unknown_rate <= 1:
            raise ValueError(f"unknown_rate must be a number from 0 to 1, got {unknown_rate!r}")
        if self.novelty_ is None:
            raise ValueError("unknown_rate needs a MotifHierarchyEnsemble, the ensemble is one of one's own")
        smallest = self.novelty_.smallest_rate
        if unknown_rate < smallest:
            warnings.warn(
                f"{len(self.novelty_.distances)} training scans promise a rate of {smallest:.2g} at best, "
                f"got unknown_rate {unknown_rate:g}: no scan will be called unknown",
                UserWarning,
                stacklevel=4,
            )

    def _p_values(
        self, described: list[DescribedObject | None], concepts: NDArray[np.int64]
    ) -> NDArray[np.float64] | None:
        if self.novelty_ is None:
            return None
        distances = np.full(len(described), np.nan)
        wholes = [one.description.whole() for one in described if one]
        if wholes:
            distances[[i for i, one in enumerate(described) if one]] = self.novelty_.distances_of(
                np.array(wholes)
            )
        return self.novelty_.p_values(distances, concepts, self._concept_of_object)

    def training_p_values(self) -> NDArray[np.float64] | None:
        """p-values of the training scans, each as if only the others were known; see `recognise`.

        Returns
        -------
        (n,) float64 or None
            NaN for a scan that was skipped. None where the ensemble is one of one's own.
        """
        check_is_fitted(self, "filtration_")
        self.consolidate()
        if self.novelty_ is None:
            return None
        p_values = np.full(len(self.labels_), np.nan)
        is_object = ~np.isin(np.arange(len(self.labels_)), list(self.skipped_))
        p_values[is_object] = self.novelty_.training_p_values(self._concept_of_object)
        return p_values

    def explain(self, scan: object) -> Explanation:
        """Which motifs a scan fires, how strongly, which training scans they come from, and what is foreign.

        Raises
        ------
        ScanError
            If the scan cannot be described.
        """
        check_is_fitted(self, "filtration_")
        described = describe_scan(self.segmenter_, self.descriptor_, scan)
        if isinstance(described, ScanError):
            raise described
        explanation, recognition = self.ensemble_.explain(described), self.recognise([described])
        concept = int(recognition.concepts[0])
        if recognition.shares is None or concept < 0:
            return explanation
        parts = [described.segment(number) for number in range(described.n_segments)]
        foreign = foreign_segments(self.ensemble_.reminders(parts), self._concept_of_object, concept)
        return replace(explanation, foreign=foreign)

    def _described(self, X: Iterable[object]) -> list[DescribedObject | None]:
        check_is_fitted(self, "filtration_")
        self.ensemble_.n_jobs = self.n_jobs
        results = describe_scans(scans_in(X), self.segmenter_, self.descriptor_, self.n_jobs)
        return [one.described for one in results]

    def _rows(
        self, described: list[DescribedObject | None], rows_of: Callable[[list[DescribedObject]], Any]
    ) -> csr_matrix:
        """Rows of the scans that could be described, and empty ones for the others."""
        # scikit-learn can be told that it shall be a data frame.
        return with_empty_rows(csr_matrix(rows_of([one for one in described if one])), described)

    @property
    def _concept_of_object(self) -> NDArray[np.int32]:
        """Concept of each object that the ensemble saw: of the training scans that were not skipped."""
        concepts = np.delete(self.labels_, list(self.skipped_))
        # Those that came later are not among the objects yet.
        hierarchies = getattr(self.ensemble_, "hierarchies_", None)
        return concepts if hierarchies is None else concepts[: hierarchies.n_objects]
