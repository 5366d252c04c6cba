"""What preparation makes of a scan: voxels with normals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.geometry.neighbours import Neighbours


@dataclass(frozen=True, eq=False)
class PreparedObject:
    """A scan as voxel-grid points with unit normals.

    Attributes
    ----------
    offsets : (m, 3) float64
        Mean of the scan points in each voxel, metres, relative to the origin: of these, numbers hold all
        digits wherever the scan is.
    origin : (3,) float64
        In the frame of the scan.
    normals : (m, 3) float64
        Unit normals, oriented towards the sensor.
    point_to_voxel : (n,) int32
        Row in `offsets` for each point of the scan, -1 for a dropped point: not measured, stray, or a copy of
        another one.
    neighbours : Neighbours
        Neighbours of each point within 3 voxels.
    voxel_size : float
        Edge length of the voxels, metres.
    viewpoint : (3,) float64 or None
        Position of the sensor, None where it is not known.
    name, label
        As in the scan.
    notices : tuple of str
        Those of the scan, and what its points say.
    """

    offsets: NDArray[np.float64]
    origin: NDArray[np.float64]
    normals: NDArray[np.float64]
    point_to_voxel: NDArray[np.int32]
    neighbours: Neighbours
    voxel_size: float
    viewpoint: NDArray[np.float64] | None = None
    name: str = ""
    label: str | None = None
    notices: tuple[str, ...] = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """Mean of the scan points in each voxel in the frame of the scan, (m, 3) float64."""
        return self.offsets + self.origin
