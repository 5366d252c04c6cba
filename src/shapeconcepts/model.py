"""The whole chain, from scans to shape concepts."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace
from numbers import Integral, Real
from os import PathLike
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import BaseEstimator, ClusterMixin, TransformerMixin, clone
from sklearn.utils._param_validation import HasMethods
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts import Concept, ConceptResponse, ConceptTree, Filtration
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.concepts.recognition import Recognition, concept_shares, foreign_segments
from shapeconcepts.concepts.whole_objects import whole_divergences
from shapeconcepts.descriptors import (
    DescribedObject,
    Descriptor,
    describe_scan,
    describe_scans,
    scans_in,
)
from shapeconcepts.descriptors.registry import DEFAULT, DESCRIPTORS
from shapeconcepts.model_file import ModelState, read_state, write_state
from shapeconcepts.model_file.layout import STAGES
from shapeconcepts.motifs import Explanation, MotifHierarchyEnsemble
from shapeconcepts.motifs.stimuli import with_empty_rows
from shapeconcepts.parameters import StagesMixin, check_integer, check_parameters, choice
from shapeconcepts.scan import ScanError
from shapeconcepts.segmentation import SegmentedObject, Segmenter

PRESETS = ("default", "paper")


class ShapeConceptModel(StagesMixin, ClusterMixin, TransformerMixin, BaseEstimator):
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
        Largest first. Their `name` can be set, and is saved with the model.
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
        scans = scans_in(X)
        segmenter, descriptor = self._stage("segmenter"), clone(self.descriptor, safe=False)
        ensemble, filtration, response = map(self._stage, ("ensemble", "filtration", "response"))
        n_occlusions = getattr(ensemble, "n_occlusions", 0)
        results = describe_scans(scans, segmenter, descriptor, self.n_jobs, n_occlusions)
        if not results:
            raise ValueError("X must hold at least one scan, got none")

        described = [one.described for one in results]
        ensemble.set_params(n_jobs=self.n_jobs).fit([one for one in described if one])
        stimuli = with_empty_rows(ensemble.stimuli_, described)
        if hasattr(filtration, "n_jobs"):
            filtration.n_jobs = self.n_jobs
        filtration.fit(stimuli)
        response.fit(stimuli, filtration.labels_)

        names, labels = [one.name for one in results], [one.label for one in results]
        skipped = {i: one.reason for i, one in enumerate(results) if one.described is None}
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

    def stimuli(self, X: Iterable[object]) -> csr_matrix:
        """Stimuli of scans: what the responses are computed from.

        Parameters, errors and warnings are those of `transform`.

        Returns
        -------
        (m, n_motifs) csr_matrix of float64
            The row of a scan that cannot be described is empty.
        """
        return self._rows(self._described(X), self.ensemble_.transform)

    def transform(self, X: Iterable[object]) -> NDArray[np.float64]:
        """Responses of the concepts to scans (paper: equation 3); smaller is more alike.

        Parameters
        ----------
        X : iterable of Scan, (n, 3) array, point cloud, SegmentedObject or DescribedObject

        Returns
        -------
        (m, n_concepts) float64
            NaN in the row of a scan without any stimulus.

        Raises
        ------
        ScanError
            If no scan can be described.
        ValueError
            If X is a single scan.

        Warns
        -----
        ScanWarning
            If a scan cannot be described.
        """
        stimuli = self.stimuli(X)
        return self.response_.transform(stimuli)

    def transform_tree(self, X: Iterable[object] | None = None, n_groups: int = 256) -> NDArray[np.float64]:
        """Responses of groups within groups, coarse to fine: features to tell scans apart by.

        Each group of `concept_tree_`, and each that formed within the smallest of them, gives two: the mean
        distance to its members by stimuli, as a concept's response, and that of whole objects.

        Parameters, errors and warnings are those of `transform`, and more:

        Parameters
        ----------
        X : iterable or None
            None: the training scans, each compared with the others only, as a new scan would be.
        n_groups : int
            The coarsest so many, if there are more.

        Returns
        -------
        (m, 2 k) float64
            Of k groups: the responses by stimuli, coarse to fine, then by whole objects.

        Raises
        ------
        ValueError
            If there is no tree, as a time makes the concepts, or `n_groups` is not a positive integer.
        """
        check_is_fitted(self, "response_")
        check_integer("n_groups", n_groups, 1)
        tree = self.filtration_.group_tree().coarsest(n_groups)
        members = self.response_.prototype_rows_
        described = None if X is None else self._described(X)
        stimuli = self.stimuli_ if described is None else self._rows(described, self.ensemble_.transform)
        own = np.arange(len(self.labels_)) if described is None else np.full(len(described), -1)
        by_stimuli = self.response_.distances(stimuli)
        is_object = ~np.isin(np.arange(len(self.labels_)), list(self.skipped_))
        histograms = self.ensemble_.hierarchies_.object_histograms
        by_whole = whole_divergences(histograms, is_object, members, described)
        return np.concatenate(
            [tree.mean_distances(distances, members, own) for distances in (by_stimuli, by_whole)], axis=1
        )

    def predict(self, X: Iterable[object], unknown_rate: float | None = None) -> NDArray[np.int64]:
        """Concept of whose members each scan reminds most, -1 for a scan unlike all.

        Parameters, errors and warnings are those of `recognise`.

        Returns
        -------
        (m,) int64
            Position in `concepts_`, or -1.
        """
        return self.recognise(X, unknown_rate).concepts

    def recognise(self, X: Iterable[object], unknown_rate: float | None = None) -> Recognition:
        """Concepts of scans, responses, how much each scan reminds of each concept's members, and p-values.

        A scan of which a part is hidden reminds of what the imagined occlusions of training scans left. Where
        the stimuli are of motifs, the concept is the one whose nearest training scans are nearest.

        Parameters, errors and warnings are those of `transform`, and more:

        Parameters
        ----------
        X : iterable
        unknown_rate : float or None
            Share of scans of something known that may be called unknown, 0 to 1: those with a p-value up to
            it. It holds for scans like those in training, not where more is hidden, or noise is stronger.
            None: a scan is unknown where it is farther from every training scan than any of these from its
            neighbours, which promises nothing.

        Raises
        ------
        ValueError
            If `unknown_rate` is no number from 0 to 1, or the ensemble is one of one's own.

        Warns
        -----
        UserWarning
            If there are too few training scans to promise such a rate: nothing is called unknown.
        """
        check_is_fitted(self, "response_")
        self._check_rate(unknown_rate)
        described = self._described(X)
        stimuli = self._rows(described, self.ensemble_.transform)
        concepts, responses = self.response_.predict(stimuli), self.response_.transform(stimuli)
        shares, is_known = None, concepts >= 0
        if getattr(self.ensemble_, "knows_objects", False):
            reminders = self._rows(described, self.ensemble_.reminders)
            shares = concept_shares(reminders, self._concept_of_object, len(self.concepts_))
        if shares is not None and self.concepts_:
            concepts = np.where(shares.any(axis=1), shares.argmax(axis=1), -1)
        p_values = self._p_values(described, concepts)
        if unknown_rate is not None and p_values is not None:
            is_known = p_values > unknown_rate
        return Recognition(np.where(is_known, concepts, -1), responses, shares, p_values)

    def _check_rate(self, unknown_rate: float | None) -> None:
        if unknown_rate is None:
            return
        is_number = isinstance(unknown_rate, Real) and not isinstance(unknown_rate, bool)
        if not is_number or not 0 <= unknown_rate <= 1:
            raise ValueError(f"unknown_rate must be a number from 0 to 1, got {unknown_rate!r}")
        if self.novelty_ is None:
            raise ValueError("unknown_rate needs a MotifHierarchyEnsemble, the ensemble is one of one's own")
        smallest = self.novelty_.smallest_rate
        if unknown_rate < smallest:
            warnings.warn(
                f"{len(self.novelty_.distances)} training scans promise a rate of {smallest:.2g} at best, "
                f"got unknown_rate {unknown_rate:g}: no scan will be called unknown",
                UserWarning,
                stacklevel=4,
            )

    def _p_values(
        self, described: list[DescribedObject | None], concepts: NDArray[np.int64]
    ) -> NDArray[np.float64] | None:
        if self.novelty_ is None:
            return None
        distances = np.full(len(described), np.nan)
        wholes = [one.description.whole() for one in described if one]
        if wholes:
            distances[[i for i, one in enumerate(described) if one]] = self.novelty_.distances_of(
                np.array(wholes)
            )
        return self.novelty_.p_values(distances, concepts, self._concept_of_object)

    def explain(self, scan: object) -> Explanation:
        """Which motifs a scan fires, how strongly, which training scans they come from, and what is foreign.

        Raises
        ------
        ScanError
            If the scan cannot be described.
        """
        check_is_fitted(self, "response_")
        described = describe_scan(self.segmenter_, self.descriptor_, scan)
        if isinstance(described, ScanError):
            raise described
        explanation, recognition = self.ensemble_.explain(described), self.recognise([described])
        concept = int(recognition.concepts[0])
        if recognition.shares is None or concept < 0:
            return explanation
        parts = [described.segment(number) for number in range(described.n_segments)]
        foreign = foreign_segments(self.ensemble_.reminders(parts), self._concept_of_object, concept)
        return replace(explanation, foreign=foreign)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns of `transform`: the concepts' own, with their numbers where they are equal."""
        check_is_fitted(self, "response_")
        names = [concept.name or f"concept{number}" for number, concept in enumerate(self.concepts_)]
        while len(set(names)) < len(names):
            counts = Counter(names)
            names = [name if counts[name] == 1 else f"{name} ({i})" for i, name in enumerate(names)]
        return np.array(names, dtype=object)

    def concepts_at(self, granularity: float) -> list[Concept]:
        """Concepts at another granularity; see `Filtration.concepts_at`."""
        check_is_fitted(self, "response_")
        return self.filtration_.concepts_at(granularity)

    def at_granularity(self, granularity: float) -> ShapeConceptModel:
        """This model with its concepts taken at another granularity; only responses are learned again."""
        check_is_fitted(self, "response_")
        filtration = self.filtration_.at_granularity(granularity)
        response = clone(self.response_).fit(self.stimuli_, filtration.labels_)
        state = ModelState(*(getattr(self, f"{name}_") for name in ModelState._fields))
        other = ShapeConceptModel(**self.get_params(deep=False))
        return other._remember(state._replace(filtration=filtration, response=response))

    def segment(self, scan: object) -> SegmentedObject:
        """Segments of a scan, cut as by this model; see `Segmenter.segment`."""
        segmenter: Segmenter = getattr(self, "segmenter_", None) or self._stage("segmenter")
        return segmenter.segment(scan)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the model to a file that `load_model` reads; see `shapeconcepts.model_file.write_state`."""
        check_is_fitted(self, "response_")
        write_state(
            path,
            ModelState(
                self.segmenter_,
                self.descriptor_,
                self.ensemble_,
                self.filtration_,
                self.response_,
                self.stimuli_,
                self.scan_names_,
                self.scan_labels_,
                self.skipped_,
                self.novelty_,
            ),
        )

    def _described(self, X: Iterable[object]) -> list[DescribedObject | None]:
        check_is_fitted(self, "response_")
        self.ensemble_.n_jobs = self.n_jobs
        results = describe_scans(scans_in(X), self.segmenter_, self.descriptor_, self.n_jobs)
        return [one.described for one in results]

    def _rows(
        self, described: list[DescribedObject | None], rows_of: Callable[[list[DescribedObject]], Any]
    ) -> csr_matrix:
        """Rows of the scans that could be described, and empty ones for the others."""
        # scikit-learn can be told that it shall be a data frame.
        return with_empty_rows(csr_matrix(rows_of([one for one in described if one])), described)

    @property
    def _concept_of_object(self) -> NDArray[np.int32]:
        """Concept of each object that the ensemble saw: of the training scans that were not skipped."""
        return np.delete(self.labels_, list(self.skipped_))

    def _remember(self, state: ModelState) -> ShapeConceptModel:
        """Be fitted."""
        for name, value in state._asdict().items():
            setattr(self, f"{name}_", value)
        self.concepts_: list[Concept] = state.filtration.concepts_
        self.concept_tree_: ConceptTree | None = state.filtration.concept_tree_
        self.labels_: NDArray[np.int32] = state.filtration.labels_.copy()
        self.n_features_in_ = 3
        return self


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
    return model._remember(state)
