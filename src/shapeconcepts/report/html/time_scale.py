"""The axis of time that all figures of a report share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration

# Steps of an axis of odds in which annexations are counted.
N_STEPS = 60
_LAST_TIME = 0.9999


@dataclass(frozen=True)
class TimeScale:
    """Where a time stands on the axis, 0 to 1.

    Mean divergences of groups crowd at 1, where hardly anything is shared, and those of single objects near
    0: their axis is one of odds, what is not shared to what is, by ratio.

    Attributes
    ----------
    ends : (float, float) or None
        Times within which an axis of odds spreads; what is before the first is at 0, and after the second at
        1. None for a linear axis, from 0 to 1.
    """

    ends: tuple[float, float] | None

    @classmethod
    def of(cls, filtration: Filtration) -> TimeScale:
        """The scale that suits a filtration's heat."""
        times = filtration.times_
        if filtration.heat == "geodesic" or len(times) == 0:
            return cls(None)
        # Near-duplicates join next to time 0, and strangers next to 1: the axis does not stretch for them.
        first = min(0.8 * max(times[0], np.median(times) / 20), 0.5)
        last = max(times[times < _LAST_TIME].max(initial=0.0), 0.9)
        return cls((float(first), float(1 - 0.7 * (1 - last))))

    def positions(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions of times."""
        if self.ends is None:
            return times
        first, last = map(_log_odds, self.ends)
        inside = np.clip(times, *self.ends)
        return np.asarray((_log_odds(inside) - first) / (last - first))

    def times(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Times at positions; that at the end of the axis is 1."""
        if self.ends is None:
            return positions
        first, last = map(_log_odds, self.ends)
        times = 1 / (1 + np.exp(-(first + positions * (last - first))))
        return np.asarray(np.where(positions >= 1, 1.0, times))

    def radii(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distances of times from the middle of a disc, 1 for the begin of the axis.

        On a linear axis most of it happens late: the root gives the crowded middle more room.
        """
        left = 1 - self.positions(times)
        return np.asarray(0.06 + 0.94 * (np.sqrt(left) if self.ends is None else left))


def _log_odds(times: NDArray[np.float64] | float) -> NDArray[np.float64]:
    return np.log(times) - np.log1p(-np.asarray(times))


def annexation_counts(filtration: Filtration, scale: TimeScale) -> tuple[list[float], list[int]]:
    """Ends of the steps of time that a report shows, and annexations in each.

    The steps are those of the filtration where it counts in them itself or the axis is linear, else equal
    steps of the axis.
    """
    if scale.ends is None or filtration.stop == "annexations":
        step_ends, counts = filtration.annexations()
        return step_ends.tolist(), counts.tolist()
    steps = np.ceil(scale.positions(filtration.times_) * N_STEPS - 1e-9).astype(int) - 1
    step_ends = scale.times(np.arange(1, N_STEPS + 1) / N_STEPS)
    return step_ends.tolist(), np.bincount(steps.clip(0), minlength=N_STEPS).tolist()
