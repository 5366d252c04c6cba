"""A shape concept: objects that belong together in a filtration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(eq=False)
class Concept:
    """A group of objects at a time of a filtration (paper: a connected component of the filtration graph).

    Attributes
    ----------
    members : (k,) int64
        Objects, as rows of the matrix that was filtered, rising. They are the concept's prototypes.
    medoid : int
        The member of the smallest mean Jensen-Shannon divergence to all members; of more than 256 places, to
        those at 50 of them.
    birth : float
        Time of the annexation that completed the group, in [0, 1]; 0 where all members are at one place.
    death : float
        Time at which it annexes or is annexed next; infinite where it is the last.
    name : str
        What the user calls it; empty until then.
    key : int
        Its identity in a model, which lives through updates; -1 until there is one.
    """

    members: NDArray[np.int64]
    medoid: int
    birth: float
    death: float
    name: str = ""
    key: int = -1

    @property
    def size(self) -> int:
        """Number of members."""
        return len(self.members)

    @property
    def lifetime(self) -> float:
        """How long the group lasts as it is: the filtration ends at 1."""
        return min(self.death, 1.0) - self.birth
