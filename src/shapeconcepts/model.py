"""The whole chain, from scans to shape concepts."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from os import PathLike

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts import Concept, ConceptResponse, Filtration
from shapeconcepts.concepts.response import DISTANCES
from shapeconcepts.descriptors import DescribedObject, Descriptor, describe, get_descriptor
from shapeconcepts.motifs import Explanation, MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.parameters import check_choice
from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.segmentation import SegmentedObject, segment

PRESETS = ("default", "paper")


class ShapeConceptModel(TransformerMixin, BaseEstimator):
    """Learns shape concepts from scans of objects, without labels.

    A scan is cut into surface segments; its constellations of segments are turned into stimuli of the motifs
    that the hierarchies learned; the stimuli of all scans span a topological space, whose filtration yields
    the concepts; and a concept's response says how much a scan resembles it.

    Parameters
    ----------
    descriptor : {"surflet+fpfh+curvature", "surflet+fpfh", "surflet", "fpfh", "curvature"} or Descriptor
        Describes segments. A model with a descriptor of one's own cannot be saved.
    n_levels : int
        Levels of the dictionary.
    word_metric : {"hellinger", "euclidean"}
        See `SegmentDictionary`.
    columns, n_neighbours, bandwidth, leave_own_out, min_support
        See `MotifHierarchyEnsemble`.
    heat, stop
        See `Filtration`.
    response_distance : {"divergence", "mahalanobis"}
        See `ConceptResponse`.
    min_concept_size : int
        Smallest number of scans in a concept, at least 2.
    max_steps : int
        See `Filtration`.
    voxel_size, seed_size, max_segments
        See `segment`.
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    labels_ : (n,) int32
        Concept of each training scan, -1 where it is in none.
    concepts_ : list of Concept
        Largest first. Their `name` can be set, and is saved with the model.
    stimuli_ : (n, n_motifs) csr_matrix of float64
        Stimuli of the training scans; the row of a skipped scan is empty.
    filtration_ : Filtration
    response_ : ConceptResponse
    ensemble_ : MotifHierarchyEnsemble
    scan_names_ : list of str
    scan_labels_ : list of (str or None)
        Labels that came with the training scans. Nothing is learned from them.
    skipped_ : dict of int to str
        Training scans that could not be segmented, with the reason.
    """

    def __init__(
        self,
        *,
        descriptor: str | Descriptor = "surflet+fpfh+curvature",
        n_levels: int = 2,
        word_metric: str = "hellinger",
        columns: str = "prototypes",
        n_neighbours: int | None = None,
        bandwidth: float = 0.1,
        leave_own_out: bool = True,
        min_support: int = 2,
        heat: str = "separation",
        stop: str = "refusal",
        response_distance: str = "divergence",
        min_concept_size: int = 3,
        max_steps: int = 200,
        voxel_size: float | str = "auto",
        seed_size: float = 0.02,
        max_segments: int = 12,
        n_jobs: int | None = None,
    ) -> None:
        self.descriptor = descriptor
        self.n_levels = n_levels
        self.word_metric = word_metric
        self.columns = columns
        self.n_neighbours = n_neighbours
        self.bandwidth = bandwidth
        self.leave_own_out = leave_own_out
        self.min_support = min_support
        self.heat = heat
        self.stop = stop
        self.response_distance = response_distance
        self.min_concept_size = min_concept_size
        self.max_steps = max_steps
        self.voxel_size = voxel_size
        self.seed_size = seed_size
        self.max_segments = max_segments
        self.n_jobs = n_jobs

    @classmethod
    def preset(cls, name: str, **parameters: object) -> ShapeConceptModel:
        """A model with a named choice of parameters.

        Parameters
        ----------
        name : {"default", "paper"}
            "paper" takes the paper at its word, see `MotifHierarchyEnsemble.preset`: with "geodesic" heat,
            concepts at the time of the most annexations, and Mahalanobis distances.
        **parameters
            Parameters that differ from the preset.

        Raises
        ------
        ValueError
            If there is no such preset.
        """
        if name not in PRESETS:
            raise ValueError(f"preset must be one of {', '.join(map(repr, PRESETS))}, got {name!r}")
        if name == "default":
            return cls(**parameters)  # type: ignore[arg-type]
        ensemble = MotifHierarchyEnsemble.preset(name)
        assert ensemble.dictionary is not None
        preset = {
            "descriptor": ensemble.descriptor,
            "n_levels": ensemble.dictionary.n_levels,
            "word_metric": ensemble.dictionary.metric,
            "columns": ensemble.columns,
            "bandwidth": ensemble.bandwidth,
            "leave_own_out": ensemble.leave_own_out,
            "min_support": ensemble.min_support,
            "heat": "geodesic",
            "stop": "annexations",
            "response_distance": "mahalanobis",
        }
        return cls(**{**preset, **parameters})  # type: ignore[arg-type]

    def fit(self, X: Iterable[object], y: object = None) -> ShapeConceptModel:
        """Learn concepts from scans.

        Parameters
        ----------
        X : iterable of Scan, (n, 3) array, point cloud, SegmentedObject or DescribedObject
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ScanError
            If no scan can be segmented.
        ValueError
            If a parameter is out of range, or X is empty.

        Warns
        -----
        ScanWarning
            If scans cannot be segmented: they are skipped, see `skipped_`.
        UserWarning
            If the filtration finds no concepts.
        """
        ensemble = MotifHierarchyEnsemble(
            SegmentDictionary(self.n_levels, self.word_metric),
            descriptor=self.descriptor,
            columns=self.columns,
            n_neighbours=self.n_neighbours,
            bandwidth=self.bandwidth,
            leave_own_out=self.leave_own_out,
            min_support=self.min_support,
            n_jobs=self.n_jobs,
        )
        filtration = Filtration(self.min_concept_size, self.max_steps, self.heat, self.stop)
        response = ConceptResponse(check_choice("response_distance", self.response_distance, DISTANCES))
        # What is wrong is said before hours of segmentation.
        ensemble.check_parameters()
        filtration.check_parameters()
        scans = list(X)
        described, self.skipped_ = self._describe(scans)
        self.scan_names_ = [str(getattr(scan, "name", "") or "") for scan in scans]
        self.scan_labels_ = [getattr(scan, "label", None) for scan in scans]
        self.ensemble_ = ensemble.fit([one for one in described if one])
        self.stimuli_ = _spread(self.ensemble_.stimuli_, described)
        self.filtration_ = filtration.fit(self.stimuli_)
        self.concepts_: list[Concept] = self.filtration_.concepts_
        self.labels_: NDArray[np.int32] = self.filtration_.labels_
        self.response_ = response.fit(self.stimuli_, self.labels_)
        return self

    def stimuli(self, X: Iterable[object]) -> csr_matrix:
        """Stimuli of scans: what the responses are computed from.

        Parameters, errors and warnings are those of `transform`.

        Returns
        -------
        (m, n_motifs) csr_matrix of float64
            The row of a scan that cannot be segmented is empty.
        """
        check_is_fitted(self, "response_")
        described, _ = self._describe(X)
        return _spread(self.ensemble_.transform([one for one in described if one]), described)

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
            If no scan can be segmented.

        Warns
        -----
        ScanWarning
            If a scan cannot be segmented.
        """
        return self.response_.transform(self.stimuli(X))

    def predict(self, X: Iterable[object]) -> NDArray[np.int64]:
        """Concept whose ten nearest training scans are nearest on average, -1 for a scan unlike all.

        Parameters, errors and warnings are those of `transform`.

        Returns
        -------
        (m,) int64
            Position in `concepts_`, or -1.
        """
        return self.response_.predict(self.stimuli(X))

    def explain(self, scan: object) -> Explanation:
        """Which motifs a scan fires, how strongly, and which training scans they come from.

        Raises
        ------
        ScanError
            If the scan cannot be segmented.
        """
        check_is_fitted(self, "response_")
        described, _ = self._describe([scan])
        assert described[0] is not None
        return self.ensemble_.explain(described[0])

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns of `transform`: the concepts' own names where they have one."""
        check_is_fitted(self, "response_")
        names = [concept.name or f"concept{number}" for number, concept in enumerate(self.concepts_)]
        return np.array(names, dtype=object)

    def segment(self, scan: object) -> SegmentedObject:
        """Segments of a scan, cut as for this model; see `shapeconcepts.segment`."""
        return segment(
            scan, voxel_size=self.voxel_size, seed_size=self.seed_size, max_segments=self.max_segments
        )

    def save(self, path: str | PathLike[str]) -> None:
        """Write the model to a file that `load_model` reads; see `shapeconcepts.model_file`."""
        from shapeconcepts.model_file import save_model

        save_model(self, path)

    def _describe(self, X: Iterable[object]) -> tuple[list[DescribedObject | None], dict[int, str]]:
        """Segment and describe scans; None, with the reason, where that is not possible."""
        scans = list(X)
        if not scans:
            raise ValueError("X must hold at least one scan, got none")
        get_descriptor(self.descriptor)
        results = Parallel(self.n_jobs)(delayed(_describe_one)(self, scan) for scan in scans)
        skipped = {i: str(result) for i, result in enumerate(results) if isinstance(result, ScanError)}
        if len(skipped) == len(scans):
            raise ScanError(skipped[0])
        if skipped:
            reasons = "; ".join([f"number {i}: {reason}" for i, reason in skipped.items()][:3])
            more = "; ..." if len(skipped) > 3 else ""
            warnings.warn(
                f"{len(skipped)} of {len(scans)} scans are skipped: {reasons}{more}",
                ScanWarning,
                stacklevel=3,
            )
        return [None if isinstance(result, ScanError) else result for result in results], skipped


def _describe_one(model: ShapeConceptModel, scan: object) -> DescribedObject | ScanError:
    if isinstance(scan, DescribedObject):
        return scan
    try:
        segmented = scan if isinstance(scan, SegmentedObject) else model.segment(scan)
        return describe(segmented, model.descriptor)
    except ScanError as error:
        return error


def _spread(rows: csr_matrix, described: list[DescribedObject | None]) -> csr_matrix:
    """Put an empty row where there is no object."""
    lengths = np.zeros(len(described), np.int64)
    lengths[[i for i, one in enumerate(described) if one]] = np.diff(rows.indptr)
    indptr = np.concatenate([[0], np.cumsum(lengths)])
    return csr_matrix((rows.data, rows.indices, indptr), shape=(len(described), rows.shape[1]))
