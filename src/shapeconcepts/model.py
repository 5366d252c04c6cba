"""The whole chain, from scans to shape concepts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from numbers import Integral
from os import PathLike
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClusterMixin, clone
from sklearn.utils._param_validation import HasMethods
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts import Concept, ConceptResponse, ConceptTree, Filtration
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.corrections import Corrections, Journal
from shapeconcepts.corrections.medoids import Medoids
from shapeconcepts.descriptors import (
    Descriptor,
    describe_scans,
    scans_in,
)
from shapeconcepts.descriptors.registry import DEFAULT, DESCRIPTORS
from shapeconcepts.heap import give_back
from shapeconcepts.model_file import ModelState, read_state, write_state
from shapeconcepts.model_file.layout import STAGES
from shapeconcepts.motifs import MotifHierarchyEnsemble
from shapeconcepts.motifs.stimuli import with_empty_rows
from shapeconcepts.parameters import StagesMixin, check_parameters, choice
from shapeconcepts.segmentation import SegmentedObject, Segmenter

PRESETS = ("default", "paper")


class ShapeConceptModel(Corrections, StagesMixin, ClusterMixin, BaseEstimator):
    """Learns shape concepts from scans of objects, without labels.

    A scan is cut into surface segments, which histograms describe; its constellations of segments are turned
    into stimuli of the motifs that the hierarchies learned; the stimuli of all scans span a topological
    space, whose filtration yields the concepts; and a concept's response says how much a scan resembles it.

    Parameters
    ----------
    segmenter : Segmenter, optional
    descriptor : str or Descriptor
        A name as of `get_descriptor`; "surflet+fpfh+curvature+distance" is where size counts, too. A model
        with a descriptor of one's own, or learned from objects that another one described, cannot be saved.
    ensemble : MotifHierarchyEnsemble, optional
    filtration : Filtration, optional
    response : ConceptResponse, optional
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    labels_ : (n,) int32
        Concept of each training scan, -1 where it is in none.
    concepts_ : list of Concept
        Largest first. Their `name` can be set, and is saved with the model. Their `key` is what they are
        known by after updates, whatever their number.
    concept_tree_ : ConceptTree or None
        All groups that significant splits leave apart, coarse to fine; None where a time makes concepts.
    stimuli_ : (n, n_motifs) csr_matrix of float64
        Stimuli of the training scans; the row of a skipped scan is empty.
    segmenter_, descriptor_, ensemble_, filtration_, response_
        The stages as they were fitted.
    scan_names_, scan_labels_ : list of str, list of (str or None)
        Labels are those that came with the training scans. Nothing is learned from them.
    skipped_ : dict of int to str
        Training scans that could not be described, with the reason.
    history_ : tuple of Update
        What each update changed: which concepts grew, were born, split, merged, and which scans moved.
    novelty_ : Novelty or None
        What tells scans of something known from new things. None with an ensemble of one's own.
    n_features_in_ : int (3, the coordinates of a point)

    Examples
    --------
    A stage is an object, and can be exchanged or set:

    >>> from shapeconcepts import Filtration, ShapeConceptModel
    >>> ShapeConceptModel(filtration=Filtration(min_concept_size=5)).filtration.min_concept_size
    5
    >>> ShapeConceptModel().set_params(segmenter__max_segments=8).segmenter.max_segments
    8
    """

    _default_stages: ClassVar[dict[str, Callable[[], BaseEstimator]]] = {
        "segmenter": Segmenter,
        "ensemble": MotifHierarchyEnsemble,
        "filtration": Filtration,
        "response": ConceptResponse,
    }
    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "segmenter": [HasMethods(["segment"]), None],
        "descriptor": [choice(*DESCRIPTORS), HasMethods(["describe"])],
        "ensemble": [HasMethods(["fit", "transform"]), None],
        "filtration": [HasMethods(["fit"]), None],
        "response": [HasMethods(["fit", "transform", "predict"]), None],
        "n_jobs": [Integral, None],
    }

    def __init__(
        self,
        *,
        segmenter: Segmenter | None = None,
        descriptor: str | Descriptor = DEFAULT,
        ensemble: MotifHierarchyEnsemble | None = None,
        filtration: Filtration | None = None,
        response: ConceptResponse | None = None,
        n_jobs: int | None = None,
    ) -> None:
        self.segmenter = segmenter
        self.descriptor = descriptor
        self.ensemble = ensemble
        self.filtration = filtration
        self.response = response
        self.n_jobs = n_jobs

    @classmethod
    def preset(cls, name: str, **parameters: Any) -> ShapeConceptModel:
        """A model with a named choice of stages.

        Parameters
        ----------
        name : {"default", "paper"}
            "paper" follows the paper: FPFH, `MotifHierarchyEnsemble.preset`, "geodesic" heat, concepts at the
            time of the most annexations, and Mahalanobis distances. Where it differs: docs/paper.md.
        **parameters
            Parameters that differ from the preset, as `set_params` takes them.

        Raises
        ------
        ValueError
            If there is no such preset or parameter.
        """
        if name not in PRESETS:
            raise ValueError(f"preset must be one of {', '.join(map(repr, PRESETS))}, got {name!r}")
        model = cls()
        if name == "paper":
            model = cls(
                descriptor="fpfh",
                ensemble=MotifHierarchyEnsemble.preset("paper"),
                filtration=Filtration(heat="geodesic", stop="annexations"),
                response=ConceptResponse("mahalanobis"),
            )
        return model.set_params(**parameters)

    def fit(self, X: Iterable[object], y: object = None) -> ShapeConceptModel:
        """Learn concepts from scans.

        Parameters
        ----------
        X : iterable of Scan, (n, 3) array, point cloud, SegmentedObject or DescribedObject
            May be a generator: of each scan, only its description is kept.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ScanError
            If no scan can be described.
        ValueError
            If a parameter is out of range, or X is empty or a single scan.

        Warns
        -----
        ScanWarning
            If scans cannot be described: they are skipped, see `skipped_`. Or what should be looked at in
            scans, see `Scan.notices`.
        UserWarning
            If the filtration finds no concepts.
        """
        # What is wrong is said before hours of segmentation.
        check_parameters(self)
        self._journal = Journal()
        scans = scans_in(X)
        segmenter, descriptor = self._stage("segmenter"), clone(self.descriptor, safe=False)
        ensemble, filtration, response = map(self._stage, ("ensemble", "filtration", "response"))
        n_occlusions = getattr(ensemble, "n_occlusions", 0)
        results = describe_scans(scans, segmenter, descriptor, self.n_jobs, n_occlusions)
        if not results:
            raise ValueError("X must hold at least one scan, got none")

        names, labels = [one.name for one in results], [one.label for one in results]
        skipped = {i: one.reason for i, one in enumerate(results) if one.described is None}
        described = [one.described for one in results if one.described]
        del results
        ensemble.set_params(n_jobs=self.n_jobs).fit(described)
        # The ensemble knows all of them that is needed.
        del described
        give_back()
        stimuli = with_empty_rows(ensemble.stimuli_, [i not in skipped for i in range(len(names))])
        if hasattr(filtration, "n_jobs"):
            filtration.n_jobs = self.n_jobs
        filtration.fit(stimuli)
        give_back()
        response.fit(stimuli, filtration.labels_)
        hierarchies = getattr(ensemble, "hierarchies_", None)
        novelty = hierarchies and Novelty(hierarchies.object_histograms, n_jobs=self.n_jobs)
        return self._remember(
            ModelState(
                segmenter,
                descriptor,
                ensemble,
                filtration,
                response,
                stimuli,
                names,
                labels,
                skipped,
                novelty,
            )
        )

    def fit_transform(self, X: Iterable[object], y: object = None) -> NDArray[np.float64]:
        """Learn from scans, and give their responses by `stimuli_`, in which no scan's own motifs count.

        `transform` of the same scans would leave nothing out, and describe each of them again. Parameters,
        errors and warnings are those of `fit`.
        """
        self.fit(X)
        return self.response_.transform(self.stimuli_)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns of `transform`: the concepts' own, with their numbers where they are equal."""
        check_is_fitted(self, "filtration_")
        names = [concept.name or f"concept{number}" for number, concept in enumerate(self.concepts_)]
        while len(set(names)) < len(names):
            counts = Counter(names)
            names = [name if counts[name] == 1 else f"{name} ({i})" for i, name in enumerate(names)]
        return np.array(names, dtype=object)

    def concepts_at(self, granularity: float) -> list[Concept]:
        """Concepts at another granularity; see `Filtration.concepts_at`."""
        self.consolidate()
        return self.filtration_.concepts_at(granularity)

    def at_granularity(self, granularity: float) -> ShapeConceptModel:
        """This model with its concepts taken at another granularity; only responses are learned again."""
        self.consolidate()
        filtration = self.filtration_.at_granularity(granularity)
        response = clone(self.response_).fit(self.stimuli_, filtration.labels_)
        other = ShapeConceptModel(**self.get_params(deep=False))
        other._journal = self._journal
        return other._remember(self._state()._replace(filtration=filtration, response=response))

    def segment(self, scan: object) -> SegmentedObject:
        """Segments of a scan, cut as by this model; see `Segmenter.segment`."""
        segmenter: Segmenter = getattr(self, "segmenter_", None) or self._stage("segmenter")
        return segmenter.segment(scan)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the model to a file that `load_model` reads; see `shapeconcepts.model_file.write_state`.

        What was said of its concepts goes into a journal beside the file; see `write_journal`.
        """
        self.consolidate()
        self._keep_names_set_by_hand()
        self._correct()
        write_state(path, self._state())
        self.write_journal(path)

    def _state(self) -> ModelState:
        """What was learned, without corrections."""
        fitted = {name: getattr(self, f"{name}_") for name in ModelState._fields if name != "response"}
        return ModelState(**fitted, response=self._learned_response)

    def _remember(self, state: ModelState) -> ShapeConceptModel:
        """Be fitted."""
        for name, value in state._asdict().items():
            setattr(self, f"{name}_", value)
        learned: list[Concept] = state.filtration.concepts_
        self.concept_tree_: ConceptTree | None = state.filtration.concept_tree_
        self.n_features_in_ = 3
        # Counted by the filtration, whose other cuts give identities, too.
        counter: list[int] = state.filtration.__dict__.setdefault("_n_identities", [0])
        counter[0] = max(counter[0], state.n_identities, *(concept.key + 1 for concept in learned), 0)
        for concept in learned:
            if concept.key < 0:
                concept.key, counter[0] = counter[0], counter[0] + 1
        self.n_identities_ = counter[0]
        self._waiting, self._is_novel, self._likeness, self._medoids = [], [], None, Medoids()
        self._correct()
        return self

    def _reserve_identities(self, n: int) -> None:
        """Let identities up to a number be given."""
        counter: list[int] = self.filtration_._n_identities
        counter[0] = max(counter[0], n)
        self.n_identities_ = counter[0]


def load_model(path: str | PathLike[str]) -> ShapeConceptModel:
    """Read a model that `ShapeConceptModel.save` wrote.

    It answers like the one that was saved, to the last bit; see `shapeconcepts.model_file.read_state`.

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
        If there is no such file, it is no model, damaged, or newer or older than this version can read.
    """
    state = read_state(path)
    stages: Any = {name: getattr(state, name) for name in STAGES}
    model = ShapeConceptModel(**{name: clone(stage, safe=False) for name, stage in stages.items()})
    model._remember(state)
    model.read_journal(path)
    return model
