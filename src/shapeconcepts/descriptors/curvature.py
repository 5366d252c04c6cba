"""Principal curvatures: how strongly the surface bends around each point, and which way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from shapeconcepts.descriptors.curvature_kernels import N_BINS, curvature_histograms, principal_curvatures
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.segment_kernels import size_of_segments
from shapeconcepts.descriptors.segment_labels import checked_labels
from shapeconcepts.geometry.neighbours import cell_grid
from shapeconcepts.geometry.surface import checked_surface
from shapeconcepts.parameters import check_parameters, positive_number
from shapeconcepts.segmentation.segmented_object import SegmentedObject

# Least and largest radius. Fewer voxels say little against noise; more take longer than they tell.
_VOXELS = (2.0, 6.0)


@dataclass
class Curvature(BaseEstimator):
    """Descriptor of segments by the two principal curvatures at their points (Koenderink, van Doorn 1992).

    The object's size, the root mean square distance of the points in segments from their centroid, is the
    measure of both the neighbourhood and the curvature, so that a small and a large ball are alike. The
    histogram has 11 places for each of the two, from -3 to 3 on the scale of asinh, finer around 0; beyond
    this it counts as the last. With the larger of both first, that makes 66 bins. A point counts in the four
    bins around it, the more, the closer they are: noise moves the histogram a little, never by a whole bin.

    Parameters
    ----------
    radius : float
        Radius of a point's neighbourhood, in parts of the object's size; 2 to 6 voxels are used.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {"radius": [positive_number()]}
    n_bins: ClassVar[int] = N_BINS

    radius: float = 0.4

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of each segment's points; no histograms of pairs.

        Raises
        ------
        ValueError
            If `radius` is not a positive number, or the object's arrays do not fit (as in
            `compute_principal_curvatures`).
        """
        check_parameters(self)
        points, normals = checked_surface(segmented.points, segmented.normals)
        labels = checked_labels(segmented)
        size = size_of_segments(points, labels)
        fewest, most = (number * segmented.voxel_size for number in _VOXELS)
        radius = min(max(self.radius * size, fewest), most)
        curvatures = compute_principal_curvatures(points, normals, radius)
        return Description(curvature_histograms(size * curvatures, labels, segmented.n_segments))


def compute_principal_curvatures(
    points: NDArray[np.float64], normals: NDArray[np.float64], radius: float
) -> NDArray[np.float64]:
    """Principal curvatures of a surface at its points.

    The Weingarten map, which says how the normal turns as one moves along the surface, is fitted to the
    neighbours' normals by least squares in the tangent plane, and made symmetric; the curvatures are its
    eigenvalues (Berkmann and Caelli 1994).

    Parameters
    ----------
    points : (m, 3) float64
        Finite coordinates.
    normals : (m, 3) float64
        Unit normals, consistently oriented. A point with a zero normal is nobody's neighbour.
    radius : float
        Radius of the neighbourhood, inclusive, in the unit of the points.

    Returns
    -------
    (m, 2) float64
        The larger first, in 1 / unit of the points; positive where the surface bends away from its normal, as
        a ball does. 0 where there is no normal, and where the neighbours lie along a line in the tangent
        plane, or at one place in it: that says nothing about the directions across.

    Raises
    ------
    ValueError
        If the shapes do not fit, values are not finite, normals are neither unit nor zero, or `radius` is not
        a positive number.
    """
    points, normals = checked_surface(points, normals)
    oriented = np.flatnonzero((normals[:, 0] != 0.0) | (normals[:, 1] != 0.0) | (normals[:, 2] != 0.0))
    grid = cell_grid(points[oriented], radius)
    order = oriented[grid.order]
    surface = np.concatenate([grid.coordinates, normals[order].T])
    curvatures = np.zeros((len(points), 2))
    curvatures[order] = principal_curvatures(surface, *grid[2:], float(radius)) / radius
    return curvatures
