"""Concepts of the groups that the user has, with what is known of those that they were."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.corrections.edit import NONE
from shapeconcepts.corrections.medoids import Medoids
from shapeconcepts.corrections.replay import Corrected
from shapeconcepts.topology.space import TopologicalSpace


def corrected_concepts(
    corrected: Corrected,
    learned: Sequence[Concept],
    learned_keys: NDArray[np.int64],
    space: TopologicalSpace,
    known: Medoids,
) -> list[Concept]:
    """Concepts as they are with all edits, the largest first.

    A concept that no edit touched is the learned one itself. Of others, birth and death are those of the
    learned concept that most of their scans are from.

    Parameters
    ----------
    corrected : Corrected
    learned : sequence of Concept
    learned_keys : (n,) int64
        Key of each scan's learned concept, -1 for none.
    space : TopologicalSpace
        Fitted.
    known : Medoids
        Of groups that there were before; those that are found are added.
    """
    of_key = {concept.key: concept for concept in learned}
    order = np.argsort(corrected.keys, kind="stable")
    keys, starts = np.unique(corrected.keys[order], return_index=True)
    found = []
    for key, members in zip(keys.tolist(), np.split(order, starts[1:]), strict=True):
        if key == NONE:
            continue
        name, same = corrected.names.get(key, ""), of_key.get(key)
        if same is not None and np.array_equal(same.members, members):
            found.append(same if same.name == name else replace(same, name=name))
            continue
        own = learned_keys[members]
        counts = np.bincount(own[own >= 0])
        birth, death = 0.0, np.inf
        if len(counts):
            main = of_key[int(counts.argmax())]
            birth, death = main.birth, main.death
        medoid = known.of(members, space)
        found.append(Concept(members, medoid, birth, death, name, key))
    # As the learned ones: of equally large ones the one with the smallest vertex first.
    return sorted(found, key=lambda one: (-one.size, int(space.vertices_[one.members].min())))
