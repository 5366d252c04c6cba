"""Stray points: what a sensor sees beside the object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from shapeconcepts.neighbours import Neighbours

MIN_NEIGHBOURS = 4
MIN_COMPONENT_SHARE = 0.01


def stray_points(neighbours: Neighbours) -> NDArray[np.bool_]:
    """Mark points that hang in the air: with hardly any neighbour, or in a small group apart from the rest.

    Parameters
    ----------
    neighbours : Neighbours
        Lists over a radius of 3 voxels, in which a point of a surface has some 25.

    Returns
    -------
    (m,) bool
        True for a point with fewer than 4 neighbours, or in a connected component of less than 1 % of the points.
        The largest component is never stray.
    """
    m = len(neighbours.indptr) - 1
    lonely = np.diff(neighbours.indptr) < MIN_NEIGHBOURS
    graph = csr_array(
        (np.ones(len(neighbours.indices), np.int8), neighbours.indices, neighbours.indptr), shape=(m, m)
    )
    _, component = connected_components(graph, directed=False)
    size = np.bincount(component)
    stray = lonely | (size[component] < MIN_COMPONENT_SHARE * m)
    return np.zeros(m, bool) if stray.all() else stray
