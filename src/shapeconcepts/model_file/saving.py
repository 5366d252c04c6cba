"""From a model to its file."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.model_file.container import write_container
from shapeconcepts.model_file.error import ModelError
from shapeconcepts.model_file.layout import FORMAT, Tensors, checked_tensors
from shapeconcepts.model_file.loading import restore_model
from shapeconcepts.model_file.parameters import encode_parameters


def save_model(model: ShapeConceptModel, path: str | PathLike[str]) -> None:
    """Write a fitted model to a file, completely or not at all.

    The same model gives the same bytes. A file that is there is replaced and keeps its permissions; where the
    path is a link, the file that it leads to is replaced. `n_jobs` is not kept.

    Parameters
    ----------
    model : ShapeConceptModel
    path : str or path
        The file; its folder must exist.

    Raises
    ------
    ModelError
        If the model has a descriptor of one's own, or was changed so that its parts no longer fit each other.
    sklearn.exceptions.NotFittedError
        If the model is not fitted.
    OSError
        If the file cannot be written.
    """
    check_is_fitted(model, "response_")
    try:
        description = json.loads(json.dumps(_description(model), allow_nan=False))
        tensors = checked_tensors(_tensors(model))
        # A file that could not be loaded again would be worth nothing.
        restore_model(tensors, description)
    except (ModelError, TypeError, ValueError) as error:
        raise ModelError(f"model cannot be saved: {error}") from None
    write_container(Path(path), tensors, description)


def _description(model: ShapeConceptModel) -> dict[str, Any]:
    from shapeconcepts import __version__

    return {
        "format": FORMAT,
        "written_by": f"shapeconcepts {__version__}",
        "parameters": encode_parameters(model),
        "dictionary_parameters": encode_parameters(model.ensemble_.dictionary_),
        "ensemble_parameters": encode_parameters(model.ensemble_),
        "filtration_parameters": encode_parameters(model.filtration_),
        "response_parameters": encode_parameters(model.response_),
        "scan_names": model.scan_names_,
        "scan_labels": model.scan_labels_,
        "skipped": sorted(model.skipped_.items()),
        "concept_names": [concept.name for concept in model.concepts_],
        "concept_time": model.filtration_.concept_time_,
        "epsilon_max": model.filtration_.epsilon_max_,
        "largest_divergence": model.response_.largest_divergence_,
    }


def _tensors(model: ShapeConceptModel) -> Tensors:
    dictionary, hierarchies = model.ensemble_.dictionary_, model.ensemble_.hierarchies_
    space, response, concepts = model.filtration_.space_, model.response_, model.concepts_
    return {
        "dictionary.level_sizes": np.diff(dictionary._level_starts),
        "dictionary.words": dictionary._embedded_words,
        "dictionary.parents": np.concatenate(dictionary.parents_),
        "dictionary.clusters": dictionary.clusters_,
        "motifs.dictionary_levels": hierarchies.dictionary_levels,
        "motifs.motif_levels": hierarchies.motif_levels,
        "motifs.words": hierarchies.words,
        "motifs.edges": hierarchies.edges,
        "prototypes.histograms": hierarchies.prototypes,
        "prototypes.motifs": hierarchies.prototype_vertices,
        "prototypes.objects": hierarchies.prototype_objects,
        "prototypes.constellations": hierarchies.prototype_constellations,
        "stimuli.sources": model.ensemble_.columns_,
        "stimuli.row_lengths": np.diff(model.stimuli_.indptr),
        "stimuli.columns": model.stimuli_.indices,
        "stimuli.values": model.stimuli_.data,
        "space.vertices": space.vertices_,
        "space.edges": space.edges_,
        "space.divergences": space.divergences_,
        "filtration.refused_edges": model.filtration_.refused_edges_,
        "concepts.labels": model.labels_,
        "concepts.medoids": np.array([concept.medoid for concept in concepts], np.int64),
        "concepts.births": np.array([concept.birth for concept in concepts], np.float64),
        "concepts.deaths": np.array([concept.death for concept in concepts], np.float64),
        "response.mean": response.mean_,
        "response.whitening": response.whitening_,
    }
