"""Objects on their way through the hierarchies: constellations with words and histograms."""

from __future__ import annotations

from collections.abc import Sequence
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
    whole : (b,) float64
        Description of all segments together, whether they are a constellation or not.
    """

    constellations: NDArray[np.int64]
    motif_levels: NDArray[np.int32]
    words: NDArray[np.int32]
    histograms: NDArray[np.float32]
    segment_edges: NDArray[np.int32]
    whole: NDArray[np.float64]


class DecomposedObject(NamedTuple):
    """The constellations of an object before its segments have words.

    Attributes
    ----------
    constellations : (k,) int64
    motif_levels : (k,) int32
    histograms : (k, b) float32
    segment_edges : (e, 2) int32
    whole : (b,) float64
        As in `Propagation`.
    n_segments : int
    name : str
    """

    constellations: NDArray[np.int64]
    motif_levels: NDArray[np.int32]
    histograms: NDArray[np.float32]
    segment_edges: NDArray[np.int32]
    whole: NDArray[np.float64]
    n_segments: int
    name: str

    @property
    def segment_histograms(self) -> NDArray[np.float32]:
        """Descriptions of the segments themselves, (n_segments, b)."""
        return self.histograms[: self.n_segments]


def decompose_object(described: DescribedObject) -> DecomposedObject:
    """Decompose an object, and describe its constellations.

    Raises
    ------
    ValueError
        If the object has no or more than 16 segments.
    """
    n_segments = described.n_segments
    if not 1 <= n_segments <= MAX_SEGMENTS:
        name = described.name or "object"
        raise ValueError(f"{name}: expected 1 to {MAX_SEGMENTS} segments, got {n_segments}")
    constellations, motif_levels = decompose(described.segment_edges, n_segments)
    histograms = described.description.histograms(constellations).astype(np.float32)
    return DecomposedObject(
        constellations,
        motif_levels,
        histograms,
        described.segment_edges,
        described.description.whole(),
        n_segments,
        described.name,
    )


def propagate(objects: Sequence[DecomposedObject], dictionary: SegmentDictionary) -> list[Propagation]:
    """Label the segments of objects with words; what comes out for an object does not depend on the others.

    Raises
    ------
    ValueError
        If the histograms do not fit the dictionary.
    """
    if not objects:
        return []
    # scikit-learn can be told that it shall be a data frame.
    words = np.asarray(dictionary.transform(np.concatenate([one.segment_histograms for one in objects])))
    words_of = np.split(words, np.cumsum([one.n_segments for one in objects])[:-1])
    return [
        Propagation(
            one.constellations,
            one.motif_levels,
            _words_within(one.constellations, segment_words),
            one.histograms,
            one.segment_edges,
            one.whole,
        )
        for one, segment_words in zip(objects, words_of, strict=True)
    ]


def _words_within(constellations: NDArray[np.int64], segment_words: NDArray[np.int32]) -> NDArray[np.int32]:
    n_segments, n_levels = segment_words.shape
    is_member = (constellations[:, None] >> np.arange(n_segments)) & 1 == 1
    words = np.full((len(constellations), n_levels, MAX_SEGMENTS), -1, np.int32)
    words[:, :, :n_segments] = np.where(is_member[:, None, :], segment_words.T, -1)
    words.sort(axis=2)
    return words
