"""The shape motif hierarchy ensemble: from described objects to stimuli."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from numbers import Integral
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, vstack
from sklearn.base import BaseEstimator, TransformerMixin, clone
from sklearn.utils._param_validation import HasMethods
from sklearn.utils._set_output import _get_output_config
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.descriptors.described_object import DescribedObject
from shapeconcepts.heap import give_back
from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.motifs.explanation import Explanation, explain
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.imagined_prototypes import ImaginedPrototypes
from shapeconcepts.motifs.propagation import DecomposedObject, decompose_object, propagate
from shapeconcepts.motifs.prototype_stimuli import PrototypeField
from shapeconcepts.motifs.remembered_objects import remembered_objects
from shapeconcepts.motifs.stimuli import Activation, MotifField, SparseRow, compact_row, sparse_rows
from shapeconcepts.motifs.thinning import Thinning
from shapeconcepts.parallel import map_in_order
from shapeconcepts.parameters import (
    StagesMixin,
    as_list,
    check_parameters,
    choice,
    positive_number,
    whole_number,
)

COLUMNS = ("prototypes", "motifs")


class MotifHierarchyEnsemble(StagesMixin, TransformerMixin, BaseEstimator):
    """Learns the motifs of described objects, and turns an object into the stimuli of these motifs.

    Each object is decomposed into constellations of neighbouring segments. In each hierarchy, one for each
    level of the dictionary, a constellation belongs to the motif vertex of its words and leaves its
    description there as a prototype. An object's stimuli say how much its own constellations resemble these
    prototypes (paper: Hierarchical Object Decomposition and Representation, Stimuli Generation).

    Parameters
    ----------
    dictionary : SegmentDictionary or None
        A fitted one is used as it is; one that is not fitted, or None for the default, is learned from the
        segments of the objects of the first `fit` or `partial_fit`. scikit-learn's `clone` forgets what a
        dictionary learned; wrap it in `sklearn.frozen.FrozenEstimator` where it must not.
    columns : {"prototypes", "motifs"}
        What a column of the stimuli stands for: one prototype, see `PrototypeField`; or a motif vertex with
        the mean over its prototypes (the paper's equation 1), see `MotifField`.
    n_neighbours : int or None
        For "prototypes": the bandwidth around a prototype follows the divergence to its n-th neighbour. None:
        the square root of the number of columns, at least 25.
    resolution : float
        For "prototypes": smallest divergence that the bandwidth follows, in squared Hellinger distance.
        However many scans there are, differences much smaller than this are none.
    max_columns : int
        For "prototypes": of more prototypes, a sample of so many that follows how frequent they are stands
        for all, so that rows do not become finer with ever more scans, nor longer. What differs from all of
        these by more than twice the `resolution` is new, and kept beside them, up to as many again.
    width : float
        For "prototypes": bandwidth in parts of that divergence.
    bandwidth : float
        For "motifs": sigma of equation 1, in bits of Jensen-Shannon divergence.
    leave_own_out : bool
        Whether an object's own prototypes are left out of its row in `stimuli_`. They always match, which no
        prototype does for a new object.
    min_support : int
        For "motifs": smallest number of training objects in which a motif must have been seen to be a column
        of the stimuli.
    n_occlusions : int
        For "prototypes": how many imagined occlusions of each object are learned from, if it comes with any;
        see `describe`.
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    dictionary_ : SegmentDictionary
    hierarchies_ : MotifHierarchies
        Vertices, edges and prototypes.
    imagined_ : ImaginedPrototypes
        What is left of the prototypes where the objects' imagined occlusions hide a part.
    field_ : PrototypeField or MotifField
        What stimuli come from, with the parameters that it was learned with: those that are set later take
        effect when more is learned.
    columns_ : (c,) int64
        Prototype behind each column of the stimuli, which are all, in the order in which they were seen; or
        vertex, ordered by dictionary level, number of words, and words.
    stimuli_ : (n_objects, c) csr_matrix of float64
        Rows of the training objects, to learn from. `transform` of the same objects gives other rows, as it
        leaves nothing out. Where prototypes stand for others, entries under 1e-4 are dropped, and the rest is
        kept in half precision, in both.
    n_features_in_ : int
        Number of bins of the objects' histograms.
    """

    _field: PrototypeField | MotifField | None
    _reminder_field: PrototypeField | None
    _training_stimuli: csr_matrix | None
    _default_stages: ClassVar[dict[str, Callable[[], BaseEstimator]]] = {"dictionary": SegmentDictionary}
    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        # Not a type: a frozen estimator wraps a dictionary, and answers like one.
        "dictionary": [HasMethods(["transform"]), None],
        "columns": [choice(*COLUMNS)],
        "n_neighbours": [whole_number(1), None],
        "resolution": [positive_number()],
        "max_columns": [whole_number(1)],
        "width": [positive_number()],
        "bandwidth": [positive_number()],
        "leave_own_out": ["boolean"],
        "min_support": [whole_number(1)],
        "n_occlusions": [whole_number(0)],
        "n_jobs": [Integral, None],
    }

    def __init__(
        self,
        dictionary: SegmentDictionary | None = None,
        columns: str = "prototypes",
        n_neighbours: int | None = None,
        resolution: float = 0.05,
        max_columns: int = 4096,
        width: float = 0.35,
        bandwidth: float = 0.1,
        leave_own_out: bool = True,
        min_support: int = 2,
        n_occlusions: int = 2,
        n_jobs: int | None = None,
    ) -> None:
        self.dictionary = dictionary
        self.columns = columns
        self.n_neighbours = n_neighbours
        self.resolution = resolution
        self.max_columns = max_columns
        self.width = width
        self.bandwidth = bandwidth
        self.leave_own_out = leave_own_out
        self.min_support = min_support
        self.n_occlusions = n_occlusions
        self.n_jobs = n_jobs

    @classmethod
    def preset(cls, name: str) -> MotifHierarchyEnsemble:
        """An ensemble with a named choice of parameters.

        Parameters
        ----------
        name : {"default", "paper"}
            "paper" follows the paper: four levels of words under L2, every vertex a column, sigma 0.025, own
            prototypes in, nothing imagined.

        Raises
        ------
        ValueError
            If there is no such preset.
        """
        if name == "default":
            return cls()
        if name == "paper":
            dictionary = SegmentDictionary(n_levels=4, metric="euclidean")
            return cls(
                dictionary, "motifs", bandwidth=0.025, leave_own_out=False, min_support=1, n_occlusions=0
            )
        raise ValueError(f"preset must be 'default' or 'paper', got {name!r}")

    def fit(self, X: Iterable[DescribedObject], y: object = None) -> MotifHierarchyEnsemble:
        """Learn dictionary and motifs from objects, forgetting what was learned before.

        Parameters
        ----------
        X : iterable of DescribedObject
            At least one.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If a parameter is out of range, X is empty or holds something else, or an object has more than 16
            segments.
        """
        check_parameters(self)
        objects = _checked_objects(X)
        if not objects:
            raise ValueError("X must hold at least one object, got none")
        decomposed, n_bins = _decomposed(objects), objects[0].description.n_bins
        dictionary = self._fitted_dictionary(decomposed)
        nothing_seen = MotifHierarchies.empty(len(dictionary.words_), n_bins)
        return self._learn(objects, decomposed, dictionary, nothing_seen, ImaginedPrototypes.empty(n_bins))

    def partial_fit(self, X: Iterable[DescribedObject], y: object = None) -> MotifHierarchyEnsemble:
        """Add objects to what was learned before; the dictionary stays as it is.

        The first call learns the dictionary, like `fit`. Learning in parts gives the same hierarchies as
        learning all at once with the same dictionary, up to `max_columns` prototypes. Beyond, those that are
        there stay, and only what is new to them is added. Columns of prototypes come behind those that are
        there; columns of motifs can appear and move, and what names a motif for good is its dictionary level
        and its words.

        Parameters, errors and result are those of `fit`.
        """
        if not hasattr(self, "hierarchies_"):
            return self.fit(X)
        check_parameters(self)
        objects = _checked_objects(X)
        if not objects:
            raise ValueError("X must hold at least one object, got none")
        return self._learn(objects, _decomposed(objects), self.dictionary_, self.hierarchies_, self.imagined_)

    def with_new_dictionary(self) -> MotifHierarchyEnsemble:
        """This ensemble with its own dictionary learned anew, from the segments of all objects that it saw.

        Raises
        ------
        ValueError
            If prototypes stand for others, of which nothing is left to learn from.
        """
        check_is_fitted(self, "hierarchies_")
        known, other = self.hierarchies_, clone(self)
        if known.is_thinned:
            raise ValueError("a dictionary is learned from all segments, but most of them are forgotten")
        decomposed = remembered_objects(known)
        segments = np.concatenate([one.segment_histograms for one in decomposed])
        dictionary = clone(self.dictionary_).fit(segments)
        seen = MotifHierarchies.empty(len(dictionary.words_), self.n_features_in_)
        seen = seen.with_objects(propagate(decomposed, dictionary), known.object_names)
        return other._remember(dictionary, seen, self.imagined_)

    def transform(self, X: Iterable[DescribedObject]) -> csr_matrix:
        """Stimuli of objects; what was learned does not change.

        Parameters
        ----------
        X : iterable of DescribedObject

        Returns
        -------
        (n, c) csr_matrix of float64
            Stimuli up to 1, without those that are next to nothing. Of "prototypes", a row sums to the share
            of the object's constellations that remind of anything. A row is the same alone and among others.
            Data frames, where `set_output` asks for them, are dense.

        Raises
        ------
        ValueError
            If X holds something else, or an object has more than 16 segments or other histograms.
        """
        return self._output(self._stimuli(self._activations(X)))

    def fit_transform(self, X: Iterable[DescribedObject], y: object = None) -> csr_matrix:
        """Learn from objects, and give the rows to go on with: `stimuli_`, not those of `transform`."""
        return self._output(self.fit(X).stimuli_)

    def explain(self, X: DescribedObject) -> Explanation:
        """Why an object has the stimuli that it has.

        Parameters
        ----------
        X : DescribedObject

        Returns
        -------
        Explanation
            What fired, in falling order of the stimulus, each with the constellation behind it and the
            prototypes that it resembles most: of "prototypes", an entry for each constellation; of "motifs",
            for each column of the row.
        """
        check_is_fitted(self, "hierarchies_")
        (propagation,) = propagate(_decomposed(_checked_objects([X])), self.dictionary_)
        return explain(propagation, self.field_)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns.

        "object5 s0 s2" is the prototype that segments 0 and 2 of training object 5 left; "d3 m2 w1 w4" is the
        motif of words 1 and 4 of dictionary level 3, first seen at motif level 2.
        """
        check_is_fitted(self, "hierarchies_")
        name = self.hierarchies_.prototype_name if self.knows_objects else self.hierarchies_.name
        return np.array([name(behind) for behind in self.columns_.tolist()], dtype=object)

    @property
    def field_(self) -> PrototypeField | MotifField:
        """What stimuli come from, computed when it is first asked for."""
        check_is_fitted(self, "hierarchies_")
        if self._field is None:
            known, learned_with = self.hierarchies_, self._learned_with
            if learned_with["columns"] == "prototypes":
                self._field = self._prototype_field(known, self.columns_)
            else:
                bandwidth = float(learned_with["bandwidth"])
                self._field = MotifField.of(known, learned_with["min_support"], bandwidth)
        return self._field

    def reminders(self, X: Iterable[DescribedObject]) -> csr_matrix:
        """How much objects remind of each training object.

        The stimuli of all its prototypes together, and of those that imagined occlusions leave of them: an
        object of which a part is hidden reminds of what it is hidden of. A constellation counts by its
        strongest stimulus, so that what is like nothing known, such as something foreign, says little.

        Parameters and errors are those of `transform`.

        Returns
        -------
        (n, n_objects) csr_matrix of float64
            A row sums to 1 at most.

        Raises
        ------
        ValueError
            If columns are "motifs", which forget the objects that they were seen in.
        """
        activations = self._activations(X)
        if not self.knows_objects:
            raise ValueError("columns must be 'prototypes' for reminders, got 'motifs'")
        if self._reminder_field is None:
            joined, columns = self.imagined_.beside(self.hierarchies_, self.columns_)
            self._reminder_field = self._prototype_field(joined, columns)
        field = self._reminder_field
        rows = self._sparse_rows(partial(field.rows.row, by_strength=True), activations, len(field.columns))
        objects = field.hierarchies.prototype_objects[field.columns]
        is_of = csr_matrix(
            (np.ones(len(objects)), objects, np.arange(len(objects) + 1)),
            (len(objects), self.hierarchies_.n_objects),
        )
        return csr_matrix(rows @ is_of)

    @property
    def knows_objects(self) -> bool:
        """Whether columns are "prototypes", which know the objects that they were seen in."""
        check_is_fitted(self, "hierarchies_")
        return bool(self._learned_with["columns"] == "prototypes")

    def _prototype_field(self, hierarchies: MotifHierarchies, columns: NDArray[np.int64]) -> PrototypeField:
        learned_with = self._learned_with
        return PrototypeField.of(
            hierarchies,
            columns,
            learned_with["n_neighbours"],
            float(learned_with["resolution"]),
            float(learned_with["width"]),
        )

    @property
    def columns_(self) -> NDArray[np.int64]:
        """Prototype or vertex behind each column."""
        check_is_fitted(self, "hierarchies_")
        if self._learned_with["columns"] == "prototypes":
            return np.arange(len(self.hierarchies_.prototypes))
        assert isinstance(self.field_, MotifField)
        return self.field_.columns

    @property
    def stimuli_(self) -> csr_matrix:
        """Rows of the training objects, computed when they are first asked for."""
        check_is_fitted(self, "hierarchies_")
        if self._training_stimuli is None:
            self._training_stimuli = self._training_rows(self.hierarchies_, 0)
        return self._training_stimuli

    def _training_rows(self, seen: MotifHierarchies, n_before: int) -> csr_matrix:
        """Stimuli of training objects, but for the first so many, from all their constellations."""
        own = slice(int(np.searchsorted(seen.prototype_objects, n_before)), None)
        starts = np.flatnonzero(np.diff(seen.prototype_objects[own]) > 0) + 1
        histograms = np.split(seen.prototypes[own], starts)
        vertices = np.split(seen.prototype_vertices[own], starts)
        numbers = np.arange(n_before, seen.n_objects)
        left_out = (numbers if self._learned_with["leave_own_out"] else np.full_like(numbers, -1)).tolist()
        return self._stimuli(list(zip(histograms, vertices, left_out, strict=True)))

    def _learn(
        self,
        objects: list[DescribedObject],
        decomposed: list[DecomposedObject],
        dictionary: SegmentDictionary,
        before: MotifHierarchies,
        imagined: ImaginedPrototypes,
    ) -> MotifHierarchyEnsemble:
        propagations = propagate(decomposed, dictionary)
        seen = before.with_objects(propagations, [one.name for one in decomposed])
        n_all, n_occlusions, resolution = len(seen.prototypes), self.n_occlusions, float(self.resolution)
        # Where all were far apart, there may be more than a sample, each of which stands for itself.
        is_known = before.is_thinned or len(before.prototypes) > self.max_columns
        if self.columns == "motifs" or (n_all <= self.max_columns and not is_known):
            imagined = imagined.with_objects(objects, seen, np.arange(n_all), n_occlusions, resolution)
            return self._remember(dictionary, seen, imagined)
        known_rows = self.stimuli_ if is_known else None
        n_known = len(before.prototypes) if is_known else 0
        thinning = Thinning.of(seen.prototypes, n_known, self.max_columns, resolution, self.n_jobs)
        give_back()
        imagined = imagined.with_objects(objects, seen, thinning.kept, n_occlusions, resolution)
        self._remember(dictionary, thinning.applied(seen), imagined)
        rows = self._training_rows(seen, before.n_objects if is_known else 0)
        if known_rows is not None:
            # What they could remind of of what is new is next to nothing.
            wider = csr_matrix(
                (known_rows.data, known_rows.indices, known_rows.indptr), (before.n_objects, rows.shape[1])
            )
            rows = csr_matrix(vstack([wider, rows]))
        self._training_stimuli = rows
        return self

    def _remember(
        self,
        dictionary: SegmentDictionary,
        hierarchies: MotifHierarchies,
        imagined: ImaginedPrototypes,
        training_stimuli: csr_matrix | None = None,
    ) -> MotifHierarchyEnsemble:
        """Be fitted: all else follows from these and the parameters.

        Training stimuli do, too, as long as no prototype stands for others.
        """
        self.dictionary_ = dictionary
        self.hierarchies_ = hierarchies
        self.imagined_ = imagined
        self.n_features_in_ = hierarchies.prototypes.shape[1]
        self._learned_with = {k: v for k, v in self.get_params(deep=False).items() if k != "dictionary"}
        self._field = self._reminder_field = None
        self._training_stimuli = training_stimuli
        return self

    def _fitted_dictionary(self, objects: list[DecomposedObject]) -> SegmentDictionary:
        if self.dictionary is not None and hasattr(self.dictionary, "words_"):
            return self.dictionary
        dictionary: SegmentDictionary = self._stage("dictionary")
        dictionary.fit(np.concatenate([one.segment_histograms for one in objects]))
        give_back()
        return dictionary

    def _activations(self, X: Iterable[DescribedObject]) -> list[Activation]:
        """Constellations of new objects, of which nothing is left out."""
        check_is_fitted(self, "hierarchies_")
        propagations = propagate(_decomposed(_checked_objects(X)), self.dictionary_)
        return [(p.histograms, self.hierarchies_.activated(p.words), -1) for p in propagations]

    def _stimuli(self, activations: list[Activation]) -> csr_matrix:
        row_of: Callable[[Activation], SparseRow] = self.field_.rows.row
        if self.hierarchies_.is_thinned:
            row_of = partial(compact_row, row_of)
        return self._sparse_rows(row_of, activations, len(self.columns_))

    def _sparse_rows(
        self, row_of: Callable[[Activation], SparseRow], activations: list[Activation], n_columns: int
    ) -> csr_matrix:
        # The kernels run without Python's lock, so threads do, and nothing is copied.
        return sparse_rows(list(map_in_order(row_of, activations, self.n_jobs, share_memory=True)), n_columns)

    def _output(self, rows: csr_matrix) -> Any:
        # scikit-learn makes data frames of dense matrices only.
        is_plain = _get_output_config("transform", self)["dense"] == "default"
        return rows if is_plain else rows.toarray()


def _decomposed(objects: list[DescribedObject]) -> list[DecomposedObject]:
    return [decompose_object(one) for one in objects]


def _checked_objects(X: Iterable[DescribedObject]) -> list[DescribedObject]:
    objects = as_list(X, DescribedObject)
    for position, one in enumerate(objects):
        if not isinstance(one, DescribedObject):
            raise ValueError(
                "X must hold objects of type DescribedObject, as `describe` makes them, "
                f"got {type(one).__name__} at position {position}"
            )
    n_bins = sorted({one.description.n_bins for one in objects})
    if len(n_bins) > 1:
        raise ValueError(f"X must hold objects described by one number of bins, got {n_bins}")
    return objects
