"""Random described objects, and what the motif hierarchies learned from them, in plain Python."""

import copy
import dataclasses
import warnings
from collections import Counter
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st
from motif_reference import SlowObject

from shapeconcepts import DescribedObject, MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.descriptors import Description
from shapeconcepts.segmentation import SegmentedObject

# The paper's stimuli; those of single prototypes have tests of their own.
MotifColumns = partial(MotifHierarchyEnsemble, columns="motifs")

GRAPHS = ("random", "sparse", "chain", "star", "cycle", "complete", "tree", "spider", "two parts", "none")


def segment_graph(rng: np.random.Generator, kind: str, n: int) -> list[tuple[int, int]]:
    """Edges of a graph of n segments whose names are shuffled; some twice, some turned around."""
    if kind == "random":
        edges = [(a, b) for a in range(n) for b in range(a) if rng.random() < 0.5]
    elif kind == "sparse":
        edges = [(a, b) for a in range(n) for b in range(a) if rng.random() < 0.25]
    elif kind == "chain":
        edges = [(a, a + 1) for a in range(n - 1)]
    elif kind == "star":
        edges = [(0, a) for a in range(1, n)]
    elif kind == "cycle":
        edges = [(a, (a + 1) % n) for a in range(n if n > 2 else n - 1)]
    elif kind == "complete":
        edges = [(a, b) for a in range(n) for b in range(a)]
    elif kind == "tree":
        edges = [(int(rng.integers(a)), a) for a in range(1, n)]
    elif kind == "spider":  # three legs
        edges = [(max(a - 3, 0), a) for a in range(1, n)]
    elif kind == "two parts":
        half = n // 2
        edges = [(a, a + 1) for a in range(half - 1)] + [
            (a, b) for a in range(half, n) for b in range(half, a)
        ]
    else:
        assert kind == "none"
        edges = []
    names = rng.permutation(n)
    edges = [(int(names[a]), int(names[b])) for a, b in edges]
    edges += [(b, a) for a, b in edges if rng.random() < 0.1]
    return [edges[i] for i in rng.permutation(len(edges))]


def segment_mass(rng: np.random.Generator, kinds: np.ndarray) -> np.ndarray:
    """One of a few kinds of segment: exactly, with noise, or as nothing at all."""
    draw = rng.random()
    if draw < 0.08:
        return np.zeros(kinds.shape[1])
    kind = kinds[rng.integers(len(kinds))]
    if draw < 0.3:
        return kind * rng.integers(1, 4)
    return kind * rng.gamma(8, 1 / 8, size=kind.shape) * rng.uniform(1, 50)


def random_object(
    rng: np.random.Generator, kinds: np.ndarray, n_segments: int, graph: str, *, with_pairs: bool
) -> SlowObject:
    n_bins = kinds.shape[1]
    pairs = {}
    if with_pairs:
        pairs = {
            (a, b): rng.gamma(0.5, 3, n_bins) if rng.random() < 0.8 else np.zeros(n_bins)
            for a in range(n_segments)
            for b in range(a + 1, n_segments)
        }
    return SlowObject(
        segments=[segment_mass(rng, kinds).tolist() for _ in range(n_segments)],
        pairs={pair: mass.tolist() for pair, mass in pairs.items()},
        edges=segment_graph(rng, graph, n_segments),
    )


def kinds_of_segments(rng: np.random.Generator, n_kinds: int = 4, n_bins: int = 6) -> np.ndarray:
    kinds = rng.gamma(0.6, 1, size=(n_kinds, n_bins)) * (rng.random((n_kinds, n_bins)) < 0.8)
    kinds[:, 0] += 0.01
    return kinds


def random_objects(
    rng: np.random.Generator, n_objects: int, kinds: np.ndarray, max_segments: int = 5, *, with_pairs=False
) -> list[SlowObject]:
    return [
        random_object(
            rng, kinds, int(rng.integers(1, max_segments + 1)), str(rng.choice(GRAPHS)), with_pairs=with_pairs
        )
        for _ in range(n_objects)
    ]


@st.composite
def adversarial_objects(draw) -> list[SlowObject]:
    """Few bins, masses of small integers: equal histograms, empty ones, equal words everywhere."""
    n_bins = draw(st.integers(1, 3))
    masses = st.lists(st.sampled_from([0.0, 0.0, 1.0, 2.0, 5.0]), min_size=n_bins, max_size=n_bins)
    objects = []
    for _ in range(draw(st.integers(1, 4))):
        n_segments = draw(st.integers(1, 5))
        edge = st.tuples(st.integers(0, n_segments - 1), st.integers(0, n_segments - 1))
        edges = draw(st.lists(edge.filter(lambda e: e[0] != e[1]), max_size=8)) if n_segments > 1 else []
        pairs = {}
        if draw(st.booleans()):
            pairs = {tuple(sorted(e)): draw(masses) for e in edges}
        segments = draw(st.lists(masses, min_size=n_segments, max_size=n_segments))
        objects.append(SlowObject(segments, pairs, edges))
    return objects


def described(slow: SlowObject, name: str = "") -> DescribedObject:
    pairs = list(slow.pairs)
    n_bins = len(slow.segments[0])
    return DescribedObject(
        Description(
            np.array(slow.segments),
            np.array(pairs, np.int32).reshape(-1, 2),
            np.array([slow.pairs[pair] for pair in pairs]).reshape(-1, n_bins),
        ),
        np.array(slow.edges, np.int32).reshape(-1, 2),
        name=name,
    )


