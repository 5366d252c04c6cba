"""Places the vertices of a tree on a plane so that its branches can be told apart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order
from scipy.spatial import cKDTree

_NEAR = 3.0
_CELLS = 12


def lay_out_tree(edges: NDArray[np.integer], n_vertices: int) -> NDArray[np.float64]:
    """Positions of the vertices of a tree, where an edge is about 1 long.

    Every branch first gets a sector as wide as it has leaves, without any crossing (the equal-angle layout of
    phylogenetic trees); then vertices that repel each other along elastic edges spread into the empty room.

    Parameters
    ----------
    edges : (v - 1, 2) int
        Edges of the tree.
    n_vertices : int

    Returns
    -------
    (v, 2) float64
        Centred; the longer side lies along x. The same input gives the same bits.
    """
    if n_vertices < 2:
        return np.zeros((n_vertices, 2))
    # Complex numbers are vectors of the plane that need one operation where pairs need two.
    places = _equal_angles(edges, n_vertices) @ np.array([1, 1j])
    n_rounds = int(np.clip(100_000 // n_vertices, 30, 100))
    for i in range(n_rounds):
        if i % 4 == 0:
            far = _far_repulsion(places)
        force = _attraction(places, edges) + _near_repulsion(places) + far
        longest = 0.8 * (1 - i / n_rounds)
        places += force * np.minimum(0.3, longest / np.maximum(np.abs(force), 1e-12))
    return _along_x(np.stack([places.real, places.imag], axis=1))


def _equal_angles(edges: NDArray[np.integer], n_vertices: int) -> NDArray[np.float64]:
    shape = (n_vertices, n_vertices)
    adjacency = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape).tocsr()
    order, parents = breadth_first_order(adjacency, _middle(adjacency), directed=False)
    leaves = np.ones(n_vertices)
    has_child = np.zeros(n_vertices, bool)
    for vertex in order[:0:-1].tolist():
        parent = parents[vertex]
        leaves[parent] = leaves[parent] * has_child[parent] + leaves[vertex]
        has_child[parent] = True
    positions = np.zeros((n_vertices, 2))
    starts = np.zeros(n_vertices)
    per_leaf = 2 * np.pi / leaves[order[0]]
    for vertex in order[1:].tolist():
        parent = parents[vertex]
        width = leaves[vertex] * per_leaf
        angle = starts[parent] + width / 2
        positions[vertex] = positions[parent] + (np.cos(angle), np.sin(angle))
        starts[vertex] = starts[parent]
        starts[parent] += width
    return positions


def _middle(adjacency: coo_matrix) -> int:
    """Middle of the longest path."""
    far = breadth_first_order(adjacency, 0, directed=False)[0][-1]
    order, parents = breadth_first_order(adjacency, far, directed=False)
    path = [int(order[-1])]
    while parents[path[-1]] >= 0:
        path.append(int(parents[path[-1]]))
    return path[len(path) // 2]


def _attraction(places: NDArray[np.complex128], edges: NDArray[np.integer]) -> NDArray[np.complex128]:
    """Pulls the ends of every edge to a distance of 1."""
    along = places[edges[:, 1]] - places[edges[:, 0]]
    return _sums(edges, along * (1 - 1 / np.maximum(np.abs(along), 1e-6)), len(places))


def _near_repulsion(places: NDArray[np.complex128]) -> NDArray[np.complex128]:
    pairs = cKDTree(np.stack([places.real, places.imag], axis=1)).query_pairs(_NEAR, output_type="ndarray")
    apart = places[pairs[:, 1]] - places[pairs[:, 0]]
    squares = np.maximum(apart.real**2 + apart.imag**2, 0.01)
    return _sums(pairs, -0.35 * apart * (1 / squares - 1 / _NEAR**2), len(places))


def _far_repulsion(places: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Pushes every vertex away from the centres of the cells of a coarse grid."""
    side = max(float(np.ptp(places.real)), float(np.ptp(places.imag)))
    columns = np.minimum((places.real - places.real.min()) / side * _CELLS, _CELLS - 1).astype(np.int64)
    rows = np.minimum((places.imag - places.imag.min()) / side * _CELLS, _CELLS - 1).astype(np.int64)
    cell = columns * _CELLS + rows
    counts = np.bincount(cell)
    sums = np.bincount(cell, places.real) + 1j * np.bincount(cell, places.imag)
    used = counts > 0
    apart = places[:, None] - sums[used] / counts[used]
    softened = apart.real**2 + apart.imag**2 + max(_NEAR, side / _CELLS) ** 2
    return np.asarray(0.12 * (apart / softened) @ counts[used])


def _sums(pairs: NDArray[np.integer], forces: NDArray[np.complex128], n: int) -> NDArray[np.complex128]:
    """Total force on each vertex, where the first of a pair feels its force and the second the opposite."""
    first, second = pairs[:, 0], pairs[:, 1]
    along_x = np.bincount(first, forces.real, n) - np.bincount(second, forces.real, n)
    along_y = np.bincount(first, forces.imag, n) - np.bincount(second, forces.imag, n)
    return along_x + 1j * along_y


def _along_x(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    positions = positions - positions.mean(axis=0)
    axes = np.linalg.eigh(positions.T @ positions)[1][:, ::-1]
    # The sign of an eigenvector is left open.
    axes = axes * np.where(axes[np.abs(axes).argmax(axis=0), [0, 1]] < 0, -1.0, 1.0)
    turned = positions @ axes
    if np.ptp(turned[:, 1]) > np.ptp(turned[:, 0]):
        turned = turned[:, ::-1]
    return np.asarray(turned - (turned.min(axis=0) + turned.max(axis=0)) / 2)
