"""From a fitted model's state to its file."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.heap import give_back
from shapeconcepts.model_file.container import write_container
from shapeconcepts.model_file.error import ModelError
from shapeconcepts.model_file.layout import FORMAT, Tensors, checked_tensors
from shapeconcepts.model_file.loading import restore_state
from shapeconcepts.model_file.parameters import encode_parameters
from shapeconcepts.model_file.state import ModelState
from shapeconcepts.motifs import MotifHierarchyEnsemble
from shapeconcepts.version import __version__


def write_state(path: str | PathLike[str], state: ModelState) -> None:
    """Write the state of a model to a file, completely or not at all.

    The same state gives the same bytes. A file that is there is replaced and keeps its permissions; where the
    path is a link, the file that it leads to is replaced. `n_jobs` is not kept.

    Raises
    ------
    ModelError
        If the model has a stage of one's own, or was changed so that its parts no longer fit each other.
    OSError
        If the file cannot be written.
    """
    try:
        description = json.loads(json.dumps(_description(state), allow_nan=False))
        tensors = checked_tensors(_tensors(state))
        give_back()
        # A file that could not be loaded again would be worth nothing.
        restore_state(tensors, description)
        give_back()
    except (ModelError, TypeError, ValueError) as error:
        raise ModelError(f"model cannot be saved: {error}") from None
    write_container(Path(path), tensors, description)


def _description(state: ModelState) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "written_by": f"shapeconcepts {__version__}",
        "stages": {
            "segmenter": encode_parameters(state.segmenter),
            "descriptor": encode_parameters(state.descriptor),
            "ensemble": {
                **encode_parameters(MotifHierarchyEnsemble(**state.ensemble._learned_with)),
                "dictionary": encode_parameters(state.ensemble.dictionary_),
            },
            "filtration": encode_parameters(state.filtration),
            "response": encode_parameters(state.response),
        },
        "scan_names": state.scan_names,
        "scan_labels": state.scan_labels,
        "skipped": sorted(state.skipped.items()),
        "concept_names": [concept.name for concept in state.filtration.concepts_],
        "concept_keys": [concept.key for concept in state.filtration.concepts_],
        "n_identities": state.n_identities,
        "history": [
            [update.n_before, update.n_after, [list(one) for one in update.changes], update.moved]
            for update in state.history
        ],
        "group_names": state.filtration._group_names(),
        "granularity": state.filtration.granularity_,
        "concept_time": state.filtration.concept_time_,
        "epsilon_max": state.filtration.epsilon_max_,
        "largest_divergence": state.response.largest_divergence_,
    }


def _tensors(state: ModelState) -> Tensors:
    if state.novelty is None:
        raise ModelError("a model with an ensemble of one's own cannot be saved")
    dictionary, hierarchies = state.ensemble.dictionary_, state.ensemble.hierarchies_
    space, concepts = state.filtration.space_, state.filtration.concepts_
    return {
        "dictionary.level_sizes": np.diff(dictionary._level_starts),
        "dictionary.words": dictionary._embedded_words,
        "dictionary.parents": np.concatenate(dictionary.parents_),
        "dictionary.clusters": dictionary.clusters_,
        "motifs.dictionary_levels": hierarchies.dictionary_levels,
        "motifs.motif_levels": hierarchies.motif_levels,
        "motifs.words": hierarchies.words,
        "motifs.support": hierarchies.support,
        "motifs.edges": hierarchies.edges,
        "prototypes.histograms": hierarchies.prototypes,
        "prototypes.motifs": hierarchies.prototype_vertices,
        "prototypes.objects": hierarchies.prototype_objects,
        "prototypes.constellations": hierarchies.prototype_constellations,
        "prototypes.counts": hierarchies.prototype_counts,
        "prototypes.others": hierarchies.prototype_others,
        "objects.histograms": hierarchies.object_histograms,
        "objects.distances": state.novelty.distances,
        "imagined.histograms": state.ensemble.imagined_.histograms,
        "imagined.prototypes": state.ensemble.imagined_.prototypes,
        "stimuli.sources": state.ensemble.columns_,
        "stimuli.row_lengths": np.diff(state.stimuli.indptr),
        "stimuli.columns": state.stimuli.indices,
        "stimuli.values": state.stimuli.data,
        "space.vertices": space.vertices_,
        "space.edges": space.edges_,
        "space.divergences": space.divergences_,
        "filtration.order": _positions(space.edges_, state.filtration.edges_),
        "filtration.times": state.filtration.times_,
        "filtration.p_values": state.filtration.p_values_,
        "concepts.labels": state.filtration.labels_,
        "concepts.medoids": np.array([concept.medoid for concept in concepts], np.int64),
        "concepts.births": np.array([concept.birth for concept in concepts], np.float64),
        "concepts.deaths": np.array([concept.death for concept in concepts], np.float64),
        "response.mean": state.response.mean_,
        "response.whitening": state.response.whitening_,
    }


def _positions(edges: NDArray[np.int32], entering: NDArray[np.int32]) -> NDArray[np.int64]:
    """Where each edge that enters stands among sorted edges."""
    positions = np.empty(len(edges), np.int64)
    positions[np.lexsort(entering.T[::-1])] = np.arange(len(edges))
    return positions
