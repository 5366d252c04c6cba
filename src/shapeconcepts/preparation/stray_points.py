"""Stray points: what a sensor sees beside the object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.preparation.component_kernels import connected_components

MIN_NEIGHBOURS = 3
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
        True for a point with fewer than 3 neighbours, or in a connected component of less than 1 % of the
        points. Where that would be all of them, none is stray.
    """
    m = len(neighbours.indptr) - 1
    lonely = np.diff(neighbours.indptr) < MIN_NEIGHBOURS
    component = connected_components(neighbours.indptr, neighbours.indices)
    size = np.bincount(component)
    stray = lonely | (size[component] < MIN_COMPONENT_SHARE * m)
    return np.zeros(m, bool) if stray.all() else stray
