"""Medoids of the groups that the user made."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.concepts_of_groups import concepts_of_members
from shapeconcepts.topology.space import TopologicalSpace


class Medoids:
    """Medoids of groups of scans, each found once: most edits leave most groups as they are.

    Parameters
    ----------
    concepts : iterable of Concept
        Whose medoids are known.
    """

    def __init__(self, concepts: Iterable[Concept] = ()) -> None:
        self._found: dict[bytes, int] = {}
        for concept in concepts:
            self.add(concept)

    def add(self, concept: Concept) -> None:
        """Know that of a concept, too."""
        self._found[_digest(concept.members)] = concept.medoid

    def of(self, members: NDArray[np.int64], space: TopologicalSpace) -> int:
        """Medoid of a group."""
        key = _digest(members)
        if key not in self._found:
            self._found[key] = _medoid(members, space)
        return self._found[key]


def _digest(members: NDArray[np.int64]) -> bytes:
    return hashlib.sha256(np.ascontiguousarray(members, np.int64).tobytes()).digest()


def _medoid(members: NDArray[np.int64], space: TopologicalSpace) -> int:
    # A place is where a medoid is looked for: scans without one may have been moved here, too.
    placed = members[space.vertices_[members] >= 0]
    if not len(placed):
        return int(members[0])
    return concepts_of_members(space, [placed], np.zeros(1), np.ones(1))[0].medoid
