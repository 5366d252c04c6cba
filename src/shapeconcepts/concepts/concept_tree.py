"""The tree of concepts: what the significant splits of a filtration leave apart, from coarse to fine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.topology.annexation_kernels import find
from shapeconcepts.topology.annexations import Annexations
from shapeconcepts.topology.groups import Groups

# Granularities among which the cut that lasts longest is looked for: groups that share a twelfth of what they
# are made of are hardly two, and those that share a quarter are hardly one.
COARSEST, FINEST = 1 / 12, 1 / 4


@dataclass(frozen=True, eq=False)
class ConceptTree:
    """Groups of objects, each either whole or split in two.

    Attributes
    ----------
    parents : (k,) int64
        The group that each annexes another one to form, -1 for none. Children come before their parents.
    births : (k,) float64
        When a group's parts join: mean divergence, bits.
    deaths : (k,) float64
        When it annexes another one or is annexed; infinite for those that nothing joins.
    p_values : (k,) float64
        Of the split into its two children; NaN where it has none.
    group_of_object : (n,) int64
        The smallest group that each object is in, -1 for none.
    """

    parents: NDArray[np.int64]
    births: NDArray[np.float64]
    deaths: NDArray[np.float64]
    p_values: NDArray[np.float64]
    group_of_object: NDArray[np.int64]

    @classmethod
    def of(
        cls, history: Annexations, splits: NDArray[np.bool_], p_values: NDArray[np.float64], min_size: int
    ) -> ConceptTree:
        """Tree of a filtration.

        Parameters
        ----------
        history : Annexations
        splits : (e,) bool
            Annexations of two groups that are apart.
        p_values : (e,) float64
        min_size : int
            Smallest number of objects of a group; smaller ones are none. They have nothing in common with
            any other.
        """
        space = history.space
        n_vertices = len(space.multiplicities_)
        # Where nothing is shared, nothing joins. These are the last annexations.
        joins = history.times < 1.0
        times = _times_of_splits(history, splits & joins & (history.dying_sizes >= min_size), min_size)
        split = np.flatnonzero(joins & ~np.isnan(times))
        joined = np.flatnonzero(joins & np.isnan(times))
        smallest = Groups.connected_by(history.edges[joined], n_vertices, space.vertices_)
        chosen = smallest.of_size(min_size)
        number_of = np.full(smallest.n_groups + 1, -1, np.int64)
        number_of[chosen] = np.arange(len(chosen))
        completed = np.zeros(smallest.n_groups)
        np.maximum.at(completed, smallest.of_vertex[history.edges[joined, 0]], history.times[joined])

        births, deaths = completed[chosen].tolist(), [np.inf] * len(chosen)
        parents, p_of = [-1] * len(chosen), [np.nan] * len(chosen)
        roots = np.arange(2 * len(chosen) + 1).astype(np.int32)
        for e in split[np.argsort(times[split], kind="stable")].tolist():
            new, time = len(parents), float(times[e])
            for vertex in history.edges[e]:
                child = int(find(roots, number_of[smallest.of_vertex[vertex]]))
                parents[child], deaths[child], births[child] = new, time, min(births[child], time)
                roots[child] = new
            parents.append(-1)
            births.append(time)
            deaths.append(np.inf)
            p_of.append(float(p_values[e]))
        return cls(
            np.array(parents, np.int64),
            np.array(births, float),
            np.array(deaths, float),
            np.array(p_of, float),
            number_of[smallest.of_object],
        )

    @property
    def persistence(self) -> NDArray[np.float64]:
        """How long each group lasts as it is, (k,) float64: the filtration ends at 1."""
        return np.minimum(self.deaths, 1.0) - self.births

    def children(self, group: int) -> list[int]:
        """The two groups that a group is split into, or none."""
        return np.flatnonzero(self.parents == group).tolist()

    def members(self, group: int) -> NDArray[np.int64]:
        """Objects of a group, rising."""
        inside = {group}
        for other in range(group, -1, -1):
            if int(self.parents[other]) in inside:
                inside.add(other)
        return np.flatnonzero(np.isin(self.group_of_object, sorted(inside)))

    def cut(self, granularity: float) -> NDArray[np.int64]:
        """The groups at a granularity.

        Parameters
        ----------
        granularity : float
            0 to 1: two groups are apart if their objects have less in common on average, as 1 minus their
            Jensen-Shannon divergence.

        Returns
        -------
        (c,) int64
            Rising.
        """
        divergence = 1.0 - granularity
        return np.flatnonzero((self._joined <= divergence) & (self.deaths > divergence))

    @property
    def granularities(self) -> NDArray[np.float64]:
        """Where the cut changes, rising: what the groups have in common that a split keeps apart."""
        return np.sort(1.0 - self.births[~np.isnan(self.p_values)])

    def most_persistent_granularity(self) -> float:
        """The middle of the longest stretch between a twelfth and a quarter in which the cut stays the same.

        A stretch is as long as its end is in multiples of its beginning; of equal ones it is the coarsest.
        """
        changes = self.granularities
        changes = changes[(changes > COARSEST) & (changes < FINEST)]
        ends = np.log([COARSEST, *changes, FINEST])
        longest = int(np.diff(ends).argmax())
        return float(np.exp(ends[longest : longest + 2].mean()))

    @property
    def _joined(self) -> NDArray[np.float64]:
        """From when on each group can be in a cut: when its children join, the smallest groups from 0 on."""
        return np.where(np.isnan(self.p_values), 0.0, self.births)


def _times_of_splits(
    history: Annexations, significant: NDArray[np.bool_], min_size: int
) -> NDArray[np.float64]:
    """When the groups at the ends of each edge stop being apart, (e,) float64; NaN where they never are.

    Where two groups are apart, a third one of the size of a concept that joins them later, as it diverges
    from them even more, is apart from both as long as they are from each other.
    """
    times = np.full(len(history.edges), np.nan)
    latest = np.zeros(len(history.space.multiplicities_))
    for e, (dying, surviving) in enumerate(zip(history.dying, history.surviving, strict=True)):
        within = max(latest[dying], latest[surviving])
        if significant[e]:
            times[e] = history.times[e]
        elif within > 0 and history.dying_sizes[e] >= min_size:
            times[e] = within
        latest[surviving] = max(within, 0.0 if np.isnan(times[e]) else times[e])
    return times
