"""Times at which a filtration can be stopped, found without labels."""

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


def fair_numbers(n_objects: int) -> tuple[float, float]:
    """The fewest and the most concepts that are fair for n objects.

    0.9 sqrt(n) to 1.2 sqrt(n); in small sets n / 24 (but 3) to n / 8, where that is fewer. Never under 2.
    """
    root = np.sqrt(n_objects)
    most = max(min(1.2 * root, n_objects // 8), 2.0)
    return float(min(max(min(0.9 * root, max(n_objects / 24, 3.0)), 2.0), most)), float(most)


def longest_state(states: States) -> float | None:
    """Start of the state that lasts longest for its time, among those of a fair number of concepts.

    How long a grouping outlives the annexation that made it says how clearly its groups are apart. Coarse
    groupings outlive fine ones for no better reason than that fewer annexations are left, so only those with
    a fair number of concepts compete (see `fair_numbers`); if there are none, those nearest to it. The number
    of concepts first rises, as objects find each other, then falls; only the fall counts.

    Returns
    -------
    float or None
        None where there are never two concepts.
    """
    times = states.times
    # A state of several annexations at one time is there after the last of them.
    is_last = np.append(times[1:] > times[:-1], False) if len(times) else np.empty(0, bool)
    is_open = is_last & (states.n_concepts >= 2)
    if not is_open.any():
        return None
    # Before the concepts are most, objects still find each other, and most are in none.
    peak = np.flatnonzero(is_open & (states.n_concepts == states.n_concepts[is_open].max()))[-1]
    candidates = peak + np.flatnonzero(is_open[peak:])
    fewest, most = fair_numbers(states.n_objects)
    counts = states.n_concepts[candidates]
    outside = np.maximum(fewest - counts, counts - most).clip(0)
    candidates = candidates[outside == outside.min()]
    return float(times[candidates[np.argmax(times[candidates + 1] / times[candidates])]])


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
