"""The axis of time that all figures of a report share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration

# Steps of a logarithmic axis in which annexations are counted.
N_STEPS = 60


@dataclass(frozen=True)
class TimeScale:
    """Where a time stands on the axis, 0 to 1.

    Separations of classes are told apart by their ratio, as lifetimes are: their axis is logarithmic.

    Attributes
    ----------
    start : float or None
        Time at which a logarithmic axis begins; None for a linear axis, from 0.
    """

    start: float | None

    @classmethod
    def of(cls, filtration: Filtration) -> TimeScale:
        """The scale that suits a filtration's heat."""
        if filtration.heat == "geodesic" or len(filtration.times_) == 0:
            return cls(None)
        # Near-duplicates join next to time 0: the axis does not stretch for them.
        first = max(filtration.times_[0], np.median(filtration.times_) / 20)
        return cls(float(0.8 * first))

    def positions(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions of times; all before the start of the axis are at 0."""
        if self.start is None:
            return times
        return np.asarray(1 - np.log(np.maximum(times, self.start)) / np.log(self.start))

    def times(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Times at positions."""
        return positions if self.start is None else np.asarray(self.start ** (1 - positions))

    def radii(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distances of times from the middle of a disc, 1 for the begin of the axis.

        On a linear axis most of it happens late: the root gives the crowded middle more room.
        """
        left = 1 - self.positions(times)
        return np.asarray(0.06 + 0.94 * (np.sqrt(left) if self.start is None else left))


def annexation_counts(filtration: Filtration, scale: TimeScale) -> tuple[list[float], list[int]]:
    """Ends of the steps of time that a report shows, and annexations in each.

    The steps are those of the filtration where it counts in them itself or the axis is linear, else equal
    steps of the axis.
    """
    if scale.start is None or filtration.stop == "annexations":
        step_ends, counts = filtration.annexations()
        return step_ends.tolist(), counts.tolist()
    steps = np.ceil(scale.positions(filtration.times_) * N_STEPS - 1e-9).astype(int) - 1
    step_ends = scale.times(np.arange(1, N_STEPS + 1) / N_STEPS)
    return step_ends.tolist(), np.bincount(steps.clip(0), minlength=N_STEPS).tolist()
