"""The time at which the paper stops a filtration, found without labels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


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
    def of(
        cls,
        times: NDArray[np.float64],
        dying_sizes: NDArray[np.int64],
        surviving_sizes: NDArray[np.int64],
        multiplicities: NDArray[np.int64],
        min_size: int,
    ) -> States:
        """States of a filtration from the members of the classes at each annexation, just before it."""
        sizes = dying_sizes + surviving_sizes
        n_concepts = (multiplicities >= min_size).sum() + np.cumsum(
            (sizes >= min_size).astype(int)
            - (dying_sizes >= min_size).astype(int)
            - (surviving_sizes >= min_size).astype(int)
        )
        largest = np.maximum(np.maximum.accumulate(sizes), multiplicities.max(initial=0))
        return cls(times, n_concepts, largest, int(multiplicities.sum()))


def most_annexations(
    states: States, step_ends: NDArray[np.float64], counts: NDArray[np.int64]
) -> float | None:
    """End of the earliest step with the most annexations (the paper's epsilon_max), unless it is trivial.

    After it there are at least two concepts, and none holds more than half of the objects.

    Parameters
    ----------
    states : States
    step_ends, counts : (k,)
        As `Filtration.annexations` gives them.

    Returns
    -------
    float or None
        None where there is no such step.
    """
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
