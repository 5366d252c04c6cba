"""Learning that goes on: scans join what is known or wait, and concepts keep their identities."""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, vstack
from scipy.stats import binom
from sklearn.base import clone
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.answers import Answers
from shapeconcepts.concepts import Concept, Filtration
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
# Share of the members that two groups share, of those of both.
_ALIKE = 0.4


class ContinuedLearning(Answers):
    """The part of a model that learns on."""

    _waiting: list[DescribedScan]
    _is_novel: list[bool]
    _learned_rows: csr_matrix
    _waiting_rows: list[csr_matrix]

    def partial_fit(self, X: Iterable[object], y: object = None, *, unknown_rate: float = NOVEL_RATE) -> Any:
        """Learn from more scans; nothing that is known is forgotten, and no concept gets another identity.

        A new scan joins the concept that it is recognised as, or waits in none where it is like nothing
        known. When a tenth more scans have come, or more wait than chance explains, the space is filtered
        again, see `consolidate`: concepts are born, split and merge then. The first call is `fit`.

        Parameters, errors and warnings are those of `fit`, and more:

        Parameters
        ----------
        X : iterable
        unknown_rate : float
            A scan waits if its p-value is so small, see `recognise`.

        Raises
        ------
        ValueError
            If ensemble or filtration is one of one's own.

        Returns
        -------
        self
            `labels_`, `concepts_`, `stimuli_` and the names tell of all scans.
        """
        if not hasattr(self, "filtration_"):
            return self.fit(X)
        stages = self.ensemble_, self.filtration_
        if not isinstance(stages[0], MotifHierarchyEnsemble) or not isinstance(stages[1], Filtration):
            raise ValueError(
                "learning on needs a MotifHierarchyEnsemble and a Filtration, "
                f"got {type(stages[0]).__name__} and {type(stages[1]).__name__}"
            )
        scans, n_occlusions = scans_in(X), self.ensemble_.n_occlusions
        results = describe_scans(scans, self.segmenter_, self.descriptor_, self.n_jobs, n_occlusions)
        if not results:
            raise ValueError("X must hold at least one scan, got none")
        before = dict(self.__dict__)
        try:
            self._join(results, unknown_rate)
            if self._is_due(unknown_rate):
                self.consolidate()
        except BaseException:
            # Whoever tries again is not to find the scans there already.
            self.__dict__.clear()
            self.__dict__.update(before)
            raise
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
        check_is_fitted(self, "filtration_")
        if not self._waiting:
            return self
        self._keep_names_set_by_hand()
        before, keys_before = self.filtration_.labels_, _keys(self.filtration_.concepts_)
        names = {concept.key: concept.name for concept in self.filtration_.concepts_}
        shown_before, shown_keys_before = self.labels_, _keys(self.concepts_)
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
        identities = identities_after(before, labels, keys_before, n_concepts, self.n_identities_)
        for concept, key in zip(filtration.concepts_, identities.keys, strict=True):
            concept.key, concept.name = key, names.get(key, "")
        _carry_names_of_groups(self.filtration_, filtration)
        earlier = tuple(update._replace(moved=()) for update in self.history_)
        self._remember(
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
            )
        )
        moved = _moved(shown_before, self.labels_, shown_keys_before, _keys(self.concepts_))
        self.history_ = (*earlier, Update(len(before), len(labels), identities.changes, moved))
        return self

    def take_identities(self, earlier: ContinuedLearning) -> Any:
        """Give concepts the identities and names that they have in an earlier model with some of the scans.

        For a model that was learned anew from old scans and new ones. Scans are the same if they have the
        same name, which no other scan has. Concepts are matched as by an update, see `identities_after`, and
        `history_` goes on with what changed.

        Parameters
        ----------
        earlier : ShapeConceptModel
            Fitted. It does not change.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If the models have no scan in common.
        """
        check_is_fitted(self, "filtration_")
        check_is_fitted(earlier, "filtration_")
        rows, rows_before = _in_both(self.scan_names_, earlier.scan_names_)
        if not len(rows):
            raise ValueError("earlier must be a model of some of the same scans, got one without any of them")
        others = np.setdiff1d(np.arange(len(self.labels_)), rows)
        keys_before = _keys(earlier.filtration_.concepts_)
        before = earlier._learned_labels[rows_before]
        after = self._learned_labels[np.concatenate([rows, others])]
        concepts, names = self.filtration_.concepts_, {one.key: one.name for one in earlier.concepts_}
        found = identities_after(before, after, keys_before, len(concepts), earlier.n_identities_)
        for concept, key in zip(concepts, found.keys, strict=True):
            concept.key, concept.name = key, names.get(key, concept.name)
        moved = tuple(
            (int(rows[row]), key_before, key)
            for row, key_before, key in _moved(before, after, keys_before, list(found.keys))
        )
        update = Update(len(rows), len(self.labels_), found.changes, moved)
        # Of a model of more scans than this one has, updates cannot be told.
        told = [one._replace(moved=()) for one in earlier.history_ if one.n_after <= len(self.labels_)]
        state = self._state()
        return self._remember(state._replace(n_identities=found.n_given, history=(*told, update)))

    def _keep_names_set_by_hand(self) -> None:
        """Let names that were given to concepts themselves be known."""
        raise NotImplementedError

    @property
    def _learned_labels(self) -> NDArray[np.int32]:
        """Concept of each scan as learned, as a position in those of the filtration.

        Of one that joined since, what it was recognised as, if that was learned.
        """
        learned = self.filtration_.labels_
        number_of = {key: number for number, key in enumerate(_keys(self.filtration_.concepts_))}
        numbers = np.array([*(number_of.get(key, -1) for key in _keys(self.concepts_)), -1], np.int32)
        return np.concatenate([learned, numbers[self.labels_[len(learned) :]]])

    @property
    def pool_(self) -> NDArray[np.int64]:
        """Scans that came after the space was filtered and are like nothing known, as rows of `labels_`."""
        n_old = len(self.labels_) - len(self._waiting)
        return n_old + np.flatnonzero(self._is_novel)

    def _join(self, results: list[DescribedScan], unknown_rate: float) -> None:
        described: list[DescribedObject | None] = [one.described for one in results]
        usable = [one for one in described if one]
        rate = unknown_rate if self.novelty_.smallest_rate <= unknown_rate else None
        recognition = self.recognise(usable, rate) if usable else None
        concepts = np.full(len(results), -1, np.int32)
        is_described = np.array([one is not None for one in described])
        if recognition is not None:
            concepts[is_described] = recognition.concepts
        n_known = len(self.labels_)
        # Other cuts of the tree have these concepts, too, and not these scans.
        joining = [n_known + np.flatnonzero(concepts == number) for number in range(len(self.concepts_))]
        self.concepts_ = [
            replace(concept, members=np.concatenate([concept.members, own]))
            for concept, own in zip(self.concepts_, joining, strict=True)
        ]
        self._waiting_rows = [*self._waiting_rows, self._rows(described, self.ensemble_.transform)]
        self.labels_ = np.concatenate([self.labels_, concepts])
        self.scan_names_ = [*self.scan_names_, *(one.name for one in results)]
        self.scan_labels_ = [*self.scan_labels_, *(one.label for one in results)]
        reasons = {n_known + i: one.reason for i, one in enumerate(results) if one.described is None}
        self.skipped_ = {**self.skipped_, **reasons}
        self._waiting = [*self._waiting, *results]
        self._is_novel = [*self._is_novel, *((concepts < 0) & is_described).tolist()]

    @property
    def stimuli_(self) -> csr_matrix:
        """Of all scans, those that came later included."""
        if self._waiting_rows:
            # Only now: one by one, each would copy all that came before.
            self._learned_rows = csr_matrix(vstack([self._learned_rows, *self._waiting_rows]))
            self._waiting_rows = []
        return self._learned_rows

    @stimuli_.setter
    def stimuli_(self, rows: csr_matrix) -> None:
        self._learned_rows, self._waiting_rows = rows, []

    def _is_due(self, unknown_rate: float) -> bool:
        n_waiting, n_novel = len(self._waiting), sum(self._is_novel)
        if n_waiting >= _GROWTH * (len(self.labels_) - n_waiting):
            return True
        return n_novel >= self.filtration_.min_concept_size and bool(
            binom.sf(n_novel - 1, n_waiting, unknown_rate) < _SURPRISE
        )


