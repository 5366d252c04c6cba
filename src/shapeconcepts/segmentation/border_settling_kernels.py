"""Kernel that lays borders along the lines where the surfaces on both sides meet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.segmentation.surface_fit_kernels import fit_surface, gather_surroundings

INVOLVED_SHARE = 0.3


@kernel
def settle_borders(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    labels: NDArray[np.int32],
    scale: float,
    smoothness: float,
    reach: float,
) -> NDArray[np.int32]:
    """Give every voxel at a crease to the side of the crease that it lies on.

    At a convex edge a point belongs to the surface that it is farther outside of, or less deep under; at a
    concave edge it is the other way round. The plane between both is the one that halves the angle through
    the solid, on either side of the surfaces, so that noise across them hardly matters. The nearest surface
    is the same one below a convex edge, but the other one above it, where noise lifts half of the voxels.
    It must be known that there is a crease: where both surfaces are one, the nearest is the safer choice (see
    `sharpen_borders`). Only regions that hold 30 % of a voxel's neighbours are considered: with fewer, it
    lies deep in its own. All voxels are judged by the labels given.

    Parameters
    ----------
    labels : (m,) int32
        Regions that meet at creases; -1 for none.
    scale : float
        Radius of the surroundings that surfaces are fitted to.
    smoothness : float
        Difference in height that outweighs it if all adjacent voxels are in the other region.
    reach : float
        By how much a voxel's new surface may pass farther away from it than its old one. Surfaces one behind
        the other do not meet, and keep their voxels.

    Returns
    -------
    (m,) int32
    """
    m = len(labels)
    workspace = np.empty((7, 7))
    stamps = np.zeros(m, np.int32)
    surroundings = np.empty(m, np.int32)
    stamp = 0
    settled = labels.copy()
    for i in range(m):
        own = labels[i]
        degree = indptr[i + 1] - indptr[i]
        if own < 0:
            continue
        same, own_x, own_y, own_z = _members(points, indptr, indices, labels, i, own)
        least = max(1.0, INVOLVED_SHARE * degree)
        if degree - same < least:
            continue
        own_count, own_height = -1, 0.0
        nx, ny, nz = 0.0, 0.0, 0.0
        n_around = 0
        largest = 0.0
        for k in range(indptr[i], indptr[i + 1]):
            region = labels[indices[k]]
            if region < 0 or region == own or _first_place(indptr, indices, labels, i, region) < k:
                continue
            agreeing, x, y, z = _members(points, indptr, indices, labels, i, region)
            if agreeing < least:
                continue
            if own_count < 0:
                stamp += 1
                n_around = gather_surroundings(points, indptr, indices, i, scale, stamps, stamp, surroundings)
                own_count, own_height, nx, ny, nz = fit_surface(
                    points,
                    normals,
                    labels,
                    own,
                    surroundings[:n_around],
                    points[i, 0],
                    points[i, 1],
                    points[i, 2],
                    scale,
                    workspace,
                )
            count, height, other_nx, other_ny, other_nz = fit_surface(
                points,
                normals,
                labels,
                region,
                surroundings[:n_around],
                points[i, 0],
                points[i, 1],
                points[i, 2],
                scale,
                workspace,
            )
            if own_count == 0 or count == 0 or abs(height) - abs(own_height) > reach:
                continue
            opening = (
                (nx - other_nx) * (own_x - x) + (ny - other_ny) * (own_y - y) + (nz - other_nz) * (own_z - z)
            )
            # Heights are the surfaces' above the voxel: it is farther outside of the lower one.
            gain = own_height - height if opening >= 0 else height - own_height
            gain += smoothness * (agreeing - same) / degree
            if gain > largest:
                largest = gain
                settled[i] = region
    return settled


@kernel
def _members(
    points: NDArray[np.float64],
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    labels: NDArray[np.int32],
    i: int,
    region: int,
) -> tuple[int, float, float, float]:
    """Number of a voxel's neighbours in a region, and their mean relative to the voxel; zero for none."""
    count = 0
    x, y, z = 0.0, 0.0, 0.0
    for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
        j = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
        if labels[j] == region:
            count += 1
            x += points[j, 0] - points[i, 0]
            y += points[j, 1] - points[i, 1]
            z += points[j, 2] - points[i, 2]
    share = 1 / max(count, 1)
    return count, x * share, y * share, z * share


@kernel
def _first_place(
    indptr: NDArray[np.int64], indices: NDArray[np.int32], labels: NDArray[np.int32], i: int, region: int
) -> int:
    """Where a voxel's neighbour list has its first member of a region."""
    place = indptr[i]
    while labels[indices[place]] != region:
        place += 1
    return place
