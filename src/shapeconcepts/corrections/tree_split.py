"""Where a concept falls into two along the tree of the filtration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.group_tree import GroupTree

# A part with a smaller share is what joined late, rather than one of two kinds.
_LEAST_SHARE = 0.1


def parts_along_tree(
    tree: GroupTree, members: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Two groups of the tree that some objects are in, from coarse to fine the first two of some size.

    Both have a tenth of the objects at least; where no two have, they are those whose smaller one is largest.

    Parameters
    ----------
    tree : GroupTree
    members : (m,) int64
        Objects.

    Returns
    -------
    two arrays of int64, or None
        The objects of each, the larger group first; some may be in neither. None if no group of the tree
        holds only some of them.
    """
    n_groups = len(tree.parents)
    counts = np.zeros(n_groups + 1, np.int64)
    np.add.at(counts, tree.group_of_object[members], 1)
    own = counts[:-1].copy()
    for group in range(n_groups - 1, -1, -1):
        if tree.parents[group] >= 0:
            own[tree.parents[group]] += own[group]
    by_parent: dict[int, list[int]] = {}
    for group in np.flatnonzero(own).tolist():
        by_parent.setdefault(int(tree.parents[group]), []).append(group)
    best: tuple[int, int] | None = None
    # Parents come before their parts: coarse to fine.
    for parent in sorted(by_parent):
        parts = sorted(by_parent[parent], key=lambda group: (-own[group], group))[:2]
        if len(parts) < 2:
            continue
        if best is None or own[parts[1]] > own[best[1]]:
            best = parts[0], parts[1]
        if own[parts[1]] >= _LEAST_SHARE * len(members):
            best = parts[0], parts[1]
            break
    if best is None:
        return None
    first, second = (members[_is_within(tree, group)[members]] for group in best)
    return first, second


def _is_within(tree: GroupTree, group: int) -> NDArray[np.bool_]:
    """Which objects are in a group or in a part of it."""
    is_inside = np.zeros(len(tree.parents) + 1, bool)
    is_inside[group] = True
    for other in range(group + 1, len(tree.parents)):
        is_inside[other] = tree.parents[other] >= 0 and is_inside[tree.parents[other]]
    inside: NDArray[np.bool_] = is_inside[tree.group_of_object]
    return inside