def _keys(concepts: Iterable[Concept]) -> list[int]:
    return [concept.key for concept in concepts]


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


def _carry_names_of_groups(before: Filtration, after: Filtration) -> None:
    """Names of groups that are no concepts of the present cut, to the groups that are most like them."""
    if before.concept_tree_ is None or after.concept_tree_ is None:
        return
    members_after = [after.concept_tree_.members(group) for group in range(len(after.concept_tree_.parents))]
    named: dict[int, str] = {}
    for group, name in before._group_names():
        members = before.concept_tree_.members(group)
        shared = [len(np.intersect1d(members, one)) / len(np.union1d(members, one)) for one in members_after]
        if shared and max(shared) > _ALIKE:
            named.setdefault(int(np.argmax(shared)), name)
    taken = {id(concept) for concept in after.concepts_ if concept.name}
    after._name_groups(
        [[group, name] for group, name in named.items() if id(after._concepts_of([group])[0]) not in taken]
    )


def _moved(
    before: NDArray[np.integer], after: NDArray[np.integer], keys_before: list[int], keys: list[int]
) -> tuple[tuple[int, int, int], ...]:
    """Scans that are in a concept of another identity than before, with both identities, -1 for none."""
    of_before = np.array([*keys_before, -1])[before]
    of_after = np.array([*keys, -1])[after[: len(before)]]
    return tuple(
        (int(scan), int(of_before[scan]), int(of_after[scan]))
        for scan in np.flatnonzero(of_before != of_after)
    )


def _in_both(names: list[str], names_before: list[str]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of the scans of two models whose name is one scan's in each, rising in the first."""
    counts, counts_before = Counter(names), Counter(names_before)
    row_before = {name: row for row, name in enumerate(names_before) if counts_before[name] == 1}
    pairs = [
        (row, row_before[name])
        for row, name in enumerate(names)
        if name and counts[name] == 1 and name in row_before
    ]
    rows = np.array(pairs, np.int64).reshape(-1, 2)
    return rows[:, 0], rows[:, 1]
