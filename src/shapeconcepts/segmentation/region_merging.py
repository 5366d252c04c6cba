"""Small segments go to a neighbour, and the number of segments stays bounded."""

from __future__ import annotations

from heapq import heapify, heappop, heappush

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.segmentation.linkage_kernels import border_keys

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
    borders = border_lengths(adjacency, labels)
    members = labels >= 0
    size = np.bincount(labels[members], minlength=len(borders)).tolist()
    mass = np.bincount(labels[members], weights[members], minlength=len(borders)).tolist()
    min_mass = min_share * weights.sum()
    min_product = MIN_MEAN_SHARE**2 * weights.sum() * len(labels)

    def is_small(s: int) -> bool:
        return size[s] < min_voxels or (mass[s] < min_mass and mass[s] * size[s] < min_product)

    merged_into: dict[int, int] = {}
    alive = set(range(len(borders)))
    # Segments only grow: none becomes small again once all are large.
    for must_go in (is_small, lambda _: len(alive) > max_segments):
        queue = [(size[s], -s) for s in alive if must_go(s)]
        heapify(queue)
        while queue and len(alive) > 1:
            size_then, smallest = heappop(queue)
            smallest = -smallest
            if smallest not in alive or size[smallest] != size_then or not must_go(smallest):
                continue
            alive.remove(smallest)
            if not borders[smallest]:
                merged_into[smallest] = -1
                continue
            neighbour = max(borders[smallest], key=lambda s: (borders[smallest][s], -s))
            merged_into[smallest] = neighbour
            size[neighbour] += size[smallest]
            mass[neighbour] += mass[smallest]
            heappush(queue, (size[neighbour], -neighbour))
            for other, length in borders[smallest].items():
                del borders[other][smallest]
                if other != neighbour:
                    borders[neighbour][other] = borders[other][neighbour] = length + borders[neighbour].get(
                        other, 0
                    )
    ranked = sorted(alive, key=lambda s: (-size[s], s))
    rank = np.full(len(borders) + 1, -1, np.int32)
    rank[ranked] = np.arange(len(ranked))
    # Whoever a segment went to went on later, if at all.
    for segment, neighbour in reversed(merged_into.items()):
        rank[segment] = rank[neighbour]
    edges = [
        sorted((int(rank[a]), int(rank[b])))
        for a in ranked
        for b, length in borders[a].items()
        if a < b and length >= MIN_BORDER
    ]
    return rank[labels], np.array(sorted(edges), np.int32).reshape(-1, 2)


def border_lengths(adjacency: Neighbours, labels: NDArray[np.int32]) -> list[dict[int, int]]:
    """For each segment, its neighbours with the number of adjacent voxel pairs."""
    n = int(labels.max(initial=-1)) + 1
    borders: list[dict[int, int]] = [{} for _ in range(n)]
    keys, lengths = np.unique(border_keys(*adjacency, labels), return_counts=True)
    for key, length in zip(keys.tolist(), lengths.tolist(), strict=True):
        a, b = divmod(key, n)
        borders[a][b] = borders[b][a] = length
    return borders