def fit_dictionary(objects: list[DescribedObject], n_levels: int, metric: str = "hellinger"):
    """Dictionary of the objects' segments; too few different ones are no news here."""
    rows = [one.description.histograms(1 << np.arange(one.n_segments)) for one in objects]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return SegmentDictionary(n_levels, metric).fit(np.concatenate(rows))


def segments_of(constellation: int) -> frozenset:
    return frozenset(segment for segment in range(64) if int(constellation) >> segment & 1)


def motif_keys(hierarchies) -> list[tuple]:
    """(dictionary level, sorted words) of each vertex."""
    return [
        (int(level), tuple(int(word) for word in words if word >= 0))
        for level, words in zip(hierarchies.dictionary_levels, hierarchies.words, strict=True)
    ]


def learned(hierarchies) -> tuple[dict, dict, set]:
    """Motif level and prototypes (training object and segments) of each vertex, and the edges."""
    keys = motif_keys(hierarchies)
    levels = dict(zip(keys, hierarchies.motif_levels.tolist(), strict=True))
    assert len(levels) == len(keys), "a motif has two vertices"
    prototypes = {key: Counter() for key in keys}
    for objects, constellation, vertices in zip(
        hierarchies.prototype_objects.tolist(),
        hierarchies.prototype_constellations.tolist(),
        hierarchies.prototype_vertices.tolist(),
        strict=True,
    ):
        for vertex in vertices:
            prototypes[keys[vertex]][objects, segments_of(constellation)] += 1
    edges = [(keys[a], keys[b]) for a, b in hierarchies.edges.tolist()]
    unique = {(min(edge), max(edge)) for edge in edges}
    assert len(unique) == len(edges), "an edge is there twice"
    return levels, prototypes, unique


def rows_by_motif(model, rows) -> list[dict[tuple, float]]:
    """Sparse rows as dictionaries from motif to stimulus."""
    keys = motif_keys(model.hierarchies_)
    assert rows.shape[1] == len(model.columns_)
    result = []
    for start, stop in zip(rows.indptr[:-1], rows.indptr[1:], strict=True):
        columns = rows.indices[start:stop]
        assert (np.diff(columns) > 0).all()
        result.append(
            {
                keys[model.columns_[column]]: float(value)
                for column, value in zip(columns, rows.data[start:stop], strict=True)
            }
        )
    return result


def assert_same_rows(a, b) -> None:
    """Bit for bit."""
    assert a.shape == b.shape
    np.testing.assert_array_equal(a.indptr, b.indptr)
    np.testing.assert_array_equal(a.indices, b.indices)
    assert a.data.tobytes() == b.data.tobytes()


def segmented_objects(n: int, seed: int = 0) -> list[SegmentedObject]:
    """Half ellipsoids, their points in one to four sectors."""
    rng = np.random.default_rng(seed)
    objects = []
    for index in range(n):
        directions = rng.normal(size=(250, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        directions[:, 2] = np.abs(directions[:, 2])
        radii = rng.uniform(0.03, 0.09, 3)
        normals = directions / radii + 0.5 * rng.normal(size=(250, 3))
        n_segments = 1 + index % 4
        angles = np.arctan2(directions[:, 1], directions[:, 0]) / (2 * np.pi) + 0.5
        labels = np.minimum(angles * n_segments, n_segments - 1).astype(np.int32)
        labels[rng.uniform(size=250) < 0.05] = -1
        edges = [sorted((a, (a + 1) % n_segments)) for a in range(n_segments)] if n_segments > 2 else [[0, 1]]
        objects.append(
            SegmentedObject(
                points=directions * radii,
                normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
                patch_labels=labels,
                segment_labels=labels,
                segment_edges=np.array(edges if n_segments > 1 else [], np.int32).reshape(-1, 2),
                n_segments=n_segments,
                point_to_voxel=np.arange(250, dtype=np.int32),
                voxel_size=0.005,
                name=f"object {index}",
            )
        )
    return objects


class Example(NamedTuple):
    """Objects to learn from, others, and what was learned: a dictionary of three levels and an ensemble."""

    slow_objects: list[SlowObject]
    train: list[DescribedObject]
    new: list[DescribedObject]
    dictionary: SegmentDictionary
    model: MotifHierarchyEnsemble


@cache
def example() -> Example:
    rng = np.random.default_rng(7)
    slow_objects = random_objects(rng, 36, kinds_of_segments(rng, 3), with_pairs=True)
    objects = [described(one, f"object {index}") for index, one in enumerate(slow_objects)]
    train, new = objects[:24], objects[24:]
    dictionary = fit_dictionary(train, 3)
    return Example(slow_objects, train, new, dictionary, MotifColumns(dictionary).fit(train))


def snapshot(hierarchies) -> list:
    """Everything that a hierarchy holds, copied."""
    fields = dataclasses.fields(hierarchies)
    return [copy.deepcopy(getattr(hierarchies, field.name)) for field in fields]


def assert_unchanged(hierarchies, before: list) -> None:
    for field, value in zip(dataclasses.fields(hierarchies), before, strict=True):
        np.testing.assert_array_equal(getattr(hierarchies, field.name), value, err_msg=field.name)
