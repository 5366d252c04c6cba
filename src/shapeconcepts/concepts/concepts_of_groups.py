"""From groups of the objects in a topological space to concepts."""

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
    of_chosen = [members[starts[k] : starts[k + 1]] for k in chosen.tolist()]
    return concepts_of_members(space, of_chosen, births[chosen], deaths[chosen])


def concepts_of_members(
    space: TopologicalSpace,
    members: Sequence[NDArray[np.int64]],
    births: NDArray[np.float64],
    deaths: NDArray[np.float64],
) -> list[Concept]:
    """Concepts of groups that are given by their objects; an object may be in several.

    Parameters
    ----------
    space : TopologicalSpace
        Fitted.
    members : sequence of (k,) int64
        Objects of each group, at least one; all that are at one place, or none of them.
    births, deaths : (n_groups,) float64
    """
    return [
        Concept(objects, medoid, birth, death)
        for objects, medoid, birth, death in zip(
            members, _medoids(space, members), births.tolist(), deaths.tolist(), strict=True
        )
    ]


def _medoids(space: TopologicalSpace, members: Sequence[NDArray[np.int64]]) -> list[int]:
    """First object at each group's place of smallest mean divergence to the group's objects."""
    if not members:
        return []
    rows = space.rows_
    groups = np.arange(len(members))
    of_group = np.repeat(groups, [len(objects) for objects in members])
    places = np.unique(of_group * rows.shape[0] + space.vertices_[np.concatenate(members)])
    group_of, vertices = np.divmod(places, rows.shape[0])
    medoids = medoids_of_groups(
        rows.indptr.astype(np.int64),
        rows.indices.astype(np.int32),
        rows.data,
        rows.shape[1],
        space.multiplicities_,
        vertices,
        np.searchsorted(group_of, np.arange(len(members) + 1)),
        groups,
    )
    objects, starts = members_of_groups(space.vertices_, rows.shape[0])
    return objects[starts[medoids]].tolist()
