"""One object on its way through the hierarchies: its constellations with words and histograms."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.described_object import DescribedObject
from shapeconcepts.motifs.decomposition import MAX_SEGMENTS, decompose
from shapeconcepts.motifs.dictionary import SegmentDictionary


class Propagation(NamedTuple):
    """The constellations of an object, with what identifies and what describes their motifs.

    Attributes
    ----------
    constellations : (k,) int64
        Sets of segments as bitmasks, ordered by motif level; the first are the segments themselves.
    motif_levels : (k,) int32
    words : (k, n, 16) int32
        Words of each constellation's segments at each dictionary level, rising, with -1 before the first.
    histograms : (k, b) float32
        Description of each constellation; a row sums to 1, or to 0 where there is nothing to describe.
    segment_edges : (e, 2) int32
    """

    constellations: NDArray[np.int64]
    motif_levels: NDArray[np.int32]
    words: NDArray[np.int32]
    histograms: NDArray[np.float32]
    segment_edges: NDArray[np.int32]


def propagate(described: DescribedObject, dictionary: SegmentDictionary) -> Propagation:
    """Decompose an object and label its segments with words.

    Raises
    ------
    ValueError
        If the object has no or more than 16 segments, or its histograms do not fit the dictionary.
    """
    name = described.name or "object"
    n_segments = described.n_segments
    if not 1 <= n_segments <= MAX_SEGMENTS:
        raise ValueError(f"{name}: expected 1 to {MAX_SEGMENTS} segments, got {n_segments}")
    constellations, motif_levels = decompose(described.segment_edges, n_segments)
    histograms = described.description.histograms(constellations)
    # scikit-learn can be told that it shall be a data frame.
    segment_words = np.asarray(dictionary.transform(histograms[:n_segments]))
    is_member = (constellations[:, None] >> np.arange(n_segments)) & 1 == 1
    words = np.full((len(constellations), segment_words.shape[1], MAX_SEGMENTS), -1, np.int32)
    words[:, :, :n_segments] = np.where(is_member[:, None, :], segment_words.T, -1)
    words.sort(axis=2)
    return Propagation(
        constellations, motif_levels, words, histograms.astype(np.float32), described.segment_edges
    )
