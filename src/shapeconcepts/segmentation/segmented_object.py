"""A prepared object cut into surface segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class SegmentedObject:
    """An object as a graph of surface segments (paper: super patches made of atomic patches).

    Attributes
    ----------
    points : (m, 3) float64
        Voxel-grid points, metres, in the frame of the scan.
    normals : (m, 3) float64
        Unit normals, oriented towards the sensor.
    patch_labels : (m,) int32
        Atomic patch (supervoxel) of each point, -1 for none.
    segment_labels : (m,) int32
        Segment of each point, 0 to `n_segments` - 1 in the order of falling size, -1 for none.
    segment_edges : (e, 2) int32
        Pairs of neighbouring segments, the smaller index first, sorted.
    n_segments : int
        Number of segments.
    point_to_voxel : (n,) int32
        Row in `points` for each point of the scan, -1 for a dropped point.
    voxel_size : float
        Edge length of the voxels, metres.
    viewpoint : (3,) float64 or None
        Position of the sensor, None where it is not known.
    name, label
        As in the scan.
    notices : tuple of str
        What should be looked at, such as a field that could not be read, see `Scan.notices`.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    patch_labels: NDArray[np.int32]
    segment_labels: NDArray[np.int32]
    segment_edges: NDArray[np.int32]
    n_segments: int
    point_to_voxel: NDArray[np.int32]
    voxel_size: float
    viewpoint: NDArray[np.float64] | None = None
    name: str = ""
    label: str | None = None
    notices: tuple[str, ...] = ()
