"""What a user can say of a model's concepts, and what to ask the user."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.corrections.corrected_model import CorrectedModel
from shapeconcepts.corrections.doubt import doubts
from shapeconcepts.corrections.edit import Edit
from shapeconcepts.corrections.edit_maker import ConceptLike, EditMaker, ScanLike
from shapeconcepts.corrections.question import Question, next_question
from shapeconcepts.parameters import check_share


class Corrections(CorrectedModel):
    """The part of a model that the user corrects.

    Each method that says something makes an edit, which is applied at once and which `undo` takes back.
    """

    def rename(self, concept: ConceptLike, name: str) -> Edit:
        """Call a concept something; an empty name takes its name away.

        Parameters
        ----------
        concept : int or Concept
            A key, or one of `concepts_`.
        name : str

        Returns
        -------
        Edit

        Raises
        ------
        ValueError
            If there is no such concept.
        """
        return self._say(self._maker().rename(concept, name))

    def merge(self, concepts: Iterable[ConceptLike], name: str = "") -> Edit:
        """Make several concepts one, which keeps the key of the largest.

        Parameters
        ----------
        concepts : iterable of int or Concept
            Two at least.
        name : str
            What it is called; by default as the first of them that has a name.

        Returns
        -------
        Edit

        Raises
        ------
        ValueError
            If there are fewer than two, or one is not there.
        """
        return self._say(self._maker().merge(concepts, name))

    def split(self, concept: ConceptLike, scans: Iterable[ScanLike] | None = None) -> Edit:
        """Make two concepts of one, of which one keeps its key and its name.

        Parameters
        ----------
        concept : int or Concept
        scans : iterable of int or str, optional
            Some of its scans, as rows or names, which become a concept of their own. By default it falls into
            two along the tree of the filtration, and the larger one keeps the key; scans that joined late go
            with the more alike part.

        Returns
        -------
        Edit
            Its `made` holds the key of the new concept.

        Raises
        ------
        ValueError
            If there is no such concept, a scan is not in it, none would be left, or it has no parts.
        """
        return self._say(self._maker().split(concept, scans, self.filtration_.group_tree))

    def move(self, scans: Iterable[ScanLike], concept: ConceptLike | None = None, name: str = "") -> Edit:
        """Say in which concept scans belong.

        Parameters
        ----------
        scans : iterable of int or str
            Rows or names.
        concept : int, Concept or None
            None makes a new concept of them.
        name : str
            Of the new concept.

        Returns
        -------
        Edit

        Raises
        ------
        ValueError
            If there is no such concept or scan.
        """
        return self._say(self._maker().move(scans, concept, name))

    def mark_foreign(self, scans: Iterable[ScanLike]) -> Edit:
        """Say that scans are none of the objects that this is about; they are in no concept then."""
        return self._say(self._maker().foreign(scans))

    def confirm(self, scans: Iterable[ScanLike]) -> Edit:
        """Say that scans are in the right concepts, so that they are not asked for again.

        Raises
        ------
        ValueError
            If one is in none.
        """
        return self._say(self._maker().confirm(scans))

    def link(self, first: ScanLike, second: ScanLike, together: bool = True) -> Edit:
        """Say that two scans belong in one concept (must-link), or in different ones (cannot-link).

        The second one follows: to the concept of the first one, with all that are linked with it; or to the
        concept of the most alike scan that is in another one, or to none. Where what is said later breaks a
        link, `journal` tells.

        Raises
        ------
        ValueError
            If there is no such scan, both are the same, or the first one is in no concept.
        """
        likeness = self.likeness() if not together and self.novelty_ is not None else None
        return self._say(self._maker().link(first, second, together, likeness))

    def recut(self, granularity: float) -> Edit:
        """Take the concepts at another granularity.

        They keep keys and names as after an update. What was said of single scans stays: one that was put
        into another concept than its like goes where the most of that concept go.

        Raises
        ------
        ValueError
            If `granularity` is not between 0 and 1, there is no tree of concepts, or nothing would change.
        """
        cut = self.concepts_at(granularity)
        for concept in cut:
            self._medoids.add(concept)
        return self._say(self._maker().recut(cut, granularity))

    def propagate(self, rate: float = 0.05) -> Edit:
        """Put scans that are in no named concept into those that they can only be in.

        Parameters
        ----------
        rate : float
            Of scans like those in a named concept, the share that may be left out, 0 to 1; see
            `shapeconcepts.corrections.doubt.confident`. Scans that may be in several, or in none, stay.

        Returns
        -------
        Edit

        Raises
        ------
        ValueError
            If no concept has a name, or there is no scan that can be put anywhere.
        """
        check_share("rate", rate)
        return self._say(self._maker().propagate(rate, self.likeness()))

    def undo(self) -> Edit:
        """Undo the last edit that is not undone; all of them can be, one after the other.

        Returns
        -------
        Edit
            The one that is undone.

        Raises
        ------
        ValueError
            If there is none.
        """
        check_is_fitted(self, "filtration_")
        last = self._journal.last_done
        if last is None:
            raise ValueError("there is nothing to undo")
        self._say(Edit(0, "undo", f"Undone: {last.text}", of=last.number))
        return replace(last, is_undone=True)

    def redo(self) -> Edit:
        """Do again what was undone last, if nothing else was said since.

        Returns
        -------
        Edit

        Raises
        ------
        ValueError
            If there is none.
        """
        check_is_fitted(self, "filtration_")
        last = self._journal.last_undone
        if last is None:
            raise ValueError("there is nothing to do again")
        self._say(Edit(0, "redo", f"Done again: {last.text}", of=last.number))
        return last

    def doubts(self) -> NDArray[np.float64]:
        """How much nearer each scan is to another concept than to its own, (n,) float64 from 0 to 1.

        See `shapeconcepts.corrections.doubt.doubts`.
        """
        if self._doubts is None:
            self._doubts = doubts(self._corrected, self.likeness())
        return self._doubts.copy()

    def next_question(self) -> Question | None:
        """What to ask the user: the question that decides the most scans, or None."""
        return next_question(self.concepts_, self._corrected, self.likeness(), self.doubts())

    def _maker(self) -> EditMaker:
        check_is_fitted(self, "filtration_")
        self.consolidate()
        return EditMaker(
            self.concepts_,
            self._corrected,
            self._references,
            self.scan_names_,
            self.skipped_,
            max(self._corrected.next_key, self._journal.next_key, self.n_identities_),
            self._most_alike,
        )
