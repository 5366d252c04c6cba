"""From a file to the state of a fitted model."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import clone

from shapeconcepts.concepts import Concept, ConceptResponse, Filtration
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.model_file.agreement import check_ensemble, check_filtration, check_response
from shapeconcepts.model_file.container import read_container
from shapeconcepts.model_file.content import check_content
from shapeconcepts.model_file.description import check_description
from shapeconcepts.model_file.error import ModelError, require
from shapeconcepts.model_file.history import read_history
from shapeconcepts.model_file.layout import Tensors, widened
from shapeconcepts.model_file.parameters import decode_descriptor, decode_stage
from shapeconcepts.model_file.state import ModelState
from shapeconcepts.motifs import MotifHierarchies, MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.motifs.imagined_prototypes import ImaginedPrototypes
from shapeconcepts.segmentation import Segmenter
from shapeconcepts.topology import TopologicalSpace
from shapeconcepts.topology.divergence import normalised_rows

# By what equal rows may differ when they are scaled to sum 1 elsewhere.
_ROUNDING = 1e-9


def read_state(path: str | PathLike[str]) -> ModelState:
    """Read the state that `write_state` wrote.

    Reading runs no code from the file, and every number in it is checked before it is used.

    Raises
    ------
    ModelError
        If there is no such file, it is no model, damaged, or newer or older than this version can read; the
        message names the file, what was found and what was expected.
    """
    path = Path(path)
    try:
        return restore_state(*read_container(path))
    except ModelError as error:
        raise ModelError(f"{path}: {error}") from None
    except RecursionError:
        raise ModelError(f"{path}: is no model file: its description is nested too deep") from None


def restore_state(tensors: Tensors, description: dict[str, Any]) -> ModelState:
    """State of a model from the content of a file.

    Raises
    ------
    ModelError
        If the content is not that of a model.
    """
    tensors = widened(tensors)
    n_scans, n_concepts = len(tensors["concepts.labels"]), len(tensors["concepts.medoids"])
    check_description(description, n_scans, n_concepts)
    stages, skipped = description["stages"], dict(description["skipped"])
    ensemble = decode_stage(stages["ensemble"], MotifHierarchyEnsemble, "ensemble")
    filtration = decode_stage(stages["filtration"], Filtration, "filtration")
    response = decode_stage(stages["response"], ConceptResponse, "response")
    descriptor = decode_descriptor(stages["descriptor"])
    check_content(tensors, list(skipped), ensemble.columns)

    stimuli = _stimuli(tensors)
    _fit_ensemble(ensemble, tensors, description, skipped, stimuli)
    check_ensemble(ensemble, descriptor, tensors["stimuli.sources"], stimuli, list(skipped))
    rows = normalised_rows(stimuli, "stimuli")
    _fit_filtration(filtration, tensors, description, rows)
    _fit_response(response, tensors, description, rows)
    return ModelState(
        decode_stage(stages["segmenter"], Segmenter, "segmenter"),
        descriptor,
        ensemble,
        filtration,
        response,
        stimuli,
        description["scan_names"],
        description["scan_labels"],
        skipped,
        Novelty(ensemble.hierarchies_.object_histograms, tensors["objects.distances"]),
        description["n_identities"],
        read_history(description["history"], n_scans, description["n_identities"]),
    )


def _fit_ensemble(
    ensemble: MotifHierarchyEnsemble,
    tensors: Tensors,
    description: dict[str, Any],
    skipped: dict[int, str],
    stimuli: csr_matrix,
) -> None:
    require(
        isinstance(ensemble.dictionary, SegmentDictionary), "ensemble.dictionary must be a SegmentDictionary"
    )
    assert ensemble.dictionary is not None
    dictionary = clone(ensemble.dictionary)
    ends = np.cumsum(tensors["dictionary.level_sizes"])[:-1]
    dictionary.n_features_in_ = tensors["dictionary.words"].shape[1]
    dictionary._set_words(np.split(tensors["dictionary.words"], ends))
    dictionary.parents_ = np.split(tensors["dictionary.parents"], ends)
    dictionary.clusters_ = tensors["dictionary.clusters"]

    hierarchies = MotifHierarchies(
        dictionary_levels=tensors["motifs.dictionary_levels"],
        motif_levels=tensors["motifs.motif_levels"],
        words=tensors["motifs.words"],
        support=tensors["motifs.support"],
        edges=tensors["motifs.edges"],
        prototypes=tensors["prototypes.histograms"],
        prototype_vertices=tensors["prototypes.motifs"],
        prototype_objects=tensors["prototypes.objects"],
        prototype_constellations=tensors["prototypes.constellations"],
        prototype_counts=tensors["prototypes.counts"],
        prototype_others=tensors["prototypes.others"],
        object_histograms=tensors["objects.histograms"],
        object_names=tuple(name for i, name in enumerate(description["scan_names"]) if i not in skipped),
    )
    imagined = ImaginedPrototypes(tensors["imagined.histograms"], tensors["imagined.prototypes"])
    rows = None
    if hierarchies.is_thinned:
        # All are most often objects, and a copy would take as much memory again.
        is_object = ~np.isin(np.arange(stimuli.shape[0]), list(skipped))
        rows = csr_matrix(stimuli[is_object]) if skipped else stimuli
    ensemble._remember(dictionary, hierarchies, imagined, rows)


def _stimuli(tensors: Tensors) -> csr_matrix:
    lengths = tensors["stimuli.row_lengths"]
    return csr_matrix(
        (tensors["stimuli.values"], tensors["stimuli.columns"], np.concatenate([[0], np.cumsum(lengths)])),
        shape=(len(lengths), len(tensors["stimuli.sources"])),
    )


def _fit_filtration(
    filtration: Filtration, tensors: Tensors, description: dict[str, Any], rows: csr_matrix
) -> None:
    space = TopologicalSpace(filtration._max_exact)
    space.n_features_in_ = rows.shape[1]
    space.vertices_ = tensors["space.vertices"]
    placed = np.flatnonzero(space.vertices_ >= 0)
    _, first, counts = np.unique(space.vertices_[placed], return_index=True, return_counts=True)
    space.multiplicities_ = counts
    space.rows_ = csr_matrix(rows[placed[first]])
    shared = placed[counts[space.vertices_[placed]] > 1]
    difference = abs(rows[shared] - space.rows_[space.vertices_[shared]])
    require(
        difference.nnz == 0 or difference.max() < _ROUNDING,
        "tensor space.vertices must give one vertex to equal rows only",
    )
    space.edges_, space.divergences_ = tensors["space.edges"], tensors["space.divergences"]
    space._set_heat()

    filtration._annex(space, space.edges_[tensors["filtration.order"]], tensors["filtration.times"])
    filtration.p_values_ = tensors["filtration.p_values"]
    filtration.labels_ = tensors["concepts.labels"]
    filtration.concepts_ = [
        Concept(members, medoid, birth, death, name, key)
        for members, medoid, birth, death, name, key in zip(
            _members(filtration.labels_, len(tensors["concepts.medoids"])),
            tensors["concepts.medoids"].tolist(),
            tensors["concepts.births"].tolist(),
            tensors["concepts.deaths"].tolist(),
            description["concept_names"],
            description["concept_keys"],
            strict=True,
        )
    ]
    granularity, names = description["granularity"], description["group_names"]
    require(
        (granularity is not None) == (filtration.stop == "persistence"),
        f"granularity must be a number where stop is 'persistence', and only there, got {granularity!r}",
    )
    if granularity is None:
        require(not names, f"group_names must be empty where there are no groups, got {names!r:.60}")
    else:
        _fit_groups(filtration, granularity, names)
    check_filtration(filtration, description)
    # On another processor the last bits of what was found anew could be others.
    filtration.epsilon_max_, filtration.granularity_ = description["epsilon_max"], granularity
    filtration.concept_time_ = description["concept_time"]


def _fit_groups(filtration: Filtration, granularity: float, names: list[list[Any]]) -> None:
    tree = filtration._split(filtration.p_values_)
    groups = filtration._groups(granularity)
    members = [tree.members(group).tolist() for group in groups]
    require(
        members == [concept.members.tolist() for concept in filtration.concepts_],
        "tensor concepts.labels must name the groups at the granularity, the largest first",
    )
    filtration._concept_of.update(zip(groups, filtration.concepts_, strict=True))
    others = [group for group, _ in names]
    unnamed = set(range(len(tree.parents))) - set(groups)
    require(
        len(set(others)) == len(others) and unnamed.issuperset(others),
        f"group_names must name groups that are no concepts, each once, got {names!r:.60}",
    )
    filtration._name_groups(names)


def _fit_response(
    response: ConceptResponse, tensors: Tensors, description: dict[str, Any], rows: csr_matrix
) -> None:
    response.n_features_in_ = rows.shape[1]
    response._set_prototypes(rows, tensors["concepts.labels"].astype(np.int64))
    response.mean_, response.whitening_ = tensors["response.mean"], tensors["response.whitening"]
    response.largest_divergence_ = description["largest_divergence"]
    check_response(response, rows)


def _members(labels: NDArray[np.int32], n_concepts: int) -> list[NDArray[np.int64]]:
    ends = np.cumsum(np.bincount(labels[labels >= 0], minlength=n_concepts))
    in_order = np.argsort(labels, kind="stable")[len(labels) - int((labels >= 0).sum()) :]
    return np.split(in_order, ends[:-1]) if n_concepts else []
