"""How far the points of an object lie from each other, in metres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator

from shapeconcepts.descriptors.point_distances_kernels import accumulate_distances
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.descriptors.segment_labels import checked_labels
from shapeconcepts.descriptors.surflets import average_surflets
from shapeconcepts.geometry.surface import checked_surface
from shapeconcepts.segmentation.segmented_object import SegmentedObject

# From 5 mm to 45 cm, two bins for each doubling.
SMALLEST_DISTANCE = 0.005
BINS_PER_DOUBLING = 2
N_BINS = 14


@dataclass
class PointDistances(BaseEstimator):
    """Descriptor of segments and pairs of segments by the distances of their points (D2, Osada et al. 2002).

    In metres, on the scale of the logarithm: beside descriptors that know shape alone, it says how large
    something is. What of an object is hidden does not change the distances within the rest.

    Points are averaged as in `Surflet`. The histogram has 14 places, from 5 mm to 0.45 m, two for each
    doubling; smaller distances count as the first and larger ones as the last. A pair counts in the two
    places around its distance.
    """

    n_bins: ClassVar[int] = N_BINS

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of each segment's pairs of points and of the pairs across each two segments.

        Raises
        ------
        ValueError
            If the object's arrays do not fit.
        """
        points, normals = checked_surface(segmented.points, segmented.normals)
        averaged = average_surflets(points, normals, checked_labels(segmented))
        n = segmented.n_segments
        histograms = np.zeros((n, n, N_BINS))
        accumulate_distances(
            averaged.points,
            averaged.weights,
            averaged.segment_labels,
            SMALLEST_DISTANCE,
            BINS_PER_DOUBLING,
            histograms,
        )
        first, second = np.triu_indices(n, k=1)
        return Description(
            segment_histograms=histograms[np.arange(n), np.arange(n)],
            pairs=np.stack([first, second], axis=1).astype(np.int32),
            pair_histograms=histograms[first, second],
        )
