"""Checks of the tensors of a file, so that none can lead a kernel astray: the checksum may be forged."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from shapeconcepts.model_file.error import require
from shapeconcepts.model_file.layout import Tensors
from shapeconcepts.motifs.decomposition import MAX_SEGMENTS
from shapeconcepts.motifs.hierarchy import N_OTHERS

# What float32 loses in the sum of a histogram.
_SUM_TOLERANCE = 1e-4
# And float16.
_HALF_SUM_TOLERANCE = 2e-3
# Far above any scale of a component, far below what overflows when squared.
_LARGEST_WEIGHT = 1e30


def check_content(tensors: Tensors, skipped: list[int], columns_are: str) -> None:
    """Require values in range, indices that lead somewhere, and a tree that is one.

    Parameters
    ----------
    tensors : dict
        Types and shapes as in the layout.
    skipped : list of int
        Rows of stimuli that must be empty.
    columns_are : {"prototypes", "motifs"}
        What the columns of the stimuli stand for.

    Raises
    ------
    ModelError
    """
    _check_dictionary(tensors)
    _check_motifs(tensors)
    _check_prototypes(tensors, len(tensors["concepts.labels"]) - len(skipped))
    _check_stimuli(tensors, skipped, columns_are)
    _check_space(tensors)
    _check_filtration(tensors)
    _check_concepts(tensors)
    _check_response(tensors)


def _check_dictionary(tensors: Tensors) -> None:
    sizes, parents = tensors["dictionary.level_sizes"], tensors["dictionary.parents"]
    n_words, n_bins = tensors["dictionary.words"].shape
    require(len(sizes) >= 1 and n_bins >= 1, "holds no dictionary level or no bins")
    _check_range(tensors, "dictionary.level_sizes", 1, n_words)
    require(
        int(sizes.sum()) == n_words,
        f"tensor dictionary.level_sizes must sum to the {n_words} words, got {int(sizes.sum())}",
    )
    _check_range(tensors, "dictionary.words", 0, 1 + _SUM_TOLERANCE)
    sizes_above = np.concatenate([[1], sizes[:-1]])
    is_above = (parents >= 0) & (parents < np.repeat(sizes_above, sizes))
    _require_all("dictionary.parents", is_above, parents, "words of the level above")
    clusters = tensors["dictionary.clusters"]
    _require_all("dictionary.clusters", (clusters >= 0) & (clusters < sizes), clusters, "words of each level")


def _check_motifs(tensors: Tensors) -> None:
    sizes = tensors["dictionary.level_sizes"]
    levels, words, edges = (
        tensors["motifs.dictionary_levels"], tensors["motifs.words"], tensors["motifs.edges"],
    )  # fmt: skip
    _check_width("motifs.words", words, MAX_SEGMENTS)
    _check_range(tensors, "motifs.dictionary_levels", 1, len(sizes))
    _check_range(tensors, "motifs.motif_levels", 1, MAX_SEGMENTS)
    is_rising = (words[:, 1:] >= words[:, :-1]).all(axis=1)
    in_range = (words[:, 0] >= -1) & (words[:, -1] >= 0) & (words[:, -1] < sizes[levels - 1])
    _require_all("motifs.words", is_rising & in_range, words, "rising words of the motif's level")
    n_distinct = len(np.unique(np.column_stack([levels, words]), axis=0))
    require(n_distinct == len(words), "tensor motifs.words must hold every motif once")
    _check_range(tensors, "motifs.support", 1, len(tensors["objects.histograms"]))
    _check_range(tensors, "motifs.edges", 0, len(levels) - 1)
    same_level = levels[edges[:, 0]] == levels[edges[:, 1]]
    _require_all(
        "motifs.edges",
        (edges[:, 0] <= edges[:, 1]) & same_level,
        edges,
        "rising pairs of motifs of one dictionary level",
    )
    _require_sorted("motifs.edges", edges)


def _check_prototypes(tensors: Tensors, n_objects: int) -> None:
    levels, motifs = tensors["motifs.dictionary_levels"], tensors["prototypes.motifs"]
    objects = tensors["prototypes.objects"]
    for name, tolerance in (
        ("prototypes.histograms", _SUM_TOLERANCE),
        ("objects.histograms", _HALF_SUM_TOLERANCE),
        ("imagined.histograms", _HALF_SUM_TOLERANCE),
    ):
        _check_range(tensors, name, 0, 1 + tolerance)
        sums = tensors[name].sum(axis=1, dtype=np.float64)
        is_scaled = (np.abs(sums - 1) < tolerance) | (sums == 0)
        _require_all(name, is_scaled, sums, "rows of sum 1 or 0")
    _check_range(tensors, "objects.distances", 0, 1)
    _check_range(tensors, "imagined.prototypes", 0, len(objects) - 1)
    _check_range(tensors, "prototypes.motifs", 0, len(levels) - 1)
    _require_all(
        "prototypes.motifs",
        levels[motifs] == np.arange(1, motifs.shape[1] + 1),
        motifs,
        "a motif of each dictionary level",
    )
    _check_range(tensors, "prototypes.objects", 0, n_objects - 1)
    counts, steps = tensors["prototypes.counts"], np.diff(objects, prepend=-1, append=n_objects)
    _check_range(tensors, "prototypes.counts", 1, n_objects * 2**MAX_SEGMENTS)
    _check_width("prototypes.others", tensors["prototypes.others"], N_OTHERS)
    _check_range(tensors, "prototypes.others", -1, n_objects - 1)
    is_thinned = counts.sum() > len(counts)
    require(
        bool((steps >= 0).all() and (is_thinned or (steps <= 1).all())),
        f"tensor prototypes.objects must rise from 0 to {n_objects - 1}, without a gap where each prototype "
        "stands for itself only",
    )
    n_whole = len(tensors["objects.histograms"])
    require(n_whole == n_objects, f"tensor objects.histograms must hold {n_objects} objects, has {n_whole}")
    _check_range(tensors, "prototypes.constellations", 1, 2**MAX_SEGMENTS - 1)
    constellations, n_segments = tensors["prototypes.constellations"], len(tensors["dictionary.clusters"])
    n_single = int((constellations & (constellations - 1) == 0).sum())
    require(
        is_thinned or n_single >= n_segments,
        f"tensor prototypes.constellations must hold at least {n_segments} segments, got {n_single}",
    )


def _check_stimuli(tensors: Tensors, skipped: list[int], columns_are: str) -> None:
    sources, lengths = tensors["stimuli.sources"], tensors["stimuli.row_lengths"]
    columns, values = tensors["stimuli.columns"], tensors["stimuli.values"]
    if columns_are == "prototypes":
        _check_range(tensors, "stimuli.sources", 0, len(tensors["prototypes.objects"]) - 1)
        is_own = sources == np.arange(len(sources))
        _require_all("stimuli.sources", is_own, sources, "the prototypes in their order")
    else:
        _check_range(tensors, "stimuli.sources", 0, len(tensors["motifs.words"]) - 1)
    require(len(np.unique(sources)) == len(sources), "tensor stimuli.sources must hold every column once")
    _check_range(tensors, "stimuli.row_lengths", 0, len(values))
    require(
        int(lengths.sum()) == len(values),
        f"tensor stimuli.row_lengths must sum to the {len(values)} entries, got {int(lengths.sum())}",
    )
    require(not lengths[skipped].any(), "tensor stimuli.row_lengths must be 0 for scans that were skipped")
    _check_range(tensors, "stimuli.columns", 0, len(sources) - 1)
    row_of = np.repeat(np.arange(len(lengths)), lengths)
    is_rising = (np.diff(columns) > 0) | (np.diff(row_of) > 0)
    _require_all("stimuli.columns", is_rising, columns[1:], "rising columns in each row")
    _check_range(tensors, "stimuli.values", 0, 1)
    _require_all("stimuli.values", values > 0, values, "positive numbers")


def _check_space(tensors: Tensors) -> None:
    vertices, edges = tensors["space.vertices"], tensors["space.edges"]
    is_placed = tensors["stimuli.row_lengths"] > 0
    _require_all(
        "space.vertices", (vertices >= 0) == is_placed, vertices, "-1 for empty rows, and only there"
    )
    n_vertices = len(edges) + 1 if (vertices >= 0).any() else 0
    _check_range(tensors, "space.vertices", -1, n_vertices - 1)
    require(
        len(np.unique(vertices[vertices >= 0])) == n_vertices and len(edges) == max(n_vertices - 1, 0),
        f"tensor space.edges must be a tree of the vertices in space.vertices, got {len(edges)} edges",
    )
    _check_range(tensors, "space.edges", 0, n_vertices - 1)
    adjacency = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (n_vertices, n_vertices))
    n_components = connected_components(adjacency, directed=False)[0] if n_vertices else 0
    require(n_components <= 1, f"tensor space.edges must be a tree, got {n_components} components")
    _require_all("space.edges", edges[:, 0] < edges[:, 1], edges, "the smaller vertex first")
    _require_sorted("space.edges", edges)
    _check_range(tensors, "space.divergences", 0, 1)


def _check_filtration(tensors: Tensors) -> None:
    order, times, p_values = (tensors[f"filtration.{name}"] for name in ("order", "times", "p_values"))
    require(
        np.array_equal(np.sort(order), np.arange(len(order))),
        "tensor filtration.order must hold every edge of the tree once",
    )
    _check_range(tensors, "filtration.times", 0, 1)
    is_later = (times > 0) & (np.diff(times, prepend=0) >= 0)
    _require_all("filtration.times", is_later, times, "rising numbers above 0")
    in_range = np.isnan(p_values) | ((p_values >= 0) & (p_values <= 1))
    _require_all("filtration.p_values", in_range, p_values, "numbers from 0 to 1, or NaN")


def _check_concepts(tensors: Tensors) -> None:
    labels, medoids = tensors["concepts.labels"], tensors["concepts.medoids"]
    births, deaths = tensors["concepts.births"], tensors["concepts.deaths"]
    n_concepts = len(medoids)
    _check_range(tensors, "concepts.labels", -1, n_concepts - 1)
    is_placed = tensors["space.vertices"] >= 0
    _require_all("concepts.labels", (labels < 0) | is_placed, labels, "-1 for empty rows")
    require(
        len(np.unique(labels[labels >= 0])) == n_concepts,
        f"tensor concepts.labels must name all of the {n_concepts} concepts",
    )
    _check_range(tensors, "concepts.medoids", 0, len(labels) - 1)
    _require_all(
        "concepts.medoids", labels[medoids] == np.arange(n_concepts), medoids, "a member of each concept"
    )
    _check_range(tensors, "concepts.births", 0, 1)
    is_later = (deaths >= births) & ((deaths <= 1) | (deaths == np.inf))
    _require_all("concepts.deaths", is_later, deaths, "times from births on, up to 1 or infinite")


def _check_response(tensors: Tensors) -> None:
    n_columns, n_components = tensors["response.whitening"].shape
    require(
        n_components <= n_columns,
        f"tensor response.whitening must have at most {n_columns} components, has {n_components}",
    )
    _check_range(tensors, "response.mean", 0, 1)
    _check_range(tensors, "response.whitening", -_LARGEST_WEIGHT, _LARGEST_WEIGHT)


def _check_width(name: str, rows: NDArray[Any], n_columns: int) -> None:
    require(rows.shape[1] == n_columns, f"tensor {name} must have {n_columns} columns, has {rows.shape[1]}")


def _check_range(tensors: Tensors, name: str, smallest: float, largest: float) -> None:
    values = tensors[name]
    # Written so that NaN is out of range.
    in_range = (values >= smallest) & (values <= largest)
    if not in_range.all():
        found = values[~in_range].flat[0]
        require(False, f"tensor {name} must hold numbers from {smallest} to {largest}, got {found}")


def _require_all(name: str, is_valid: NDArray[np.bool_], values: NDArray[Any], expected: str) -> None:
    if not is_valid.all():
        position = int(np.flatnonzero(~is_valid.reshape(len(is_valid), -1).all(axis=1))[0])
        require(False, f"tensor {name} must hold {expected}, got {values[position]!s:.80}")


def _require_sorted(name: str, edges: NDArray[np.int32]) -> None:
    step = np.diff(edges, axis=0)
    is_later = (step[:, 0] > 0) | ((step[:, 0] == 0) & (step[:, 1] > 0))
    _require_all(name, is_later, edges[1:], "sorted pairs, each once")
