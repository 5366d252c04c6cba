"""Small segments go to a neighbour, and the number of segments stays bounded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.segmentation.linkage_kernels import border_lengths

MIN_BORDER = 4
MIN_MEAN_SHARE = 0.05


def absorb_small(
    adjacency: Neighbours,
    labels: NDArray[np.int32],
    weights: NDArray[np.int64],
    min_share: float,
    min_voxels: int,
    max_segments: int,
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Merge the smallest segment over its longest border, again and again: until all are large and few.

    A segment without a neighbour is dropped (-1), but never the last one.

    Parameters
    ----------
    labels : (m,) int32
        Segments 0 to n - 1, -1 for none.
    weights : (m,) int64
        Number of scan points in each voxel.
    min_share : float
        Share of the scan points below which a segment is merged. A surface seen at a grazing angle holds few
        points for its size, so it is kept nevertheless if the geometric mean of its shares of the points and
        of the voxels is 5 % or more.
    min_voxels : int
        Number of voxels below which a segment is merged.
    max_segments : int

    Returns
    -------
    segments : (m,) int32
        Segments numbered in the order of falling size, -1 for none.
    edges : (e, 2) int32
        Pairs of segments that share a border of at least 4 adjacent voxel pairs.
    """
    border = border_lengths(*adjacency, labels)
    members = labels >= 0
    size = np.bincount(labels[members], minlength=len(border))
    mass = np.bincount(labels[members], weights[members], minlength=len(border))
    min_mass = min_share * weights.sum()
    min_product = MIN_MEAN_SHARE**2 * weights.sum() * len(labels)
    target = np.arange(len(border))
    alive = list(range(len(border)))
    while len(alive) > 1:
        small = [
            s
            for s in alive
            if size[s] < min_voxels or (mass[s] < min_mass and mass[s] * size[s] < min_product)
        ]
        if not small and len(alive) <= max_segments:
            break
        smallest = min(small or alive, key=lambda s: (size[s], -s))
        alive.remove(smallest)
        neighbour = int(np.argmax(border[smallest]))
        if border[smallest, neighbour] == 0:
            target[target == smallest] = -1
            continue
        target[target == smallest] = neighbour
        size[neighbour] += size[smallest]
        mass[neighbour] += mass[smallest]
        border[neighbour] += border[smallest]
        border[:, neighbour] += border[:, smallest]
        border[neighbour, neighbour] = 0
        border[smallest] = border[:, smallest] = 0
    ranked = sorted(alive, key=lambda s: (-size[s], s))
    rank = np.full(len(border) + 1, -1, np.int32)
    rank[ranked] = np.arange(len(ranked))
    edges = np.argwhere(np.triu(border[np.ix_(ranked, ranked)] >= MIN_BORDER))
    return rank[np.append(target, -1)[labels]], edges.astype(np.int32)
