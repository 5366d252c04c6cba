"""The time at which the paper stops a filtration, found without labels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.topology.annexations import Annexations


class States(NamedTuple):
    """What there is after each annexation of a filtration.

    Attributes
    ----------
    times : (e,) float64
        Time of each annexation, rising.
    n_concepts : (e,) int64
        Classes of the smallest size of a concept or more.
    largest : (e,) int64
        Objects in the largest class.
    n_objects : int
    """

    times: NDArray[np.float64]
    n_concepts: NDArray[np.int64]
    largest: NDArray[np.int64]
    n_objects: int

    @classmethod
    def of(cls, annexations: Annexations, min_size: int) -> States:
        """States of a filtration, whose concepts have at least `min_size` objects."""
        dying, surviving = annexations.dying_sizes, annexations.surviving_sizes
        multiplicities = annexations.space.multiplicities_
        n_concepts = (multiplicities >= min_size).sum() + np.cumsum(
            (dying + surviving >= min_size).astype(int)
            - (dying >= min_size).astype(int)
            - (surviving >= min_size).astype(int)
        )
        largest = np.maximum(np.maximum.accumulate(dying + surviving), multiplicities.max(initial=0))
        return cls(annexations.times, n_concepts, largest, int(multiplicities.sum()))


def most_annexations(annexations: Annexations, max_steps: int, min_size: int) -> float | None:
    """End of the earliest step with the most annexations (the paper's epsilon_max), unless it is trivial.

    After it there are at least two concepts, and none holds more than half of the objects.

    Parameters
    ----------
    annexations : Annexations
    max_steps : int
        Largest number of steps of time.
    min_size : int
        Of a concept.

    Returns
    -------
    float or None
        None where there is no such step.
    """
    states = States.of(annexations, min_size)
    step_ends, counts = annexations.per_step(max_steps)
    last = np.cumsum(counts) - 1
    is_open = (counts > 0) & (last >= 0)
    is_open[is_open] &= (states.n_concepts[last[is_open]] >= 2) & (
        2 * states.largest[last[is_open]] <= states.n_objects
    )
    if not is_open.any():
        return None
    best = np.where(is_open, counts, -1).argmax()
    # Rounding may put the last annexation of a step behind its end.
    return float(max(step_ends[best], states.times[last[best]]))
