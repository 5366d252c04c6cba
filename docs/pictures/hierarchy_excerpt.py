"""What a picture shows of a motif hierarchy, and what an object does in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.described_object import describe
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.motifs.decomposition import decompose, segments_in
from shapeconcepts.motifs.ensemble import MotifHierarchyEnsemble
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.hierarchy_kernels import linked_vertices
from shapeconcepts.motifs.propagation import Propagation, decompose_object, propagate
from shapeconcepts.segmentation.segmented_object import SegmentedObject

Pair = tuple[int, int]


@dataclass(frozen=True)
class HierarchyExcerpt:
    """Some vertices of one hierarchy with what joins them.

    Attributes
    ----------
    rows : list of list of int
        Vertices shown at each motif level, from level 1, the activated ones first.
    n_vertices, n_activated : list of int
        Number of vertices that the hierarchy has at each of these levels, and how many the object activates.
    n_above : int
        Number of vertices at higher motif levels.
    activated : set of int
        Vertices that the object's constellations activate, shown or not.
    stimulus_of : dict of int to float
        Stimulus of the activated vertices that are columns of the stimuli. Where columns are prototypes, the
        largest stimulus of any prototype by the constellations that activate the vertex.
    links, steps : set of (int, int)
        Linked vertices of a level; vertices (lower, upper) such that in some training object the lower is one
        of two whose union makes the upper. Between shown vertices.
    own_links, own_steps : set of (int, int)
        The same for the object.
    segment_words : (s,) int32
        Word of each of the object's segments.
    n_constellations, n_unknown : int
        Number of the object's constellations, and of those whose motif was never seen.
    """

    rows: list[list[int]]
    n_vertices: list[int]
    n_activated: list[int]
    n_above: int
    activated: set[int]
    stimulus_of: dict[int, float]
    links: set[Pair]
    steps: set[Pair]
    own_links: set[Pair]
    own_steps: set[Pair]
    segment_words: NDArray[np.int32]
    n_constellations: int
    n_unknown: int


def excerpt_of(
    ensemble: MotifHierarchyEnsemble,
    segmented: SegmentedObject,
    dictionary_level: int,
    n_shown: int,
    *,
    descriptor: str | Descriptor = "surflet+fpfh+curvature",
) -> HierarchyExcerpt:
    """Propagate an object, and choose what to show.

    At each motif level up to one above the object's highest: the activated vertices, the strongest first,
    then those that were seen in most training objects, `n_shown` together. `descriptor` is what the training
    objects were described by.
    """
    known = ensemble.hierarchies_
    described = describe(segmented, descriptor)
    (propagation,) = propagate([decompose_object(described)], ensemble.dictionary_)
    vertices = known.activated(propagation.words)[:, dictionary_level - 1]
    activated = {int(vertex) for vertex in vertices[vertices >= 0]}
    vertex_of = {
        segments_in(constellation): vertex
        for constellation, vertex in zip(propagation.constellations.tolist(), vertices.tolist(), strict=True)
    }
    stimulus_of: dict[int, float] = {}
    explanation = ensemble.explain(described)
    for motif in explanation.motifs:
        if explanation.columns == "prototypes" or motif.dictionary_level == dictionary_level:
            stimulus_of.setdefault(vertex_of[motif.segments], motif.stimulus)
    # Constellations whose motif is unknown at this level.
    stimulus_of.pop(-1, None)

    here = np.flatnonzero(known.dictionary_levels == dictionary_level)
    highest = max((int(known.motif_levels[vertex]) for vertex in activated), default=0)
    rows, n_vertices, n_activated = [], [], []
    for level in range(1, min(highest + 1, int(known.motif_levels[here].max())) + 1):
        at_level = here[known.motif_levels[here] == level].tolist()
        at_level.sort(key=lambda v: (v not in activated, -stimulus_of.get(v, 0.0), -known.support[v], v))
        rows.append(at_level[:n_shown])
        n_vertices.append(len(at_level))
        n_activated.append(len(activated.intersection(at_level)))

    shown = {vertex for row in rows for vertex in row}
    row_of = {vertex: level for level, row in enumerate(rows) for vertex in row}
    ends_shown = known.edges[np.isin(known.edges, list(shown)).all(axis=1)]
    links = {(a, b) for a, b in ends_shown.tolist() if row_of[a] == row_of[b]}

    def rising(steps: set[Pair]) -> set[Pair]:
        # A motif stands at the lowest level at which it was seen, which need not be the level of this step.
        return {(lower, upper) for lower, upper in steps if row_of[lower] < row_of[upper]}

    own_steps = _steps(propagation.constellations, propagation.motif_levels, vertices, shown)
    return HierarchyExcerpt(
        rows=rows,
        n_vertices=n_vertices,
        n_activated=n_activated,
        n_above=len(here) - sum(n_vertices),
        activated=activated,
        stimulus_of=stimulus_of,
        links=links,
        steps=rising(_training_steps(known, dictionary_level, shown)),
        own_links=links & _links(propagation, vertices, shown),
        own_steps=rising(own_steps),
        segment_words=propagation.words[: segmented.n_segments, dictionary_level - 1].max(axis=1),
        n_constellations=len(vertices),
        n_unknown=int((vertices < 0).sum()),
    )


def _links(propagation: Propagation, vertices: NDArray[np.int32], shown: set[int]) -> set[Pair]:
    """Shown vertices that an object links within a motif level, the smaller number first."""
    distinct, local = np.unique(vertices, return_inverse=True)
    is_linked = linked_vertices(
        propagation.constellations,
        propagation.motif_levels,
        np.ascontiguousarray(propagation.segment_edges, np.int32),
        local,
        len(distinct),
    )
    is_shown = np.isin(distinct, list(shown))
    pairs = np.argwhere(np.triu(is_linked & is_shown & is_shown[:, None]))
    return {(int(a), int(b)) for a, b in distinct[pairs]}


def _steps(
    constellations: NDArray[np.int64],
    motif_levels: NDArray[np.int32],
    vertices: NDArray[np.int32],
    shown: set[int],
) -> set[Pair]:
    """Vertices (lower, upper) of constellations that with another one make one of the next level."""
    steps: set[Pair] = set()
    is_shown = np.isin(vertices, list(shown))
    for level in range(1, int(motif_levels.max(initial=0))):
        lower = np.flatnonzero(motif_levels == level)
        for target in np.flatnonzero((motif_levels == level + 1) & is_shown):
            whole = constellations[target]
            inside = lower[constellations[lower] & ~whole == 0]
            parts = constellations[inside]
            for source in inside[is_shown[inside]]:
                step = int(vertices[source]), int(vertices[target])
                if step in steps:
                    continue
                makes_whole = (parts | constellations[source]) == whole
                # Above level 1 the two must share a segment.
                if level > 1:
                    makes_whole &= (parts & constellations[source]) != 0
                if makes_whole.any():
                    steps.add(step)
    return steps


def _training_steps(known: MotifHierarchies, dictionary_level: int, shown: set[int]) -> set[Pair]:
    """Steps of all training objects."""
    steps: set[Pair] = set()
    starts = np.flatnonzero(np.diff(known.prototype_objects, prepend=-1))[1:]
    of_level = known.prototype_vertices[:, dictionary_level - 1]
    for constellations, vertices in zip(
        np.split(known.prototype_constellations, starts), np.split(of_level, starts), strict=True
    ):
        # The constellations of two segments are the edges of the segment graph, and the order is the same.
        pairs = [mask for mask in constellations.tolist() if mask.bit_count() == 2]
        edges = [[mask.bit_length() - 1, (mask & -mask).bit_length() - 1] for mask in pairs]
        n_segments = sum(mask.bit_count() == 1 for mask in constellations.tolist())
        levels = decompose(edges, n_segments).motif_levels
        steps |= _steps(constellations, levels, vertices, shown)
    return steps
