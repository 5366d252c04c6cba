"""All groups of a tree of concepts, and those that formed within them before, coarse to fine."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.concept_tree import ConceptTree
from shapeconcepts.topology.annexation_kernels import find
from shapeconcepts.topology.annexations import Annexations


class GroupTree(NamedTuple):
    """Groups within groups: those that significant splits leave apart, then what formed within, latest first.

    A split that is not significant does not make two concepts, but the groups on its sides still tell objects
    apart.

    Attributes
    ----------
    parents : (k,) int64
        The group that each is a part of, -1 for none. Parents come before their parts.
    group_of_object : (n,) int64
        The smallest group that each object is in, -1 for none.
    """

    parents: NDArray[np.int64]
    group_of_object: NDArray[np.int64]

    @classmethod
    def below(cls, tree: ConceptTree, history: Annexations, min_size: int) -> GroupTree:
        """Groups of a tree of concepts, and all of at least `min_size` objects that formed within them."""
        n_coarse, vertices, sizes = (
            len(tree.parents),
            history.space.vertices_,
            history.space.multiplicities_.tolist(),
        )
        parents = [n_coarse - 1 - parent if parent >= 0 else -1 for parent in tree.parents[::-1].tolist()]
        concept_group = np.full(len(sizes), -1, np.int64)
        is_in_group = tree.group_of_object >= 0
        concept_group[vertices[is_in_group]] = n_coarse - 1 - tree.group_of_object[is_in_group]

        # Every class that forms: its size, the smallest group of the tree it is in, the class that it joins.
        group_of, joins = concept_group.tolist(), [-1] * len(sizes)
        class_of, roots = list(range(len(sizes))), np.arange(len(sizes)).astype(np.int32)
        for edge in history.edges[_are_within(history.edges, concept_group)]:
            first, second = (int(find(roots, vertex)) for vertex in edge)
            for root in (first, second):
                joins[class_of[root]] = len(joins)
            sizes.append(sizes[class_of[first]] + sizes[class_of[second]])
            group_of.append(group_of[class_of[first]])
            joins.append(-1)
            class_of[first] = len(joins) - 1
            roots[second] = first
        # Latest first: the last class of a smallest group is this group itself.
        for one in range(len(joins) - 1, -1, -1):
            if joins[one] >= 0:
                group_of[one] = group_of[joins[one]]
                if sizes[one] >= min_size:
                    parents.append(group_of[one])
                    group_of[one] = len(parents) - 1
        # The last entry is for objects without a place, whose vertex is -1.
        of_vertex = np.array([*group_of[: len(class_of)], -1], np.int64)
        return cls(np.array(parents, np.int64), of_vertex[vertices])

    def coarsest(self, n_groups: int) -> GroupTree:
        """The first groups only."""
        smallest = self.group_of_object
        while (smallest >= n_groups).any():
            smallest = np.where(smallest >= n_groups, self.parents[smallest], smallest)
        return GroupTree(self.parents[:n_groups], smallest)

    def mean_distances(
        self, distances: NDArray[np.float64], members: NDArray[np.int64], own: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Mean distance to the members of each group (paper: equation 3, coarse to fine).

        Parameters
        ----------
        distances : (m, p) float64
            Of each scan to the objects that are in a group.
        members : (p,) int64
            Which objects these are, rising.
        own : (m,) int64
            Which of these objects each scan is itself, -1 for none: it does not count in its own means.

        Returns
        -------
        (m, k) float64
            NaN in the row of a scan without any distance. Where none of a group's members is among these
            objects, the mean of the smallest larger group with one.
        """
        n_groups = len(self.parents)
        smallest = self.group_of_object[members]
        members, distances = members[smallest >= 0], distances[:, smallest >= 0]
        smallest = smallest[smallest >= 0]
        # Row by row: summed over a matrix, the rounding of a row would depend on how many there are.
        sums = [np.bincount(smallest, row, n_groups) for row in distances]
        means = np.array(sums, np.float64).reshape(len(distances), n_groups)
        counts = np.tile(np.bincount(smallest, minlength=n_groups), (len(distances), 1))
        own_group = np.where(np.isin(own, members), np.append(self.group_of_object, -1)[own], -1)
        counts[own_group >= 0, own_group[own_group >= 0]] -= 1
        for group in range(n_groups - 1, -1, -1):
            parent = self.parents[group]
            if parent >= 0:
                means[:, parent] += means[:, group]
                counts[:, parent] += counts[:, group]
        with np.errstate(invalid="ignore"):
            means /= np.where(counts > 0, counts, np.nan)
        for group, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                means[:, group] = np.where(counts[:, group] > 0, means[:, group], means[:, parent])
        return means


def _are_within(edges: NDArray[np.int32], concept_group: NDArray[np.int64]) -> NDArray[np.bool_]:
    ends = concept_group[edges]
    return (ends[:, 0] == ends[:, 1]) & (ends[:, 0] >= 0)
