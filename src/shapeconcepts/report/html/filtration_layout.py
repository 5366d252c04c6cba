"""Places the filtration graph F around the classes that outlive all others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Classes that are left, on the way from the middle to the last that was annexed.
_INNER = 0.6


def lay_out_filtration(
    annexations: NDArray[np.integer], death_radii: NDArray[np.float64], n_vertices: int
) -> NDArray[np.float64]:
    """Positions in the unit disc: the later a class dies, the closer it is to the middle.

    A class dies before the one that annexed it, so F runs inwards everywhere, and a circle around the middle
    is a time: what it cuts off are the classes that are alive then.

    Parameters
    ----------
    annexations : (e, 2) int
        Class that dies, and class that it dies into, in the order of time.
    death_radii : (e,) float64
        Distance from the middle of the time of each annexation, falling.
    n_vertices : int

    Returns
    -------
    (v, 2) float64
        The last class is in the middle; several that are left are on a circle around it, each before the
        classes that it annexed.
    """
    leaves = np.ones(n_vertices)
    has_child = np.zeros(n_vertices, bool)
    for dying, surviving in annexations.tolist():
        leaves[surviving] = leaves[surviving] * has_child[surviving] + leaves[dying]
        has_child[surviving] = True
    is_last = np.ones(n_vertices, bool)
    is_last[annexations[:, 0]] = False
    roots = np.flatnonzero(is_last)
    per_leaf = 2 * np.pi / max(float(leaves[roots].sum()), 1.0)
    starts, angles = np.zeros(n_vertices), np.zeros(n_vertices)
    starts[roots] = (np.cumsum(leaves[roots]) - leaves[roots]) * per_leaf
    angles[roots] = starts[roots] + leaves[roots] * per_leaf / 2
    # A class is placed after its survivor, which dies later.
    for dying, surviving in annexations[::-1].tolist():
        angles[dying] = starts[surviving] + leaves[dying] * per_leaf / 2
        starts[dying] = starts[surviving]
        starts[surviving] += leaves[dying] * per_leaf
    radii = np.full(n_vertices, _INNER * death_radii.min(initial=1.0) if len(roots) > 1 else 0.0)
    radii[annexations[:, 0]] = death_radii
    return radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
