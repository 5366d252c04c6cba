"""From groups of vertices of a topological space to concepts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.medoid_kernels import medoids_of_groups
from shapeconcepts.topology.groups import Groups, members_of_groups
from shapeconcepts.topology.space import TopologicalSpace


def concepts_of_groups(
    space: TopologicalSpace,
    groups: Groups,
    chosen: NDArray[np.int64],
    births: NDArray[np.float64],
    deaths: NDArray[np.float64],
) -> list[Concept]:
    """Concepts of the chosen groups of a space's vertices, in this order.

    Parameters
    ----------
    space : TopologicalSpace
        Fitted.
    groups : Groups
    chosen : (k,) int64
        Groups with at least one object.
    births, deaths : (n_groups,) float64
    """
    members, starts = members_of_groups(groups.of_object, groups.n_groups)
    medoids = _medoids(space, chosen, *members_of_groups(groups.of_vertex, groups.n_groups))
    return [
        Concept(members[starts[k] : starts[k + 1]], medoid, float(births[k]), float(deaths[k]))
        for k, medoid in zip(chosen.tolist(), medoids.tolist(), strict=True)
    ]


def concepts_of_members(
    space: TopologicalSpace,
    members: Sequence[NDArray[np.int64]],
    births: NDArray[np.float64],
    deaths: NDArray[np.float64],
) -> list[Concept]:
    """Concepts of groups that are given by their objects; all objects at one place are in the same group.

    Parameters
    ----------
    space : TopologicalSpace
        Fitted.
    members : sequence of (k,) int64
        Objects of each group, at least one.
    births, deaths : (n_groups,) float64
    """
    of_vertex = np.full(len(space.multiplicities_), -1, np.int32)
    of_object = np.full(len(space.vertices_), -1, np.int32)
    for group, objects in enumerate(members):
        of_object[objects] = of_vertex[space.vertices_[objects]] = group
    groups = Groups(len(members), of_vertex, of_object)
    return concepts_of_groups(space, groups, np.arange(len(members)), births, deaths)


def _medoids(
    space: TopologicalSpace,
    groups: NDArray[np.int64],
    vertices: NDArray[np.int64],
    starts: NDArray[np.int64],
) -> NDArray[np.int64]:
    """First object at each group's place of smallest mean divergence to the group's objects."""
    rows = space.rows_
    places = medoids_of_groups(
        rows.indptr.astype(np.int64),
        rows.indices.astype(np.int32),
        rows.data,
        rows.shape[1],
        space.multiplicities_,
        vertices,
        starts,
        groups,
    )
    objects, object_starts = members_of_groups(space.vertices_, rows.shape[0])
    return objects[object_starts[places]]
