"""From a file to the model."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import clone

from shapeconcepts.concepts import Concept, ConceptResponse, Filtration
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.model_file.container import read_container
from shapeconcepts.model_file.content import check_content, check_description
from shapeconcepts.model_file.error import ModelError, require
from shapeconcepts.model_file.layout import Tensors
from shapeconcepts.model_file.parameters import decode_parameters
from shapeconcepts.motifs import MotifHierarchies, MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.topology import TopologicalSpace
from shapeconcepts.topology.divergence import normalised_rows

# By what equal rows may differ when they are scaled to sum 1 elsewhere.
_ROUNDING = 1e-9


def load_model(path: str | PathLike[str]) -> ShapeConceptModel:
    """Read a model that was written by `save_model` or `ShapeConceptModel.save`.

    It answers like the one that was saved, to the last bit. Reading runs no code from the file, and every
    number in it is checked before it is used.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    ShapeConceptModel
        With `n_jobs` None.

    Raises
    ------
    ModelError
        If there is no such file, it is no model, damaged, or newer or older than this version can read; the
        message names the file, what was found and what was expected.
    """
    path = Path(path)
    try:
        return restore_model(*read_container(path))
    except ModelError as error:
        raise ModelError(f"{path}: {error}") from None
    except RecursionError:
        raise ModelError(f"{path}: is no model file: its description is nested too deep") from None


def restore_model(tensors: Tensors, description: dict[str, Any]) -> ShapeConceptModel:
    """Model from the content of a file.

    Raises
    ------
    ModelError
        If the content is not that of a model.
    """
    n_scans, n_concepts = len(tensors["concepts.labels"]), len(tensors["concepts.medoids"])
    check_description(description, n_scans, n_concepts)
    skipped: dict[int, str] = dict(description["skipped"])
    ensemble_parameters = decode_parameters(
        description["ensemble_parameters"], MotifHierarchyEnsemble, "the ensemble's parameters"
    )
    check_content(tensors, list(skipped), ensemble_parameters["columns"])

    model = ShapeConceptModel(**decode_parameters(description["parameters"], ShapeConceptModel, "parameters"))
    model.skipped_ = skipped
    model.scan_names_, model.scan_labels_ = description["scan_names"], description["scan_labels"]
    model.ensemble_ = _ensemble(tensors, description, ensemble_parameters)
    model.stimuli_ = _stimuli(tensors)
    rows = normalised_rows(model.stimuli_, "stimuli")
    model.filtration_ = _filtration(tensors, description, rows)
    model.concepts_, model.labels_ = model.filtration_.concepts_, model.filtration_.labels_
    model.response_ = _response(tensors, description, rows)
    return model


def _ensemble(
    tensors: Tensors, description: dict[str, Any], parameters: dict[str, Any]
) -> MotifHierarchyEnsemble:
    dictionary = SegmentDictionary(
        **decode_parameters(
            description["dictionary_parameters"], SegmentDictionary, "the dictionary's parameters"
        )
    )
    ends = np.cumsum(tensors["dictionary.level_sizes"])[:-1]
    dictionary.n_features_in_ = tensors["dictionary.words"].shape[1]
    dictionary._set_words(np.split(tensors["dictionary.words"], ends))
    dictionary.parents_ = np.split(tensors["dictionary.parents"], ends)
    dictionary.clusters_ = tensors["dictionary.clusters"]

    ensemble = MotifHierarchyEnsemble(clone(dictionary), **parameters)
    ensemble.dictionary_ = dictionary
    skipped = dict(description["skipped"])
    ensemble.hierarchies_ = MotifHierarchies(
        dictionary_levels=tensors["motifs.dictionary_levels"],
        motif_levels=tensors["motifs.motif_levels"],
        words=tensors["motifs.words"],
        edges=tensors["motifs.edges"],
        prototypes=tensors["prototypes.histograms"],
        prototype_vertices=tensors["prototypes.motifs"],
        prototype_objects=tensors["prototypes.objects"],
        prototype_constellations=tensors["prototypes.constellations"],
        object_names=tuple(name for i, name in enumerate(description["scan_names"]) if i not in skipped),
    )
    ensemble._columns, ensemble.columns_ = ensemble.columns, tensors["stimuli.sources"]
    ensemble._training_stimuli = ensemble._prototype_field = None
    return ensemble


def _stimuli(tensors: Tensors) -> csr_matrix:
    lengths = tensors["stimuli.row_lengths"]
    return csr_matrix(
        (tensors["stimuli.values"], tensors["stimuli.columns"], np.concatenate([[0], np.cumsum(lengths)])),
        shape=(len(lengths), len(tensors["stimuli.sources"])),
    )


def _filtration(tensors: Tensors, description: dict[str, Any], rows: csr_matrix) -> Filtration:
    space = TopologicalSpace()
    space.n_features_in_ = rows.shape[1]
    space.vertices_ = tensors["space.vertices"]
    placed = np.flatnonzero(space.vertices_ >= 0)
    _, first, counts = np.unique(space.vertices_[placed], return_index=True, return_counts=True)
    space.multiplicities_ = counts
    space.rows_ = csr_matrix(rows[placed[first]])
    difference = abs(rows[placed] - space.rows_[space.vertices_[placed]])
    require(
        difference.nnz == 0 or difference.max() < _ROUNDING,
        "tensor space.vertices must give one vertex to equal rows only",
    )
    space.edges_, space.divergences_ = tensors["space.edges"], tensors["space.divergences"]
    space._set_heat()

    filtration = Filtration(
        **decode_parameters(description["filtration_parameters"], Filtration, "the filtration's parameters")
    )
    refused_edges = tensors["filtration.refused_edges"]
    require(
        filtration.stop == "refusal" or len(refused_edges) == 0,
        f"tensor filtration.refused_edges must be empty where stop is {filtration.stop!r}",
    )
    order, times = filtration._order(space)
    filtration._annex(space, order, times, _are_among(space.edges_[order], refused_edges))
    filtration.concept_time_ = description["concept_time"]
    filtration.epsilon_max_ = description["epsilon_max"]
    filtration.labels_ = tensors["concepts.labels"]
    filtration.concepts_ = [
        Concept(members, medoid, birth, death, name)
        for members, medoid, birth, death, name in zip(
            _members(filtration.labels_, len(tensors["concepts.medoids"])),
            tensors["concepts.medoids"].tolist(),
            tensors["concepts.births"].tolist(),
            tensors["concepts.deaths"].tolist(),
            description["concept_names"],
            strict=True,
        )
    ]
    return filtration


def _are_among(edges: NDArray[np.int32], others: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Whether each edge is one of others; all between vertices from 0."""
    pairs = np.concatenate([edges, others]).astype(np.int64)
    numbers = pairs[:, 0] * (pairs.max(initial=0) + 1) + pairs[:, 1]
    return np.isin(numbers[: len(edges)], numbers[len(edges) :])


def _response(tensors: Tensors, description: dict[str, Any], rows: csr_matrix) -> ConceptResponse:
    labels = tensors["concepts.labels"]
    is_prototype = labels >= 0
    response = ConceptResponse(
        **decode_parameters(description["response_parameters"], ConceptResponse, "the response's parameters")
    )
    response.n_features_in_ = rows.shape[1]
    response.classes_, response.prototype_concepts_ = np.unique(
        labels[is_prototype].astype(np.int64), return_inverse=True
    )
    response.prototypes_ = csr_matrix(rows[is_prototype])
    response.mean_, response.whitening_ = tensors["response.mean"], tensors["response.whitening"]
    response.largest_divergence_ = description["largest_divergence"]
    return response


def _members(labels: NDArray[np.int32], n_concepts: int) -> list[NDArray[np.int64]]:
    ends = np.cumsum(np.bincount(labels[labels >= 0], minlength=n_concepts))
    in_order = np.argsort(labels, kind="stable")[len(labels) - int((labels >= 0).sum()) :]
    return np.split(in_order, ends[:-1]) if n_concepts else []
