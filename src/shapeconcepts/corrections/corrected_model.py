"""A model as the user has it: what was learned, with the edits of a journal applied to it."""

from __future__ import annotations

import secrets
import warnings
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.continued_learning import ContinuedLearning
from shapeconcepts.corrections.corrected_concepts import corrected_concepts
from shapeconcepts.corrections.doubt import Likeness
from shapeconcepts.corrections.edit import NONE, Edit, Link
from shapeconcepts.corrections.edit_maker import edit_of_name
from shapeconcepts.corrections.journal import Journal
from shapeconcepts.corrections.journal_file import JournalFile
from shapeconcepts.corrections.medoids import Medoids
from shapeconcepts.corrections.replay import Corrected, replay
from shapeconcepts.corrections.scan_references import ScanReferences
from shapeconcepts.topology.divergence import jensen_shannon_divergences

# So many tell of each scan which concepts are near.
_N_NEAREST = 32
_AT_ONCE = 256


class CorrectedModel(ContinuedLearning):
    """The part of a model that keeps what was said of its concepts, and lets them be so.

    Nothing that was learned is lost: edits are applied to it in their order, and again after each update. So
    each can be undone, and `concepts_` and `labels_` are always those with all edits.
    """

    _journal: Journal = Journal()
    _corrected: Corrected
    _references = ScanReferences(())
    _likeness: Likeness | None
    # Of the concepts as they are, once they are asked for.
    _doubts: NDArray[np.float64] | None
    _medoids: Medoids
    _response: Any
    _learned_response: Any
    _place: Path | None = None

    @property
    def journal(self) -> tuple[Edit, ...]:
        """All edits, the oldest first; each tells whether it is undone, and why it no longer fits."""
        check_is_fitted(self, "filtration_")
        unfit = self._corrected.unfit
        return tuple(
            replace(edit, unfit="" if edit.is_undone else unfit.get(edit.number, ""))
            for edit in self._journal.edits
        )

    @property
    def links(self) -> tuple[Link, ...]:
        """Scans that the user wants together or apart."""
        check_is_fitted(self, "filtration_")
        return tuple(self._corrected.links)

    @property
    def foreign_(self) -> NDArray[np.int64]:
        """Scans that the user marked as foreign, as rows of `labels_`, rising."""
        return np.flatnonzero(self._corrected.is_foreign)

    @property
    def certain_(self) -> NDArray[np.int64]:
        """Scans of which the user said where they belong, as rows of `labels_`, rising."""
        return np.flatnonzero(self._corrected.is_certain)

    @property
    def granularity_(self) -> float | None:
        """At which the concepts were taken last, before what was said of them since; None without a tree."""
        check_is_fitted(self, "filtration_")
        recuts = [edit.granularity for edit in self._journal.in_force if edit.kind == "recut"]
        learned: float | None = getattr(self.filtration_, "granularity_", None)
        return recuts[-1] if recuts else learned

    def likeness(self) -> Likeness:
        """The most alike other scans of each, computed when it is first asked for.

        Raises
        ------
        ValueError
            If the ensemble is one of one's own.
        """
        self.consolidate()
        if self._likeness is None:
            if self.novelty_ is None:
                raise ValueError("likeness needs a MotifHierarchyEnsemble, the ensemble is one of one's own")
            n = len(self.labels_)
            histograms = self.ensemble_.hierarchies_.object_histograms
            objects = np.flatnonzero(~np.isin(np.arange(n), list(self.skipped_)))
            nearest, far = self.novelty_.neighbours(histograms, _N_NEAREST, self.n_jobs)
            neighbours = np.full((n, nearest.shape[1]), -1)
            distances = np.ones(neighbours.shape)
            neighbours[objects], distances[objects] = objects[nearest], far
            self._likeness = Likeness(neighbours, distances)
        return self._likeness

    def write_journal(self, path: str | PathLike[str]) -> None:
        """Add to the journal beside a model's file what it does not hold yet.

        All of it is on the disk when this returns. A journal of another model that lies there is renamed.

        Raises
        ------
        ModelError
            If it holds edits that this model does not know, or is damaged.
        OSError
            If it cannot be written.

        Warns
        -----
        UserWarning
            If there was a journal of another model.
        """
        check_is_fitted(self, "filtration_")
        file = JournalFile(path)
        there = file.read()
        is_own = there.identity == self._journal.identity or not there.identity
        is_own |= not self._journal.identity and self._place == file.path
        if not is_own:
            aside = file.set_aside()
            warnings.warn(f"{file.path} was of another model: it is {aside} now", UserWarning, stacklevel=3)
        elif there.goes_on_from(self._journal):
            # What was said to another process since stays there.
            self._place = file.path
            return
        file.append(self._journal)
        self._place = file.path

    def read_journal(self, path: str | PathLike[str]) -> None:
        """Take the edits beside a model's file, instead of those that were made or read before.

        Raises
        ------
        ModelError
            If what lies there is no journal, or damaged.
        """
        file = JournalFile(path)
        self._journal, self._place = file.read(), file.path
        self._correct()

    def take_identities(self, earlier: ContinuedLearning) -> Any:
        """As without corrections; those of the earlier model are taken, too, unless this one has its own."""
        super().take_identities(earlier)
        if not self._journal.lines and isinstance(earlier, CorrectedModel):
            self._journal = earlier._journal
            self._correct()
        return self

    def _correct(self) -> None:
        """Let concepts and labels be those with all edits."""
        learned = self.filtration_.concepts_
        labels = self.filtration_.labels_
        keys = np.array([*(concept.key for concept in learned), NONE], np.int64)[labels]
        names = {concept.key: concept.name for concept in learned}
        next_key = max(self.n_identities_, self._journal.next_key)
        if self._references.names is not self.scan_names_:
            self._references = ScanReferences(self.scan_names_)
        edits = self._journal.in_force
        self._corrected = replay(keys, names, next_key, edits, self._references, self._most_alike)
        self._reserve_identities(self._corrected.next_key)
        is_changed = not np.array_equal(keys, self._corrected.keys)
        renamed = {key: name for key, name in self._corrected.names.items() if names.get(key) != name}
        self.concepts_ = learned
        if is_changed or renamed:
            space = self.filtration_.space_
            self.concepts_ = corrected_concepts(self._corrected, learned, keys, space, self._medoids)
        number_of = {concept.key: number for number, concept in enumerate(self.concepts_)}
        keys_now, where = np.unique(self._corrected.keys, return_inverse=True)
        numbers = np.array([number_of.get(int(key), -1) for key in keys_now], np.int32)
        self.labels_ = numbers[where].astype(np.int32)
        self._response = None if is_changed else self._learned_response
        self._doubts = None

    @property
    def response_(self) -> Any:
        """Fitted to the concepts as they are, once it is asked for."""
        if self._response is None:
            self._response = clone(self._learned_response).fit(self.stimuli_, self.labels_)
        return self._response

    @response_.setter
    def response_(self, response: Any) -> None:
        self._learned_response = self._response = response

    def _say(self, edit: Edit) -> Edit:
        before = self._journal
        self._journal = before.with_edit(edit, secrets.token_hex(8))
        try:
            self._correct()
        except BaseException:
            self._journal = before
            self._correct()
            raise
        return self._journal.lines[-1]

    def _reserve_identities(self, n: int) -> None:
        raise NotImplementedError

    def _keep_names_set_by_hand(self) -> None:
        # As `concept.name = ...`.
        learned = {concept.key: concept for concept in self.filtration_.concepts_}
        renamed = {key for edit in self._journal.in_force for key, _ in edit.names}
        for concept in self.concepts_:
            if concept.name == self._corrected.names.get(concept.key, ""):
                continue
            if concept.key in learned and concept.key not in renamed:
                learned[concept.key].name = concept.name
            else:
                self._journal = self._journal.with_edit(
                    edit_of_name(concept, concept.name), secrets.token_hex(8)
                )

    def _most_alike(self, rows: NDArray[np.int64], candidates: NDArray[np.int64]) -> NDArray[np.int64]:
        stimuli = self.stimuli_
        found = [np.empty(0, np.int64)]
        for start in range(0, len(rows), _AT_ONCE):
            some = stimuli[rows[start : start + _AT_ONCE]]
            found.append(jensen_shannon_divergences(some, stimuli[candidates]).argmin(axis=1))
        return np.concatenate(found)
