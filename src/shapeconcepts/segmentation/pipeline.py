"""From a scan to its surface segments."""

from __future__ import annotations

import numpy as np

from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.parameters import check_integer, check_length
from shapeconcepts.preparation import PreparedObject, prepare
from shapeconcepts.segmentation.region_merging import absorb_small
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.segmentation.super_patches import super_patches
from shapeconcepts.segmentation.supervoxel_kernels import closer_neighbours, inherit_patches, smooth_normals
from shapeconcepts.segmentation.supervoxels import supervoxels

ADJACENCY_RADIUS = 2.5
SMOOTHING_ANGLE = np.radians(25.0)
SMOOTHING_ROUNDS = 3
MIN_SHARE = 0.04
MIN_VOXELS = 25


def segment(
    scan: object,
    *,
    voxel_size: float | str = "auto",
    seed_size: float = 0.02,
    max_segments: int = 12,
) -> SegmentedObject:
    """Cut an object into its surface segments.

    Supervoxels (atomic patches) are joined to segments (super patches) where the surface goes on smoothly: a
    box gives one segment for each visible face, a can its side and its cap, a ball one. Segments of less than
    4 % of the scan's points or 25 voxels go to the neighbour with the longest border, except for surfaces at
    a grazing angle, which are larger than their points are many (see `absorb_small`). The result does not
    depend on the object's pose.

    Parameters
    ----------
    scan : Scan, (n, 3) array, object with `.points`, or PreparedObject
        A prepared object keeps its own voxels.
    voxel_size : float or "auto"
        Edge length of the voxels, metres; see `prepare`.
    seed_size : float
        Size of the atomic patches, metres; at least 4 voxels are used.
    max_segments : int
        Largest number of segments, at least 1. Above it the smallest is merged, repeatedly.

    Returns
    -------
    SegmentedObject

    Raises
    ------
    ScanError
        If the scan cannot be prepared.
    ValueError
        If a parameter is out of range.
    """
    seed_size = check_length("seed_size", seed_size)
    max_segments = check_integer("max_segments", max_segments, 1)
    prepared = scan if isinstance(scan, PreparedObject) else prepare(scan, voxel_size=voxel_size)
    points, voxel = prepared.points, prepared.voxel_size
    neighbours = prepared.neighbours
    adjacency = Neighbours(*closer_neighbours(points, *neighbours, ADJACENCY_RADIUS * voxel))

    normals = smooth_normals(
        points, prepared.normals, *neighbours, 2 * voxel, SMOOTHING_ANGLE, SMOOTHING_ROUNDS
    )
    patches = supervoxels(points, normals, adjacency, voxel, max(seed_size, 4 * voxel))
    regions = super_patches(points, normals, adjacency, patches, voxel)
    weights = np.bincount(prepared.point_to_voxel[prepared.point_to_voxel >= 0], minlength=len(points))
    segments, edges = absorb_small(adjacency, regions, weights, MIN_SHARE, MIN_VOXELS, max_segments)
    return SegmentedObject(
        points=points,
        normals=prepared.normals,
        patch_labels=inherit_patches(*adjacency, patches, segments),
        segment_labels=segments,
        segment_edges=edges,
        n_segments=int(segments.max(initial=-1)) + 1,
        point_to_voxel=prepared.point_to_voxel,
        voxel_size=voxel,
        viewpoint=prepared.viewpoint,
        name=prepared.name,
        label=prepared.label,
    )
