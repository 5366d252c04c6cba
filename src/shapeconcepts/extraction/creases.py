"""Creases across an object, at which it may be two that touch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from shapeconcepts.extraction.pixel_grid import PixelGrid
from shapeconcepts.extraction.planar_cells_kernels import N_MOMENTS, cell_moments, fit_planes

# Pixels.
_CELL = 6
_LEAST_FULL = 0.6
# Cells of a part that is worth a word.
_FEWEST_CELLS = 8
# Between normals, from which on a concave edge parts what it is between.
_CREASED = np.cos(np.radians(25.0))


def have_creases(numbers: NDArray[np.int32], n: int, grid: PixelGrid) -> NDArray[np.bool_]:
    """Whether concave creases cut each object into several large parts, (n,) bool.

    Where two convex things touch there is a concave crease (Stein et al., "Object Partitioning using Local
    Convexity", CVPR 2014). The limbs of a teddy have them, too: only that it may be several can be said.

    Parameters
    ----------
    numbers : (h, w) int32
        Object of each pixel, -1 for none.
    n : int
    grid : PixelGrid
    """
    own = np.where((numbers >= 0)[:, :, None], grid.points, np.nan)
    moments = cell_moments(own, _CELL)
    rows, columns = moments.shape[:2]
    middle = numbers[_CELL // 2 :: _CELL, _CELL // 2 :: _CELL][:rows, :columns].ravel()
    flat = moments.reshape(-1, N_MOMENTS)
    cells = np.flatnonzero((flat[:, 0] >= _LEAST_FULL * _CELL**2) & (middle >= 0))
    several = np.zeros(n, bool)
    if not len(cells):
        return several
    planes, _ = fit_planes(flat[cells])
    means, normals = planes[:, :3], planes[:, 3:]
    normals *= np.sign(((grid.viewpoint - means) * normals).sum(axis=1))[:, None]
    position = np.full(len(flat), -1)
    position[cells] = np.arange(len(cells))
    place = position.reshape(rows, columns)
    pairs = np.concatenate(
        [
            np.stack([place[:, :-1].ravel(), place[:, 1:].ravel()], axis=1),
            np.stack([place[:-1].ravel(), place[1:].ravel()], axis=1),
        ]
    )
    pairs = pairs[(pairs >= 0).all(axis=1)]
    first, second = pairs[middle[cells][pairs[:, 0]] == middle[cells][pairs[:, 1]]].T
    along, turn = means[first] - means[second], normals[first] - normals[second]
    is_concave = (along * turn).sum(axis=1) < 0.0
    is_crease = is_concave & ((normals[first] * normals[second]).sum(axis=1) < _CREASED)
    links = (np.ones(int((~is_crease).sum())), (first[~is_crease], second[~is_crease]))
    n_parts, parts = connected_components(coo_matrix(links, shape=(len(cells), len(cells))), directed=False)
    object_of_part = np.zeros(n_parts, np.int64)
    object_of_part[parts] = middle[cells]
    is_large = np.bincount(parts, minlength=n_parts) >= _FEWEST_CELLS
    several[:] = np.bincount(object_of_part[is_large], minlength=n) > 1
    return several
