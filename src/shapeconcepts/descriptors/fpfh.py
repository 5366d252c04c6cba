"""Fast Point Feature Histograms: how the surface bends around each point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from shapeconcepts.descriptors.fpfh_kernels import (
    neighbour_means,
    segment_sums,
    simplified_histograms,
)
from shapeconcepts.descriptors.pair_feature_kernels import N_BINS
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.segment_labels import checked_labels
from shapeconcepts.geometry.neighbours import cell_grid
from shapeconcepts.geometry.surface import checked_surface
from shapeconcepts.parameters import check_parameters, positive_number
from shapeconcepts.segmentation.segmented_object import SegmentedObject


@dataclass
class FPFH(BaseEstimator):
    """Descriptor of segments by the summed Fast Point Feature Histograms of their points (Rusu et al. 2009).

    Neighbours are looked for on the whole object, across segment borders: that is where the shape of an edge
    is. 33 bins, 11 for each of three angles.

    Parameters
    ----------
    radius : float
        Radius of a point's neighbourhood, metres.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {"radius": [positive_number()]}
    n_bins: ClassVar[int] = 3 * N_BINS

    radius: float = 0.03

    def describe(self, segmented: SegmentedObject) -> Description:
        """Sum of the histograms of each segment's points; no histograms of pairs.

        Raises
        ------
        ValueError
            If `radius` is not a positive number, or the object's arrays do not fit (as in `compute_fpfh`).
        """
        check_parameters(self)
        points, normals = checked_surface(segmented.points, segmented.normals)
        labels = checked_labels(segmented)
        grid = cell_grid(points, self.radius, reach=2)
        histograms, weight_sums = simplified_histograms(
            np.concatenate([grid.coordinates, normals[grid.order].T]), *grid[2:], self.radius
        )
        scales = np.divide(1.0, weight_sums, out=np.zeros(len(points)), where=weight_sums > 0.0)
        labelled = np.concatenate([grid.coordinates, [labels[grid.order], scales]])
        return Description(segment_sums(labelled, *grid[2:], self.radius, histograms, segmented.n_segments))


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
    points, normals = checked_surface(points, normals)
    grid = cell_grid(points, radius, reach=2)
    surface = np.concatenate([grid.coordinates, normals[grid.order].T])
    histograms, weight_sums = simplified_histograms(surface, *grid[2:], radius)
    means = neighbour_means(surface, *grid[2:], radius, histograms, weight_sums)
    result = np.empty_like(means)
    result[grid.order] = histograms + means
    return result
