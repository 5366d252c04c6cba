"""The motif hierarchies once more, slow and obvious: sets, dictionaries and formulas as they are written."""

import math
from collections import Counter
from dataclasses import dataclass, field
from itertools import combinations


def decompose(segment_edges, n_segments: int) -> dict[frozenset, int]:
    """Motif level of each constellation."""
    level_of = {frozenset([segment]): 1 for segment in range(n_segments)}
    current = {frozenset(edge) for edge in segment_edges}
    level = 2
    while current:
        level_of.update(dict.fromkeys(current, level))
        unions = {a | b for a, b in combinations(current, 2) if a & b}
        current = {union for union in unions if union not in level_of}
        level += 1
    return level_of


def jensen_shannon(p: list[float], q: list[float]) -> float:
    """Jensen-Shannon divergence in bits; 1 where one of the histograms has no mass."""
    if not any(p) or not any(q):
        return 1.0
    total = 0.0
    for a, b in zip(p, q, strict=True):
        if a > 0:
            total += 0.5 * a * math.log2(2 * a / (a + b))
        if b > 0:
            total += 0.5 * b * math.log2(2 * b / (a + b))
    return total


def nearest_word(histogram: list[float], words: list[list[float]], metric: str) -> int:
    """The nearest word; a tie that rounding would decide is a `TieError`."""
    scale = math.sqrt if metric == "hellinger" else float
    distances = [
        math.sqrt(sum((scale(a) - scale(b)) ** 2 for a, b in zip(histogram, word, strict=True)))
        for word in words
    ]
    in_order = sorted(distances)
    if len(words) > 1 and in_order[1] - in_order[0] < 1e-9:
        raise TieError
    return distances.index(in_order[0])


class TieError(Exception):
    """Two words are equally near."""


@dataclass
class SlowObject:
    """Masses of segments and of pairs of them, and the edges of the segment graph."""

    segments: list[list[float]]
    pairs: dict[tuple[int, int], list[float]]
    edges: list[tuple[int, int]]

    def histogram(self, constellation: frozenset) -> list[float]:
        parts = [self.segments[segment] for segment in constellation]
        parts += [mass for pair, mass in self.pairs.items() if set(pair) <= constellation]
        masses = [math.fsum(bins) for bins in zip(*parts, strict=True)]
        total = math.fsum(masses)
        return [mass / total for mass in masses] if total > 0 else masses


@dataclass
class Prototype:
    object_index: int
    segments: frozenset
    histogram: list[float]


@dataclass
class Vertex:
    motif_level: int
    prototypes: list[Prototype] = field(default_factory=list)


class SlowEnsemble:
    """Vertices are known by (dictionary level, sorted words), edges by their two vertices."""

    def __init__(self, words: list[list[list[float]]], metric: str, bandwidth: float) -> None:
        self.words, self.metric, self.bandwidth = words, metric, bandwidth
        self.vertices: dict[tuple, Vertex] = {}
        self.edges: set[tuple] = set()
        self.n_objects = 0

    def words_of(self, obj: SlowObject) -> list[list[int]]:
        """Word of each segment, at each level."""
        histograms = [obj.histogram(frozenset([segment])) for segment in range(len(obj.segments))]
        return [
            [nearest_word(histogram, words, self.metric) for histogram in histograms] for words in self.words
        ]

    def motifs_of(self, obj: SlowObject) -> list[dict[frozenset, tuple]]:
        """For each dictionary level, the motif of each constellation."""
        constellations = decompose(obj.edges, len(obj.segments))
        return [
            {c: (level, tuple(sorted(words[segment] for segment in c))) for c in constellations}
            for level, words in enumerate(self.words_of(obj), start=1)
        ]

    def learn(self, obj: SlowObject) -> None:
        level_of = decompose(obj.edges, len(obj.segments))
        histogram_of = {c: obj.histogram(c) for c in level_of}
        for motif_of in self.motifs_of(obj):
            for constellation, motif in motif_of.items():
                vertex = self.vertices.setdefault(motif, Vertex(level_of[constellation]))
                vertex.motif_level = min(vertex.motif_level, level_of[constellation])
                vertex.prototypes.append(
                    Prototype(self.n_objects, constellation, histogram_of[constellation])
                )
            for a, b in obj.edges:
                self._link(motif_of[frozenset([a])], motif_of[frozenset([b])])
            for a, b in combinations(level_of, 2):
                if level_of[a] == level_of[b] > 1 and a & b:
                    self._link(motif_of[a], motif_of[b])
        self.n_objects += 1

    def _link(self, a: tuple, b: tuple) -> None:
        self.edges.add((min(a, b), max(a, b)))

    def supported(self, min_support: int) -> set[tuple]:
        """Vertices that were seen in so many objects."""
        return {
            motif
            for motif, vertex in self.vertices.items()
            if len({prototype.object_index for prototype in vertex.prototypes}) >= min_support
        }

    def stimuli(self, obj: SlowObject, left_out: int | None = None) -> dict[tuple, float]:
        """Equation 1 at every vertex that the object activates, nothing dropped."""
        kernels: dict[tuple, float] = {}
        histogram_of = {c: obj.histogram(c) for c in decompose(obj.edges, len(obj.segments))}
        result: dict[tuple, float] = {}
        for motif_of in self.motifs_of(obj):
            for constellation, motif in motif_of.items():
                if motif not in self.vertices:
                    continue
                values = []
                for prototype in self.vertices[motif].prototypes:
                    if prototype.object_index == left_out:
                        continue
                    key = (constellation, prototype.object_index, prototype.segments)
                    if key not in kernels:
                        divergence = jensen_shannon(histogram_of[constellation], prototype.histogram)
                        kernels[key] = math.exp(-(divergence**2) / (2 * self.bandwidth**2))
                    values.append(kernels[key])
                mean = math.fsum(values) / len(values) if values else 0.0
                result[motif] = max(mean, result.get(motif, 0.0))
        return result


def prototypes_by_vertex(slow: SlowEnsemble) -> dict[tuple, Counter]:
    """For each vertex, training object and segments of its prototypes, as often as they occur."""
    return {
        motif: Counter((prototype.object_index, prototype.segments) for prototype in vertex.prototypes)
        for motif, vertex in slow.vertices.items()
    }


def without_ties(slow: SlowEnsemble, objects: list[SlowObject]) -> list[SlowObject]:
    """Objects whose words do not hang on rounding."""
    kept = []
    for one in objects:
        try:
            slow.words_of(one)
        except TieError:
            continue
        kept.append(one)
    return kept
