"""Annexations: what becomes of the classes of a space while edges of its tree enter, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.topology.annexation_kernels import annex
from shapeconcepts.topology.groups import Groups, members_of_groups
from shapeconcepts.topology.space import TopologicalSpace

if TYPE_CHECKING:
    import networkx


def order_by_centrality(space: TopologicalSpace) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Edges of a space's tree from its leaves to its centre, and when they enter, rising, in (0, 1].

    An edge enters the later, the hotter it is (paper: equation 2, edge heat as time).
    """
    order = np.argsort(space.edge_heat_, kind="stable")
    heat = space.edge_heat_[order]
    if len(heat) == 0 or heat.min() == heat.max():
        return order, np.ones(len(heat))
    smallest, coldest = heat[heat > 0].min(), heat.min()
    return order, (heat - coldest + smallest) / (heat.max() - coldest + smallest)


@dataclass(frozen=True, eq=False)
class Annexations:
    """Classes that annex each other: at each edge the one of fewer objects dies, or the later one of equals.

    Attributes
    ----------
    space : TopologicalSpace
    edges : (e, 2) int32
        Edges of a forest in the order in which they enter.
    times : (e,) float64
        When they do, rising.
    dying, surviving : (e,) int32
        Representatives: each class keeps the vertex that it started with.
    dying_sizes, surviving_sizes : (e,) int64
        Objects in them just before.
    """

    space: TopologicalSpace
    edges: NDArray[np.int32]
    times: NDArray[np.float64]
    dying: NDArray[np.int32]
    surviving: NDArray[np.int32]
    dying_sizes: NDArray[np.int64]
    surviving_sizes: NDArray[np.int64]

    @classmethod
    def along(
        cls, space: TopologicalSpace, edges: NDArray[np.int32], times: NDArray[np.float64]
    ) -> Annexations:
        """Let edges enter."""
        return cls(space, edges, times, *annex(edges, space.multiplicities_))

    def n_steps(self, max_steps: int) -> int:
        """Number of equal steps of time: as many as the first annexation fits into 1, at most `max_steps`."""
        if len(self.times) == 0:
            return 1
        # Without the hair, rounding would add a step where the first time is an exact fraction.
        return int(min(max_steps, np.ceil(1 / self.times[0] - 1e-9)))

    def per_step(self, max_steps: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """End of each step of time, and annexations after the end of the step before and up to this one."""
        n_steps = self.n_steps(max_steps)
        steps = np.clip(np.ceil(self.times * n_steps - 1e-9).astype(np.int64) - 1, 0, n_steps - 1)
        return np.arange(1, n_steps + 1) / n_steps, np.bincount(steps, minlength=n_steps)

    def diagram(self) -> NDArray[np.float64]:
        """Persistence diagram of homology group 0, (v, 2) float64, births and deaths.

        The class of each vertex is born at 0; one that is left in the end never dies: its death is infinite.
        """
        diagram = np.zeros((len(self.space.multiplicities_), 2))
        diagram[:, 1] = np.inf
        diagram[self.dying, 1] = self.times
        return diagram

    def graph(self) -> networkx.DiGraph:
        """Filtration graph F: an edge from each class that dies to the one that annexes it.

        Vertices have `objects` (rows at this place), edges `time`.
        """
        # A fifth of a second to import, which nothing else here needs.
        import networkx

        graph = networkx.DiGraph()
        objects, starts = members_of_groups(self.space.vertices_, len(self.space.multiplicities_))
        for vertex, (start, end) in enumerate(pairwise(starts)):
            graph.add_node(vertex, objects=objects[start:end].tolist())
        for dying, surviving, time in zip(
            self.dying.tolist(), self.surviving.tolist(), self.times.tolist(), strict=True
        ):
            graph.add_edge(dying, surviving, time=time)
        return graph

    def n_before(self, time: float) -> int:
        """Number of edges that have entered by a time."""
        return int(np.searchsorted(self.times, time, side="right"))

    def groups_at(self, time: float) -> Groups:
        """What the edges that have entered by a time connect."""
        joined = self.edges[: self.n_before(time)]
        return Groups.connected_by(joined, len(self.space.multiplicities_), self.space.vertices_)

    def lives(self, groups: Groups, time: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Birth and death of each of the groups at a time, (n_groups,) float64.

        The last time of an edge within a group, 0 without any; the first of one that leaves it, infinite
        without any.
        """
        n_joined = self.n_before(time)
        births = np.zeros(groups.n_groups)
        np.maximum.at(births, groups.of_vertex[self.edges[:n_joined, 0]], self.times[:n_joined])
        deaths = np.full(groups.n_groups, np.inf)
        for end in self.edges[n_joined:].T:
            np.minimum.at(deaths, groups.of_vertex[end], self.times[n_joined:])
        return births, deaths
