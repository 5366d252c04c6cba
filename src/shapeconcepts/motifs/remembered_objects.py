"""Objects as the motif hierarchies remember them."""

from __future__ import annotations

import numpy as np

from shapeconcepts.motifs.decomposition import decompose, segments_in
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.propagation import DecomposedObject


def remembered_objects(hierarchies: MotifHierarchies) -> list[DecomposedObject]:
    """Objects that were seen, as they were before their segments had words; in single precision.

    Parameters
    ----------
    hierarchies : MotifHierarchies
        No prototype may stand for others: those are forgotten.

    Raises
    ------
    ValueError
        If an object has other constellations than its segments make.
    """
    numbers = np.arange(hierarchies.n_objects + 1)
    starts = np.searchsorted(hierarchies.prototype_objects, numbers)
    objects = []
    for number, name in enumerate(hierarchies.object_names):
        own = slice(starts[number], starts[number + 1])
        constellations = hierarchies.prototype_constellations[own]
        segments = [segments_in(one) for one in constellations.tolist()]
        n_segments = sum(len(one) == 1 for one in segments)
        # Two neighbours are a constellation, and no other two segments are.
        edges = np.array([one for one in segments if len(one) == 2], np.int32).reshape(-1, 2)
        decomposition = decompose(edges, n_segments)
        if not np.array_equal(decomposition.constellations, constellations):
            raise ValueError(
                f"{name or f'object {number}'}: its constellations are not those of its segments"
            )
        objects.append(
            DecomposedObject(
                constellations,
                decomposition.motif_levels,
                hierarchies.prototypes[own],
                edges,
                hierarchies.object_histograms[number].astype(np.float64),
                n_segments,
                name,
            )
        )
    return objects
