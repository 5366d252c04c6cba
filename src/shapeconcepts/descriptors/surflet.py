"""Surflet-pair relations: how the surface elements of an object lie to each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.segment_labels import checked_labels
from shapeconcepts.descriptors.surflet_kernels import accumulate_relations, largest_distance
from shapeconcepts.descriptors.surflets import average_surflets
from shapeconcepts.geometry.surface import checked_surface
from shapeconcepts.parameters import check_parameters, choice
from shapeconcepts.segmentation.segmented_object import SegmentedObject

SCALES = ("relative", "metric")
DISTANCE_BINS = 5
ANGLE_BINS = 9
N_BINS = DISTANCE_BINS * 3 * ANGLE_BINS
METRIC_RANGE = 0.5
# Metres. Coincident points lie this close after rounding, and have no angles.
_SMALLEST_DIAMETER = 1e-9


@dataclass
class Surflet(BaseEstimator):
    """Descriptor of segments and of pairs of segments by surflet-pair relations (Wahl et al., 3DIM 2003).

    A surflet is a point with a normal. Two of them relate by their distance and three angles, theta, alpha
    and phi (Wahl's alpha, beta and gamma; the names here are those of FPFH). The histogram holds, for each of
    5 distances, 9 bins of each angle: 135 bins. A constellation's histogram covers all pairs of points within
    and across its segments, so it also tells how the segments lie to each other.

    Points are not paired one by one: those of a segment that share a cell of a coarse grid are averaged to
    one surflet, and a pair of surflets weighs as many pairs as it stands for. Pairs within a cell are left
    out; a segment in a single cell has no mass of its own.

    Parameters
    ----------
    scale : {"relative", "metric"}
        Distances in parts of the object's diameter (the largest distance of two surflets), so that size does
        not matter; or in metres, from 0 to 0.5, larger ones counted as 0.5.
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {"scale": [choice(*SCALES)]}
    n_bins: ClassVar[int] = N_BINS

    scale: str = "relative"

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of each segment's pairs of points and of the pairs across each two segments.

        Raises
        ------
        ValueError
            If `scale` is unknown, or the object's arrays do not fit.
        """
        check_parameters(self)
        points, normals = checked_surface(segmented.points, segmented.normals)
        surflets = average_surflets(points, normals, checked_labels(segmented))
        n = segmented.n_segments
        padded = np.zeros((n, n, DISTANCE_BINS + 2, 3, ANGLE_BINS + 2))
        diameter = largest_distance(surflets.points)
        if diameter > _SMALLEST_DIAMETER:
            distance_range = diameter if self.scale == "relative" else METRIC_RANGE
            accumulate_relations(*surflets, distance_range, padded)
        histograms = _fold_ends(padded).reshape(n, n, N_BINS)
        first, second = np.triu_indices(n, k=1)
        return Description(
            segment_histograms=histograms[np.arange(n), np.arange(n)],
            pairs=np.stack([first, second], axis=1).astype(np.int32),
            pair_histograms=histograms[first, second],
        )


def _fold_ends(padded: NDArray[np.float64]) -> NDArray[np.float64]:
    """Put the extra bins at the ends of the axes where they belong: theta goes around, the others stop."""
    by_distance = padded[..., 1:-1, :, :].copy()
    by_distance[..., 0, :, :] += padded[..., 0, :, :]
    by_distance[..., -1, :, :] += padded[..., -1, :, :]
    histograms = by_distance[..., 1:-1].copy()
    front, back = by_distance[..., 0], by_distance[..., -1]
    histograms[..., 0, -1] += front[..., 0]
    histograms[..., 0, 0] += back[..., 0]
    histograms[..., 1:, 0] += front[..., 1:]
    histograms[..., 1:, -1] += back[..., 1:]
    return histograms
