"""From a scan to its surface segments."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from sklearn.base import BaseEstimator

from shapeconcepts.geometry.neighbours import Neighbours
from shapeconcepts.parameters import check_parameters, choice, positive_number, share, whole_number
from shapeconcepts.preparation import PreparedObject, prepare
from shapeconcepts.segmentation.region_merging import absorb_small
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.segmentation.super_patches import super_patches
from shapeconcepts.segmentation.supervoxel_kernels import closer_neighbours, inherit_patches, smooth_normals
from shapeconcepts.segmentation.supervoxels import supervoxels

ADJACENCY_RADIUS = 2.5
# A hair more than 2: see NEIGHBOUR_RADIUS of the preparation.
SMOOTHING_RADIUS = 2.000002
SMOOTHING_ANGLE = np.radians(25.0)
SMOOTHING_ROUNDS = 3


class Segmenter(BaseEstimator):
    """Cuts objects into their surface segments.

    Supervoxels (atomic patches) are joined to segments (super patches) where the surface goes on smoothly: a
    box gives one segment for each visible face, a can its side and its cap, a ball one. Small segments go to
    the neighbour with the longest border. The result does not depend on the object's pose. There is nothing
    to fit.

    Parameters
    ----------
    voxel_size : float or "auto"
        Edge length of the voxels, metres; see `shapeconcepts.preparation.prepare`.
    seed_size : float
        Size of the atomic patches, metres; at least 4 voxels are used.
    max_segments : int
        Largest number of segments, at least 1. Above it the smallest is merged, repeatedly.
    min_share : float
        Share of the scan's points below which a segment is small, 0 to 1; except for surfaces at a grazing
        angle, which are larger than their points are many (see `absorb_small`).
    min_voxels : int
        Number of voxels below which a segment is small.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "voxel_size": [positive_number(), choice("auto")],
        "seed_size": [positive_number()],
        "max_segments": [whole_number(1)],
        "min_share": [share()],
        "min_voxels": [whole_number(0)],
    }

    def __init__(
        self,
        *,
        voxel_size: float | str = "auto",
        seed_size: float = 0.02,
        max_segments: int = 12,
        min_share: float = 0.04,
        min_voxels: int = 25,
    ) -> None:
        self.voxel_size = voxel_size
        self.seed_size = seed_size
        self.max_segments = max_segments
        self.min_share = min_share
        self.min_voxels = min_voxels

    def segment(self, scan: object) -> SegmentedObject:
        """Cut one object.

        Parameters
        ----------
        scan : Scan, (n, 3) array, object with `.points`, or PreparedObject
            A prepared object keeps its own voxels.

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
        check_parameters(self)
        prepared = scan if isinstance(scan, PreparedObject) else prepare(scan, voxel_size=self.voxel_size)
        points, voxel = prepared.offsets, prepared.voxel_size
        neighbours = prepared.neighbours
        adjacency = Neighbours(*closer_neighbours(points, *neighbours, ADJACENCY_RADIUS * voxel))

        normals = smooth_normals(
            points, prepared.normals, *neighbours, SMOOTHING_RADIUS * voxel, SMOOTHING_ANGLE, SMOOTHING_ROUNDS
        )
        patches = supervoxels(points, normals, adjacency, voxel, max(float(self.seed_size), 4 * voxel))
        regions = super_patches(points, normals, adjacency, patches, voxel)
        weights = np.bincount(prepared.point_to_voxel[prepared.point_to_voxel >= 0], minlength=len(points))
        segments, edges = absorb_small(
            adjacency, regions, weights, self.min_share, self.min_voxels, self.max_segments
        )
        return SegmentedObject(
            points=prepared.points,
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
            notices=prepared.notices,
        )


def segment(scan: object, **parameters: Any) -> SegmentedObject:
    """Cut an object into its surface segments.

    Parameters
    ----------
    scan : Scan, (n, 3) array, object with `.points`, or PreparedObject
    **parameters
        Those of `Segmenter`: `voxel_size`, `seed_size`, `max_segments` and so on.

    Returns, raises
    ---------------
    As `Segmenter.segment`.
    """
    return Segmenter(**parameters).segment(scan)
