"""Principal curvatures: how strongly the surface bends around each point, and which way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.curvature_kernels import N_BINS, curvature_histograms, principal_curvatures
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.surface import checked_labels, checked_surface
from shapeconcepts.neighbours import cell_grid
from shapeconcepts.segmentation.segmented_object import SegmentedObject


@dataclass(frozen=True)
class Curvature:
    """Descriptor of segments by the two principal curvatures at their points (Koenderink, van Doorn 1992).

    A curvature counts in parts of the object's size, the root mean square distance of its points from their
    centroid, so that a small and a large ball are alike. The histogram has 11 places for each of the two, from
    -3 to 3 on the scale of asinh, finer around 0; beyond this it counts as the last. With the larger of both
    first, that makes 66 bins. A point counts in the four bins around it, the more, the closer they are: noise
    moves the histogram a little, never by a whole bin.

    Parameters
    ----------
    radius : float
        Radius of a point's neighbourhood, metres.
    """

    radius: float = 0.02

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of each segment's points; no histograms of pairs.

        Raises
        ------
        ValueError
            If `radius` is not a positive number, or the object's arrays do not fit (as in
            `compute_principal_curvatures`).
        """
        points, normals = checked_surface(segmented.points, segmented.normals)
        labels = checked_labels(segmented)
        curvatures = compute_principal_curvatures(points, normals, self.radius)
        counted = labels >= 0
        offsets = points[counted] - points[counted].mean(axis=0) if counted.any() else np.zeros((1, 3))
        size = np.sqrt(np.einsum("ij,ij->", offsets, offsets) / len(offsets))
        return Description(curvature_histograms(size * curvatures, labels, segmented.n_segments))

    @property
    def n_bins(self) -> int:
        """Number of bins."""
        return N_BINS


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
        Unit normals, consistently oriented.
    radius : float
        Radius of the neighbourhood, inclusive, in the unit of the points.

    Returns
    -------
    (m, 2) float64
        The larger first, in 1 / unit of the points; positive where the surface bends away from its normal, as
        a ball does. 0 where there is no normal, or where the neighbours lie along a line, which says nothing
        about the direction across it.

    Raises
    ------
    ValueError
        If the shapes do not fit, values are not finite, normals are neither unit nor zero, or `radius` is not
        a positive number.
    """
    points, normals = checked_surface(points, normals)
    grid = cell_grid(points, radius, reach=2)
    surface = np.concatenate([grid.coordinates, normals[grid.order].T])
    curvatures = np.empty((len(points), 2))
    curvatures[grid.order] = principal_curvatures(surface, *grid[2:], radius) / radius
    return curvatures
