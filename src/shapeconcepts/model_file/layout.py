"""What a model file holds: the tensors with their types and shapes, and the fields of the description."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.model_file.error import require

FORMAT = 10

Tensors = dict[str, NDArray[Any]]

# Types in which the longest tensors are written where they lose nothing by it.
SMALLER = {"stimuli.columns": "uint16", "stimuli.values": "float16"}

# Lengths are numbers or names; a name stands for the same length wherever it occurs.
LAYOUT: dict[str, tuple[str, tuple[str | int, ...]]] = {
    "dictionary.level_sizes": ("int64", ("levels",)),
    # In the space in which words are near: square roots of histograms under the Hellinger metric.
    "dictionary.words": ("float64", ("words", "bins")),
    "dictionary.parents": ("int32", ("words",)),
    "dictionary.clusters": ("int32", ("segments", "levels")),
    "motifs.dictionary_levels": ("int32", ("motifs",)),
    "motifs.motif_levels": ("int32", ("motifs",)),
    "motifs.words": ("int32", ("motifs", "segments of a motif")),
    "motifs.support": ("int64", ("motifs",)),
    "motifs.edges": ("int32", ("links", 2)),
    "prototypes.histograms": ("float32", ("prototypes", "bins")),
    "prototypes.motifs": ("int32", ("prototypes", "levels")),
    "prototypes.objects": ("int32", ("prototypes",)),
    "prototypes.constellations": ("int64", ("prototypes",)),
    # What they stand for.
    "prototypes.counts": ("int64", ("prototypes",)),
    "prototypes.others": ("int32", ("prototypes", "others")),
    "objects.histograms": ("float16", ("objects", "bins")),
    # To the nearest other object, as wholes.
    "objects.distances": ("float64", ("objects",)),
    # What imagined occlusions leave of prototypes.
    "imagined.histograms": ("float16", ("imagined", "bins")),
    "imagined.prototypes": ("int32", ("imagined",)),
    # Prototypes or motifs, as the parameter columns says.
    "stimuli.sources": ("int64", ("columns",)),
    "stimuli.row_lengths": ("int64", ("scans",)),
    "stimuli.columns": ("int32", ("stimuli",)),
    "stimuli.values": ("float64", ("stimuli",)),
    "space.vertices": ("int32", ("scans",)),
    "space.edges": ("int32", ("edges", 2)),
    "space.divergences": ("float64", ("edges",)),
    # Edges of the space as they enter, and when; p-values are NaN where no split is tested.
    "filtration.order": ("int64", ("edges",)),
    "filtration.times": ("float64", ("edges",)),
    "filtration.p_values": ("float64", ("edges",)),
    "concepts.labels": ("int32", ("scans",)),
    "concepts.medoids": ("int64", ("concepts",)),
    "concepts.births": ("float64", ("concepts",)),
    "concepts.deaths": ("float64", ("concepts",)),
    "response.mean": ("float64", ("columns",)),
    "response.whitening": ("float64", ("columns", "components")),
}

FIELDS = frozenset(
    {
        "format",
        "written_by",
        "checksum",
        "stages",
        "scan_names",
        "scan_labels",
        "skipped",
        "concept_names",
        "concept_keys",
        "n_identities",
        "history",
        "group_names",
        "granularity",
        "concept_time",
        "epsilon_max",
        "largest_divergence",
    }
)

STAGES = frozenset({"segmenter", "descriptor", "ensemble", "filtration", "response"})


def check_names(what: str, names: set[str], expected: set[str] | frozenset[str]) -> None:
    """Require exactly the expected names.

    Raises
    ------
    ModelError
        If one is missing or there is one more.
    """
    missing, unknown = sorted(expected - names), sorted(names - expected)
    require(not missing, f"misses the {what} {', '.join(missing[:3])}")
    require(not unknown, f"holds an unknown {what} {', '.join(map(repr, unknown[:3]))[:200]}")


def check_layout(found: Mapping[str, tuple[str, tuple[int, ...]]]) -> None:
    """Require the tensors of a model, each with its type, in shapes that fit each other.

    Parameters
    ----------
    found : mapping of str to (str, tuple of int)
        Type and shape of each tensor.

    Raises
    ------
    ModelError
        If a tensor is missing, unknown, of another type, or of a shape that does not fit.
    """
    check_names("tensor", set(found), set(LAYOUT))
    lengths: dict[str, int] = {}
    for name, (expected_type, dimensions) in LAYOUT.items():
        data_type, shape = found[name]
        is_expected = data_type in (expected_type, SMALLER.get(name))
        require(is_expected, f"tensor {name} must be {expected_type}, is {data_type}")
        fits = len(shape) == len(dimensions) and all(
            length == (lengths.setdefault(dimension, length) if isinstance(dimension, str) else dimension)
            for dimension, length in zip(dimensions, shape, strict=True)
        )
        expected = ", ".join(str(lengths.get(str(d), d)) for d in dimensions)
        require(fits, f"tensor {name} must have shape ({expected}), has {shape}")


def checked_tensors(tensors: Mapping[str, NDArray[Any]]) -> Tensors:
    """Contiguous arrays in the types of the layout, or smaller ones that hold the same numbers.

    Raises
    ------
    ModelError
        As in `check_layout`.
    """
    arrays = {name: np.ascontiguousarray(tensors[name], LAYOUT[name][0]) for name in LAYOUT}
    for name, smaller in SMALLER.items():
        with np.errstate(over="ignore"):
            small = arrays[name].astype(smaller)
        if np.array_equal(small, arrays[name]):
            arrays[name] = small
    check_layout({name: (array.dtype.name, array.shape) for name, array in arrays.items()})
    return arrays


def widened(tensors: Tensors) -> Tensors:
    """All tensors in the types of the layout."""
    return {name: tensor.astype(LAYOUT[name][0], copy=False) for name, tensor in tensors.items()}
