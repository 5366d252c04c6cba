"""Training segments that are most like the words of a dictionary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shapeconcepts.descriptors.described_object import describe
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.segmentation.segmented_object import SegmentedObject

Example = tuple[int, int]


def word_examples(
    dictionary: SegmentDictionary,
    objects: Sequence[SegmentedObject],
    descriptor: str | Descriptor,
    n_levels: int,
    n_examples: int,
) -> list[list[list[Example]]]:
    """Object and segment of the training segments behind each word of each level, the closest first.

    Parameters
    ----------
    dictionary : SegmentDictionary
        Fitted.
    objects : sequence of SegmentedObject
        The objects that it was learned from, in the same order.
    descriptor : str or Descriptor
        A name as of `get_descriptor`.
        What the segments were described by.
    n_levels : int
        Levels from the first.
    n_examples : int
        Largest number for each word.

    Raises
    ------
    ValueError
        If the objects have another number of segments, or their descriptions another number of bins, than
        those that the dictionary was learned from.
    """
    n_segments = sum(one.n_segments for one in objects)
    if n_segments != len(dictionary.clusters_):
        raise ValueError(
            "objects must be those that the dictionary was learned from, with "
            f"{len(dictionary.clusters_)} segments, got {len(objects)} objects with {n_segments} segments"
        )
    origin = [(index, segment) for index, one in enumerate(objects) for segment in range(one.n_segments)]
    histograms = np.concatenate(
        [describe(one, descriptor).description.histograms(1 << np.arange(one.n_segments)) for one in objects]
    )
    if histograms.shape[1] != dictionary.n_features_in_:
        raise ValueError(
            f"descriptor must give the {dictionary.n_features_in_} bins of the dictionary's words, "
            f"got {histograms.shape[1]}"
        )
    embed = np.sqrt if dictionary.metric == "hellinger" else np.asarray
    examples: list[list[list[Example]]] = []
    for level in range(n_levels):
        of_level = []
        for word, centre in enumerate(dictionary.words_[level]):
            members = dictionary.members(level + 1, word)
            distances = ((embed(histograms[members]) - embed(centre)) ** 2).sum(axis=1)
            closest = members[np.argsort(distances, kind="stable")[:n_examples]]
            of_level.append([origin[row] for row in closest])
        examples.append(of_level)
    return examples
