"""Atomic patches: supervoxels after Papon et al., *Voxel Cloud Connectivity Segmentation*, CVPR 2013."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.canonical_frame import canonical_coordinates
from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.preparation.voxel_grid import cell_keys
from shapeconcepts.segmentation.supervoxel_kernels import central_voxels, grow_supervoxels

NORMAL_WEIGHT = 4.0
MIN_SEED_VOXELS = 3


def supervoxels(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    adjacency: Neighbours,
    voxel_size: float,
    seed_size: float,
) -> NDArray[np.int32]:
    """Cut a surface into patches of about `seed_size` that follow its creases.

    Parameters
    ----------
    points, normals : (m, 3) float64
        Voxel-grid points and unit normals.
    adjacency : Neighbours
        Adjacent voxels.
    voxel_size, seed_size : float
        Edge lengths of the voxel grid and of the grid of seeds, metres.

    Returns
    -------
    (m,) int32
        Patch of each voxel, -1 where none reached it.
    """
    seeds = _seed_voxels(points, seed_size)
    rounds = int(min(1.8 * seed_size / voxel_size, len(points))) + 1
    first = grow_supervoxels(points, normals, *adjacency, seeds, seed_size, NORMAL_WEIGHT, rounds)
    centres = central_voxels(points, first, seeds)
    return grow_supervoxels(points, normals, *adjacency, centres, seed_size, NORMAL_WEIGHT, rounds)


def _seed_voxels(points: NDArray[np.float64], seed_size: float) -> NDArray[np.int64]:
    """The voxel nearest to the centroid of each cell of the seed grid, if the cell has 3 voxels at least."""
    keys = cell_keys(canonical_coordinates(points), seed_size)
    _, cells, counts = np.unique(keys, return_inverse=True, return_counts=True)
    nearest = central_voxels(points, cells.astype(np.int32), np.zeros(len(counts), np.int64))
    populated = counts >= MIN_SEED_VOXELS
    return nearest[populated] if populated.any() else nearest
