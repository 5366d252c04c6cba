"""How many concepts a filtration has over time, and when it has a given number of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration

_MOST_TIMES = 500


@dataclass(frozen=True, eq=False)
class ConceptNumbers:
    """Sizes of the groups of a filtration over time.

    Attributes
    ----------
    times : (k,) float64
        Times at which something changes, rising; of very many, 500 evenly chosen ones.
    sizes : list of (g,) int64
        Sizes of the groups of at least two objects from each of these times on.
    """

    times: NDArray[np.float64]
    sizes: list[NDArray[np.int64]]

    @classmethod
    def of(cls, filtration: Filtration) -> ConceptNumbers:
        """Go through the times of a filtration."""
        times = np.unique(filtration.times_)
        if len(times) > _MOST_TIMES:
            times = times[np.linspace(0, len(times) - 1, _MOST_TIMES).round().astype(int)]
        labels = [filtration.labels_at(float(time), 2) for time in times]
        sizes = [np.bincount(one[one >= 0]) for one in labels]
        return cls(times, sizes)

    def at_least(self, min_size: int) -> NDArray[np.int64]:
        """Number of groups of at least `min_size` objects from each time on, (k,) int64."""
        return np.array([(sizes >= min_size).sum() for sizes in self.sizes], np.int64)

    def time_of(self, number: int, min_size: int) -> float | None:
        """Latest time with `number` groups of at least `min_size` objects.

        Groups first become more, as objects find each other, and then fewer, as groups do. The later of
        two times with the same number has more of the objects in groups. Where several annexations at once
        skip the number, it is the time after them.

        Returns
        -------
        float or None
            None where there never are so many.
        """
        numbers = self.at_least(min_size)
        reached = np.flatnonzero(numbers >= number)
        if len(reached) == 0:
            return None
        last = reached[-1]
        if numbers[last] > number and last + 1 < len(numbers) and numbers[last + 1] > 0:
            last += 1
        return float(self.times[last]) if 0 < numbers[last] <= number else None
