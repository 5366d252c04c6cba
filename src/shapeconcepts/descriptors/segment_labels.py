"""Which segment each point belongs to, checked before a kernel relies on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.segmentation.segmented_object import SegmentedObject


def checked_labels(segmented: SegmentedObject) -> NDArray[np.int32]:
    """Segment labels as (m,) int32, one for each point, all below `n_segments`.

    Raises
    ------
    ValueError
        If there is not one label for each point, or a label names no segment.
    """
    labels = np.ascontiguousarray(segmented.segment_labels, dtype=np.int32)
    if labels.shape != (len(segmented.points),):
        raise ValueError(f"segment_labels must have shape ({len(segmented.points)},), got {labels.shape}")
    if len(labels) and labels.max() >= segmented.n_segments:
        raise ValueError(
            f"segment_labels must be below n_segments = {segmented.n_segments}, got {labels.max()}"
        )
    return labels
