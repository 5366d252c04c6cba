"""What to ask the user next: the question whose answer decides the most scans."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.corrections.doubt import Likeness
from shapeconcepts.corrections.edit import NONE
from shapeconcepts.corrections.replay import Corrected

# As many as can be taken in at a glance.
MOST_SHOWN = 24
# A scan is asked for if another concept is at most three times as far as its own.
DOUBTFUL = 1 / 4
# Whoever is among so many most alike scans of another one tells something of it.
_ALIKE = 3


class Question(NamedTuple):
    """A question to the user.

    Attributes
    ----------
    kind : {"name", "check"}
        "name": what the scans of a concept are. "check": which of some scans, whose concepts have names, are
        something else.
    key : int
        The concept that has no name; -1 for "check".
    scans : (k,) int64
        Scans to show, at most 24: of a concept such as are as unlike as its scans come, the most typical one
        first; of doubtful ones the most doubtful first.
    decides : int
        Number of scans that the answer decides: those of the concept, or those shown and those that have one
        of them among their three most alike.
    """

    kind: str
    key: int
    scans: NDArray[np.int64]
    decides: int


def next_question(
    concepts: list[Concept], corrected: Corrected, likeness: Likeness, doubts: NDArray[np.float64]
) -> Question | None:
    """The question that decides the most scans; None where nothing is left to ask.

    Parameters
    ----------
    concepts : list of Concept
        With the names that they have.
    corrected : Corrected
    likeness : Likeness
    doubts : (n,) float64
    """
    questions = [
        Question("name", concept.key, _spread(concept, likeness), concept.size)
        for concept in concepts
        if not concept.name
    ]
    named = [concept.key for concept in concepts if concept.name]
    is_asked = (doubts >= DOUBTFUL) & (np.isin(corrected.keys, named) | (corrected.keys == NONE))
    doubtful = np.flatnonzero(is_asked)
    if len(doubtful) and (named or not concepts):
        shown = doubtful[np.argsort(-doubts[doubtful], kind="stable")][:MOST_SHOWN]
        hangs = np.isin(likeness.neighbours[doubtful, :_ALIKE], shown).any(axis=1) | np.isin(doubtful, shown)
        questions.append(Question("check", NONE, shown, int(hangs.sum())))
    return max(questions, key=lambda one: one.decides, default=None)


def _spread(concept: Concept, likeness: Likeness) -> NDArray[np.int64]:
    """The most typical scan of a concept, and others as far from it and from each other as they come."""
    members = concept.members
    if concept.size <= MOST_SHOWN:
        others = members[members != concept.medoid]
        return np.concatenate([[concept.medoid], others])
    place = np.full(len(likeness.neighbours), -1)
    place[members] = np.arange(len(members))
    shown, distance = [concept.medoid], np.ones(len(members))
    while len(shown) < MOST_SHOWN:
        last = shown[-1]
        distance[place[last]] = -1
        near = place[likeness.neighbours[last]]
        is_member = (near >= 0) & (likeness.neighbours[last] >= 0)
        np.minimum.at(distance, near[is_member], likeness.distances[last][is_member])
        shown.append(int(members[distance.argmax()]))
    return np.array(shown, np.int64)
