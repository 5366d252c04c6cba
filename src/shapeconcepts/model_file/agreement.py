"""Checks that parameters agree with what was learned with them: a file says some things twice."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.concepts import ConceptResponse, Filtration
from shapeconcepts.descriptors import Descriptor
from shapeconcepts.descriptors.registry import get_descriptor
from shapeconcepts.model_file.error import require
from shapeconcepts.motifs import MotifHierarchies, MotifHierarchyEnsemble, SegmentDictionary

# What float32 loses of a histogram, and with it of a word.
_WORD_TOLERANCE = 1e-5
# Logarithms and exponentials differ in their last bits between processors.
_TIME_TOLERANCE = 1e-9
# Rows that differ by less may have no variance that counts.
_LEAST_DIFFERENCE = 1e-6
_AT_ONCE = 2**14


def check_ensemble(
    ensemble: MotifHierarchyEnsemble,
    descriptor: str | Descriptor,
    sources: NDArray[np.int64],
    stimuli: csr_matrix,
    skipped: list[int],
) -> None:
    """Require that descriptor and parameters are those that dictionary, prototypes and stimuli come from.

    Parameters
    ----------
    ensemble : MotifHierarchyEnsemble
        Restored.
    descriptor : str or Descriptor
        One of this package.
    sources : (c,) int64
        Prototype or motif behind each column.
    stimuli : (n, c) csr_matrix
    skipped : list of int
        Rows of stimuli without an object.

    Raises
    ------
    ModelError
    """
    described_by: Any = get_descriptor(descriptor)
    n_bins = ensemble.n_features_in_
    require(
        described_by.n_bins == n_bins,
        f"descriptor {descriptor!s:.60} gives {described_by.n_bins} bins, "
        f"tensor dictionary.words has {n_bins}",
    )
    _check_dictionary(ensemble)
    known = ensemble.hierarchies_
    per_prototype = int(np.bincount(ensemble.imagined_.prototypes).max(initial=0))
    require(
        per_prototype <= ensemble.n_occlusions,
        f"ensemble.n_occlusions is {ensemble.n_occlusions}, tensor imagined.prototypes names one prototype "
        f"{per_prototype} times",
    )
    if not known.is_thinned:
        _check_constellations(known)
    object_of_row = np.cumsum(~np.isin(np.arange(stimuli.shape[0]), skipped)) - 1
    if ensemble.columns == "prototypes":
        n_all = len(known.prototypes)
        require(
            known.is_thinned or n_all <= 2 * ensemble.max_columns,
            f"tensor prototypes.counts must say that {n_all} prototypes stand for more, as "
            f"ensemble.max_columns is {ensemble.max_columns}",
        )
        require(
            len(sources) == n_all,
            f"tensor stimuli.sources must hold the {n_all} prototypes, got {len(sources)}",
        )
        rows = np.repeat(object_of_row, np.diff(stimuli.indptr))
        is_own = known.prototype_objects[sources][stimuli.indices] == rows
    else:
        require(
            np.array_equal(sources, ensemble.columns_),
            f"tensor stimuli.sources must hold the {len(ensemble.columns_)} motifs of at least "
            f"{ensemble.min_support} objects, as ensemble.min_support says, in their order",
        )
        is_own = known.support[sources][stimuli.indices] == 1
    n_own = int(is_own.sum())
    require(
        n_own == 0 or not ensemble.leave_own_out,
        f"ensemble.leave_own_out is true, {n_own} entries of tensor stimuli.columns are of a scan's own",
    )
    require(
        n_own > 0 or ensemble.leave_own_out or ensemble.columns == "motifs" or len(is_own) == 0,
        "ensemble.leave_own_out is false, no entry of tensor stimuli.columns is of a scan's own",
    )


def _check_constellations(known: MotifHierarchies) -> None:
    """Of each object, segments without a gap, and no constellation of others."""
    constellations, objects = known.prototype_constellations, known.prototype_objects
    starts = np.flatnonzero(np.diff(objects, prepend=-1))
    segments = np.where(constellations & (constellations - 1) == 0, constellations, 0)
    own, named = (np.bitwise_or.reduceat(values, starts) for values in (segments, constellations))
    are_whole = (own == named) & (own & (own + 1) == 0)
    require(
        bool(are_whole.all()),
        "tensor prototypes.constellations must hold those of each object's own segments, "
        f"{int((~are_whole).sum())} objects have others",
    )


def _check_dictionary(ensemble: MotifHierarchyEnsemble) -> None:
    dictionary, known = ensemble.dictionary_, ensemble.hierarchies_
    assert isinstance(dictionary, SegmentDictionary)
    n_levels = len(dictionary.words_)
    require(
        dictionary.n_levels == n_levels,
        f"ensemble.dictionary.n_levels is {dictionary.n_levels}, "
        f"tensor dictionary.level_sizes has {n_levels}",
    )
    if known.is_thinned:
        # Of most segments nothing is left to compare with.
        return
    constellations = known.prototype_constellations
    # Those that came after the words were learned have no part in them.
    segments = np.flatnonzero(constellations & (constellations - 1) == 0)[: len(dictionary.clusters_)]
    words = dictionary.clusters_ + dictionary._level_starts[:-1]
    sums = np.zeros_like(dictionary._embedded_words)
    for start in range(0, len(segments), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        rows = known.prototypes[segments[part]].astype(np.float64)
        embedded = np.sqrt(rows) if dictionary.metric == "hellinger" else rows
        numbers = np.arange(words[part].size) // n_levels
        shape = len(sums), len(rows)
        sums += csr_matrix((np.ones(words[part].size), (words[part].ravel(), numbers)), shape) @ embedded
    counts = np.bincount(words.ravel(), minlength=len(sums))
    distances = np.abs(sums - counts[:, None] * dictionary._embedded_words).max(axis=1)
    differs = np.flatnonzero((counts == 0) | (distances > _WORD_TOLERANCE * counts))
    require(
        len(differs) == 0,
        "tensor dictionary.words must hold the means of the segments in dictionary.clusters under "
        f"ensemble.dictionary.metric {dictionary.metric!r}, {len(differs)} of {len(sums)} are others",
    )


def check_filtration(filtration: Filtration, description: dict[str, Any]) -> None:
    """Require that times, granularity and concepts are those that parameters and annexations give.

    Parameters
    ----------
    filtration : Filtration
        Restored, but for what follows from parameters and annexations alone.
    description : dict

    Raises
    ------
    ModelError
    """
    size, persists = filtration.min_concept_size, filtration.stop == "persistence"
    require(
        not persists or filtration.heat == "divergence",
        f"filtration.heat must be 'divergence' where stop is 'persistence', got {filtration.heat!r}",
    )
    time = 1 - description["granularity"] if persists else description["epsilon_max"]
    for field, expected in (
        ("epsilon_max", filtration.epsilon_max_),
        ("granularity", filtration.granularity_),
        ("concept_time", time if filtration.concepts_ else None),
    ):
        found = description[field]
        is_same = found is expected or (
            found is not None
            and expected is not None
            and math.isclose(found, expected, abs_tol=_TIME_TOLERANCE)
        )
        require(is_same, f"{field} must be {expected}, as the parameters of filtration say, got {found}")
    is_tested = filtration._history.dying_sizes >= size
    found_tested = ~np.isnan(filtration.p_values_)
    expected_tested = is_tested if persists else np.zeros_like(is_tested)
    require(
        np.array_equal(found_tested, expected_tested),
        f"tensor filtration.p_values must hold {int(expected_tested.sum())} numbers, where "
        f"filtration.stop {filtration.stop!r} tests splits of at least filtration.min_concept_size "
        f"{size}, and NaN else, got {int(found_tested.sum())}",
    )
    if not persists:
        expected_labels = np.full_like(filtration.labels_, -1) if time is None else filtration.labels_at(time)
        require(
            np.array_equal(filtration.labels_, expected_labels),
            f"tensor concepts.labels must name the groups of at least filtration.min_concept_size {size} "
            "at epsilon_max, the largest first",
        )


def check_response(response: ConceptResponse, rows: csr_matrix) -> None:
    """Require as many components as the parameters ask for.

    Parameters
    ----------
    response : ConceptResponse
        Restored.
    rows : (n, c) csr_matrix
        Of the training scans, with sum 1 or empty.

    Raises
    ------
    ModelError
    """
    n_columns, n_found = response.whitening_.shape
    fewest = most = 0
    if response.distance == "mahalanobis":
        placed = rows[np.diff(rows.indptr) > 0]
        most = max(0, min(response.max_components, placed.shape[0] - 1, n_columns))
        if most:
            spread = (placed.max(axis=0) - placed.min(axis=0)).max()
            fewest = int(spread > _LEAST_DIFFERENCE)
    require(
        fewest <= n_found <= most,
        f"tensor response.whitening must have {fewest} to {most} components, as response.distance is "
        f"{response.distance!r} and response.max_components {response.max_components}, has {n_found}",
    )
