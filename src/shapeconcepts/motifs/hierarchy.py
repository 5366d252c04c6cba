"""The motif hierarchies of an ensemble, as flat arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.decomposition import MAX_SEGMENTS, segments_in
from shapeconcepts.motifs.hierarchy_kernels import linked_vertices
from shapeconcepts.motifs.propagation import Propagation
from shapeconcepts.motifs.stimulus_kernels import negative_entropies

if TYPE_CHECKING:
    import networkx


# Other objects behind a prototype that are remembered.
N_OTHERS = 3


class PrototypeLists(NamedTuple):
    """Prototypes of each vertex: those of vertex v are ``prototypes[starts[v]:starts[v + 1]]``, rising."""

    starts: NDArray[np.int64]
    prototypes: NDArray[np.int32]


@dataclass(frozen=True, eq=False, repr=False)
class MotifHierarchies:
    """One motif hierarchy for each dictionary level (paper: Shape Motif Hierarchy Ensemble).

    A motif vertex is a multiset of words of one dictionary level. A prototype is the description of a
    constellation of a training object; it is stored once, and belongs to one vertex of each hierarchy. It may
    stand for those of other objects, too, that are not stored; see `thinning`.

    Attributes
    ----------
    dictionary_levels : (v,) int32
        Dictionary level of each vertex, from 1: the hierarchy that it belongs to.
    motif_levels : (v,) int32
        The smallest motif level at which the motif was seen, from 1.
    words : (v, 16) int32
        The motif: words in rising order, with -1 before the first.
    support : (v,) int64
        Number of training objects that each vertex was seen in.
    edges : (e, 2) int32
        Linked vertices, the smaller number first, sorted. A vertex may be linked to itself: two neighbouring
        segments can have the same word.
    prototypes : (p, b) float32
        In the order in which they were seen.
    prototype_vertices : (p, n) int32
        Vertex of each prototype in each hierarchy.
    prototype_objects : (p,) int32
        Training object, counted in the order in which they were seen.
    prototype_constellations : (p,) int64
        The object's segments behind the prototype, as a bitmask.
    prototype_counts : (p,) int64
        Number of constellations that each prototype stands for, itself included.
    prototype_others : (p, 3) int32
        Some of the other training objects that these are of, -1 where there are no more.
    object_histograms : (o, b) float16
        Description of each training object as a whole; a row sums to 1, or to 0 where there is nothing.
    object_names : tuple of str
    """

    dictionary_levels: NDArray[np.int32]
    motif_levels: NDArray[np.int32]
    words: NDArray[np.int32]
    support: NDArray[np.int64]
    edges: NDArray[np.int32]
    prototypes: NDArray[np.float32]
    prototype_vertices: NDArray[np.int32]
    prototype_objects: NDArray[np.int32]
    prototype_constellations: NDArray[np.int64]
    prototype_counts: NDArray[np.int64]
    prototype_others: NDArray[np.int32]
    object_histograms: NDArray[np.float16]
    object_names: tuple[str, ...]

    @classmethod
    def empty(cls, n_levels: int, n_bins: int) -> MotifHierarchies:
        """Hierarchies without any vertex."""
        return cls(
            dictionary_levels=np.empty(0, np.int32),
            motif_levels=np.empty(0, np.int32),
            words=np.empty((0, MAX_SEGMENTS), np.int32),
            support=np.empty(0, np.int64),
            edges=np.empty((0, 2), np.int32),
            prototypes=np.empty((0, n_bins), np.float32),
            prototype_vertices=np.empty((0, n_levels), np.int32),
            prototype_objects=np.empty(0, np.int32),
            prototype_constellations=np.empty(0, np.int64),
            prototype_counts=np.empty(0, np.int64),
            prototype_others=np.empty((0, N_OTHERS), np.int32),
            object_histograms=np.empty((0, n_bins), np.float16),
            object_names=(),
        )

    @property
    def n_vertices(self) -> int:
        """Number of motif vertices in all hierarchies."""
        return len(self.words)

    @property
    def n_levels(self) -> int:
        """Number of hierarchies."""
        return self.prototype_vertices.shape[1]

    @property
    def n_objects(self) -> int:
        """Number of training objects."""
        return len(self.object_names)

    @property
    def is_thinned(self) -> bool:
        """Whether prototypes stand for constellations that are not stored."""
        return int(self.prototype_counts.sum()) > len(self.prototypes)

    @cached_property
    def prototypes_of(self) -> PrototypeLists:
        """Prototypes of each vertex."""
        vertices = self.prototype_vertices.ravel()
        order = np.argsort(vertices, kind="stable")
        counts = np.bincount(vertices, minlength=self.n_vertices)
        return PrototypeLists(
            np.concatenate([[0], np.cumsum(counts)]),
            (order // max(self.n_levels, 1)).astype(np.int32),
        )

    @cached_property
    def prototype_entropies(self) -> NDArray[np.float64]:
        """Negative entropy of each prototype, (p,) float64, bits."""
        return negative_entropies(self.prototypes)

    @cached_property
    def _vertex_of(self) -> list[dict[bytes, int]]:
        vertex_of: list[dict[bytes, int]] = [{} for _ in range(self.n_levels)]
        for vertex, (level, words) in enumerate(zip(self.dictionary_levels, self.words, strict=True)):
            vertex_of[level - 1][words.tobytes()] = vertex
        return vertex_of

    def activated(self, words: NDArray[np.int32]) -> NDArray[np.int32]:
        """Vertices that constellations activate.

        Parameters
        ----------
        words : (k, n, 16) int32
            As in `Propagation`.

        Returns
        -------
        (k, n) int32
            Vertex of each constellation in each hierarchy, -1 where its motif was never seen.
        """
        found = [
            [vertex_of.get(motif, -1) for motif, vertex_of in zip(motifs, self._vertex_of, strict=True)]
            for motifs in _motif_keys(words)
        ]
        return np.array(found, np.int32).reshape(len(words), self.n_levels)

    def with_objects(self, propagations: Sequence[Propagation], names: Sequence[str]) -> MotifHierarchies:
        """The hierarchies after more objects were seen; these ones stay as they are."""
        vertex_of = [dict(known) for known in self._vertex_of]
        dictionary_levels, motif_levels = self.dictionary_levels.tolist(), self.motif_levels.tolist()
        words, prototype_vertices = [self.words], [self.prototype_vertices]
        edges, seen = [self.edges], []
        for propagation in propagations:
            vertices = np.empty(propagation.words.shape[:2], np.int32)
            for c, motifs in enumerate(_motif_keys(propagation.words)):
                for level, motif in enumerate(motifs):
                    vertex = vertex_of[level].setdefault(motif, len(motif_levels))
                    if vertex == len(motif_levels):
                        dictionary_levels.append(level + 1)
                        motif_levels.append(int(propagation.motif_levels[c]))
                        words.append(propagation.words[c, level][None])
                    motif_levels[vertex] = min(motif_levels[vertex], int(propagation.motif_levels[c]))
                    vertices[c, level] = vertex
            prototype_vertices.append(vertices)
            seen.append(np.unique(vertices))
            edges += [_edges(propagation, column) for column in vertices.T]
        counts = [len(propagation.constellations) for propagation in propagations]
        new_objects = np.repeat(np.arange(self.n_objects, self.n_objects + len(counts)), counts)
        support = np.bincount(np.concatenate([np.empty(0, np.int32), *seen]), minlength=len(motif_levels))
        support[: self.n_vertices] += self.support
        return MotifHierarchies(
            dictionary_levels=np.array(dictionary_levels, np.int32),
            motif_levels=np.array(motif_levels, np.int32),
            words=np.concatenate(words),
            support=support.astype(np.int64),
            edges=np.unique(np.concatenate(edges), axis=0),
            prototypes=np.concatenate([self.prototypes, *(p.histograms for p in propagations)]),
            prototype_vertices=np.concatenate(prototype_vertices),
            prototype_objects=np.concatenate([self.prototype_objects, new_objects]).astype(np.int32),
            prototype_constellations=np.concatenate(
                [self.prototype_constellations, *(p.constellations for p in propagations)]
            ),
            prototype_counts=np.concatenate([self.prototype_counts, np.ones(len(new_objects), np.int64)]),
            prototype_others=np.concatenate(
                [self.prototype_others, np.full((len(new_objects), N_OTHERS), -1, np.int32)]
            ),
            object_histograms=np.concatenate(
                [self.object_histograms, *(p.whole[None].astype(np.float16) for p in propagations)]
            ),
            object_names=(*self.object_names, *names),
        )

    def motif(self, vertex: int) -> tuple[int, ...]:
        """Words of a vertex, rising, repeated as often as they occur."""
        return tuple(int(word) for word in self.words[vertex] if word >= 0)

    def name(self, vertex: int) -> str:
        """Name of a vertex: "d3 m2 w1 w4" is words 1 and 4 of dictionary level 3, seen at motif level 2."""
        words = " ".join(f"w{word}" for word in self.motif(vertex))
        return f"d{self.dictionary_levels[vertex]} m{self.motif_levels[vertex]} {words}"

    def prototype_name(self, prototype: int) -> str:
        """Name of a prototype: "object5 s0 s2" is what segments 0 and 2 of training object 5 left."""
        segments = " ".join(f"s{i}" for i in segments_in(int(self.prototype_constellations[prototype])))
        return f"object{self.prototype_objects[prototype]} {segments}"

    def graph(self, dictionary_level: int) -> networkx.Graph:
        """One hierarchy for the tools of networkx.

        Parameters
        ----------
        dictionary_level : int
            From 1.

        Returns
        -------
        networkx.Graph
            Vertices by number, with the attributes `words`, `motif_level`, `n_prototypes`, `n_objects`.

        Raises
        ------
        ValueError
            If there is no such level.
        """
        # A fifth of a second to import, which nothing else here needs.
        import networkx

        if not 1 <= dictionary_level <= self.n_levels:
            raise ValueError(
                f"dictionary_level must be between 1 and {self.n_levels}, got {dictionary_level!r}"
            )
        n_prototypes = np.diff(self.prototypes_of.starts)
        graph = networkx.Graph(dictionary_level=dictionary_level)
        for vertex in np.flatnonzero(self.dictionary_levels == dictionary_level).tolist():
            graph.add_node(
                vertex,
                words=self.motif(vertex),
                motif_level=int(self.motif_levels[vertex]),
                n_prototypes=int(n_prototypes[vertex]),
                n_objects=int(self.support[vertex]),
            )
        graph.add_edges_from((a, b) for a, b in self.edges.tolist() if a in graph)
        return graph


def _motif_keys(words: NDArray[np.int32]) -> list[list[bytes]]:
    """The words of each constellation and level as something that a dict can look up."""
    k, n, width = words.shape
    flat, size = np.ascontiguousarray(words).tobytes(), width * words.itemsize
    return [[flat[i * size : (i + 1) * size] for i in range(c * n, (c + 1) * n)] for c in range(k)]


def _edges(propagation: Propagation, vertices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Edges that an object adds to one hierarchy, (e, 2)."""
    distinct, local = np.unique(vertices, return_inverse=True)
    is_linked = linked_vertices(
        propagation.constellations,
        propagation.motif_levels,
        np.ascontiguousarray(propagation.segment_edges, np.int32).reshape(-1, 2),
        local,
        len(distinct),
    )
    return distinct[np.argwhere(np.triu(is_linked))].astype(np.int32).reshape(-1, 2)
