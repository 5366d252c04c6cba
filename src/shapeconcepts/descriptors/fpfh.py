"""Fast Point Feature Histograms: how the surface bends around each point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.fpfh_kernels import (
    N_BINS,
    neighbour_means,
    segment_sums,
    simplified_histograms,
)
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.surface import checked_labels, checked_surface
from shapeconcepts.neighbours import NeighbourPairs, neighbour_pairs
from shapeconcepts.segmentation.segmented_object import SegmentedObject


@dataclass(frozen=True)
class FPFH:
    """Descriptor of segments by the summed Fast Point Feature Histograms of their points (Rusu et al. 2009).

    Neighbours are looked for on the whole object, across segment borders: that is where the shape of an edge
    is. 33 bins, 11 for each of three angles.

    Parameters
    ----------
    radius : float
        Radius of a point's neighbourhood, metres.
    """

    radius: float = 0.03

    def describe(self, segmented: SegmentedObject) -> Description:
        """Sum of the histograms of each segment's points; no histograms of pairs.

        Raises
        ------
        ValueError
            If `radius` is not a positive number, or the object's arrays do not fit (as in `compute_fpfh`).
        """
        surface = _NeighbouredSurface(segmented.points, segmented.normals, self.radius)
        sums = segment_sums(
            surface.points,
            surface.pairs.indptr,
            surface.pairs.partners,
            surface.histograms,
            surface.weight_sums,
            checked_labels(segmented)[surface.pairs.order],
            segmented.n_segments,
        )
        return Description(sums)


def compute_fpfh(
    points: NDArray[np.float64], normals: NDArray[np.float64], radius: float
) -> NDArray[np.float64]:
    """Fast Point Feature Histogram of each point (Rusu, Blodow, Beetz, ICRA 2009).

    The conventions are Open3D's: a point's simplified histogram plus the mean of its neighbours' histograms
    weighted by 1 / squared distance, each scaled to 100 per angle.

    Parameters
    ----------
    points : (m, 3) float64
        Finite coordinates.
    normals : (m, 3) float64
        Unit normals, consistently oriented. A zero normal counts as flat.
    radius : float
        Radius of the neighbourhood, inclusive, in the unit of the points.

    Returns
    -------
    (m, 33) float64
        11 bins each of theta in [-pi, pi], alpha and phi in [-1, 1]. Zero for a point without neighbours.

    Raises
    ------
    ValueError
        If the shapes do not fit, values are not finite, normals are neither unit nor zero, or `radius` is not
        a positive number.
    """
    surface = _NeighbouredSurface(points, normals, radius)
    pairs = surface.pairs
    means = neighbour_means(
        surface.points, pairs.indptr, pairs.partners, surface.histograms, surface.weight_sums
    )
    result = np.empty_like(means)
    result[pairs.order] = means + surface.histograms
    return result


class _NeighbouredSurface:
    """Oriented points sorted like their neighbour pairs, with simplified histograms (100 per angle)."""

    def __init__(self, points: NDArray[np.float64], normals: NDArray[np.float64], radius: float) -> None:
        points, normals = checked_surface(points, normals)
        self.pairs: NeighbourPairs = neighbour_pairs(points, radius)
        self.points = points[self.pairs.order]
        counts, self.weight_sums = simplified_histograms(
            self.points, normals[self.pairs.order], self.pairs.indptr, self.pairs.partners
        )
        n_neighbours = counts[:, :N_BINS].sum(axis=1, keepdims=True)
        self.histograms = counts * (100.0 / np.maximum(n_neighbours, 1))
