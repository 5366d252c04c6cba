"""Learning that goes on: scans join what is known or wait, and concepts keep their identities."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, vstack
from scipy.stats import binom
from sklearn.base import clone
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.answers import Answers
from shapeconcepts.concepts.identity import identities_after
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.descriptors import DescribedObject, describe_scans, scans_in
from shapeconcepts.descriptors.described_scans import DescribedScan
from shapeconcepts.model_file import ModelState
from shapeconcepts.model_file.state import Update
from shapeconcepts.motifs import MotifHierarchyEnsemble
from shapeconcepts.motifs.stimuli import with_empty_rows

# A new scan waits where its p-value says that one in twenty scans of something known would be as unlike.
NOVEL_RATE = 0.05
# More scans wait than chance explains.
_SURPRISE = 0.01
# The space is filtered again when it has grown by so much: all in all, scans are filtered as often as if they
# had come in ten times as many.
_GROWTH = 0.1
# Words are learned again when there are so many times the segments that they were learned from.
_TIMES_THE_WORDS = 2


class ContinuedLearning(Answers):
    """The part of a model that learns on."""

    _waiting: list[DescribedScan]
    _is_novel: list[bool]

    def partial_fit(self, X: Iterable[object], y: object = None) -> Any:
        """Learn from more scans; nothing that is known is forgotten, and no concept gets another identity.

        A new scan joins the concept that it is recognised as, or waits in none where it is like nothing
        known. When a tenth more scans have come, or more wait than chance explains, the space is filtered
        again, see `consolidate`: concepts are born, split and merge then. The first call is `fit`.

        Parameters, errors and warnings are those of `fit`, but for the dictionary, which stays as it is.

        Returns
        -------
        self
            `labels_`, `concepts_`, `stimuli_` and the names tell of all scans.
        """
        if not hasattr(self, "response_"):
            return self.fit(X)
        n_occlusions = getattr(self.ensemble_, "n_occlusions", 0)
        scans = scans_in(X)
        results = describe_scans(scans, self.segmenter_, self.descriptor_, self.n_jobs, n_occlusions)
        if not results:
            raise ValueError("X must hold at least one scan, got none")
        self._join(results)
        if self._is_due():
            self.consolidate()
        return self

    def consolidate(self) -> Any:
        """Filter the space of all scans, those that joined or wait included; nothing where there are none.

        It takes as long as the second half of `fit`. `save` and whatever looks at the tree of concepts do it
        first.

        Returns
        -------
        self
            `history_` has one `Update` more.
        """
        check_is_fitted(self, "response_")
        if not self._waiting:
            return self
        before, keys_before = self.labels_, [concept.key for concept in self.concepts_]
        names = {concept.key: concept.name for concept in self.concepts_}
        ensemble = copy.copy(self.ensemble_).set_params(n_jobs=self.n_jobs)
        if described := [one.described for one in self._waiting if one.described]:
            ensemble.partial_fit(described)
        ensemble = _with_its_dictionary_renewed(ensemble)
        is_described = [i not in self.skipped_ or None for i in range(len(self.scan_names_))]
        stimuli = with_empty_rows(ensemble.stimuli_, is_described)
        filtration = clone(self.filtration_).set_params(n_jobs=self.n_jobs).fit(stimuli)
        response = clone(self.response_).fit(stimuli, filtration.labels_)
        novelty = Novelty(ensemble.hierarchies_.object_histograms, n_jobs=self.n_jobs)

        labels, n_concepts = filtration.labels_, len(filtration.concepts_)
        n_old = len(before) - len(self._waiting)
        identities = identities_after(before[:n_old], labels, keys_before, n_concepts, self.n_identities_)
        for concept, key in zip(filtration.concepts_, identities.keys, strict=True):
            concept.key, concept.name = key, names.get(key, "")
        moved = _moved(before, labels, keys_before, identities.keys)
        update = Update(n_old, len(labels), identities.changes, moved)
        return self._remember(
            ModelState(
                self.segmenter_,
                self.descriptor_,
                ensemble,
                filtration,
                response,
                stimuli,
                self.scan_names_,
                self.scan_labels_,
                self.skipped_,
                novelty,
                identities.n_given,
                (*self.history_, update),
            )
        )

    @property
    def pool_(self) -> NDArray[np.int64]:
        """Scans that came after the space was filtered and are like nothing known, as rows of `labels_`."""
        n_old = len(self.labels_) - len(self._waiting)
        return n_old + np.flatnonzero(self._is_novel)

    def _join(self, results: list[DescribedScan]) -> None:
        described: list[DescribedObject | None] = [one.described for one in results]
        usable = [one for one in described if one]
        recognition = self.recognise(usable, NOVEL_RATE if self._can_promise else None) if usable else None
        concepts = np.full(len(results), -1, np.int32)
        is_described = np.array([one is not None for one in described])
        if recognition is not None:
            concepts[is_described] = recognition.concepts
        n_known = len(self.labels_)
        for number, concept in enumerate(self.concepts_):
            own = n_known + np.flatnonzero(concepts == number)
            concept.members = np.concatenate([concept.members, own])
        rows = self._rows(described, self.ensemble_.transform)
        self.stimuli_ = csr_matrix(vstack([self.stimuli_, rows]))
        self.labels_ = np.concatenate([self.labels_, concepts])
        self.scan_names_ = [*self.scan_names_, *(one.name for one in results)]
        self.scan_labels_ = [*self.scan_labels_, *(one.label for one in results)]
        reasons = {n_known + i: one.reason for i, one in enumerate(results) if one.described is None}
        self.skipped_ = {**self.skipped_, **reasons}
        self._waiting = [*self._waiting, *results]
        self._is_novel = [*self._is_novel, *((concepts < 0) & is_described).tolist()]

    @property
    def _can_promise(self) -> bool:
        return self.novelty_ is not None and self.novelty_.smallest_rate <= NOVEL_RATE

    def _is_due(self) -> bool:
        n_waiting, n_novel = len(self._waiting), sum(self._is_novel)
        if n_waiting >= _GROWTH * (len(self.labels_) - n_waiting):
            return True
        return n_novel >= self.filtration_.min_concept_size and bool(
            binom.sf(n_novel - 1, n_waiting, NOVEL_RATE) < _SURPRISE
        )


def _with_its_dictionary_renewed(ensemble: MotifHierarchyEnsemble) -> MotifHierarchyEnsemble:
    """The ensemble, with words of all segments where it learned them itself, from less than half of these."""
    known, has_its_own = ensemble.hierarchies_, not hasattr(ensemble.dictionary, "words_")
    if known.is_thinned or not has_its_own:
        return ensemble
    constellations = known.prototype_constellations
    n_segments = int((constellations & (constellations - 1) == 0).sum())
    return (
        ensemble.with_new_dictionary()
        if n_segments >= _TIMES_THE_WORDS * len(ensemble.dictionary_.clusters_)
        else ensemble
    )


def _moved(
    before: NDArray[np.integer], after: NDArray[np.integer], keys_before: list[int], keys: tuple[int, ...]
) -> tuple[tuple[int, int, int], ...]:
    """Scans that are in a concept of another identity than before, with both identities, -1 for none."""
    of_before = np.array([*keys_before, -1])[before]
    of_after = np.array([*keys, -1])[after[: len(before)]]
    return tuple(
        (int(scan), int(of_before[scan]), int(of_after[scan]))
        for scan in np.flatnonzero(of_before != of_after)
    )
