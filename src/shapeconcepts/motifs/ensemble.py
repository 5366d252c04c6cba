"""The shape motif hierarchy ensemble: from described objects to stimuli."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from numbers import Real

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import BaseEstimator, TransformerMixin, clone
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.descriptors.described_object import DescribedObject, describe
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.descriptors.registry import get_descriptor
from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.motifs.explanation import Explanation, explain_by_prototypes, explain_propagation
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.propagation import propagate
from shapeconcepts.motifs.prototype_stimuli import PrototypeField, prototype_rows
from shapeconcepts.motifs.stimuli import Activation, SparseRow, sparse_rows, stimuli_rows
from shapeconcepts.parallel import in_chunks
from shapeconcepts.parameters import check_choice, check_integer
from shapeconcepts.segmentation.segmented_object import SegmentedObject

COLUMNS = ("prototypes", "motifs")


class MotifHierarchyEnsemble(TransformerMixin, BaseEstimator):
    """Learns the motifs of segmented objects, and turns an object into the stimuli of these motifs.

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
    descriptor : {"surflet+fpfh+curvature", "surflet+fpfh", "surflet", "fpfh", "curvature"} or Descriptor
        Describes objects that come without a description.
    columns : {"prototypes", "motifs"}
        What a column of the stimuli stands for: one prototype, see `PrototypeField`; or a motif vertex with
        the mean over its prototypes (the paper's equation 1). A change takes effect when more is learned.
    n_neighbours : int or None
        For "prototypes": the bandwidth around a prototype follows the divergence to its n-th neighbour. None:
        the square root of the number of prototypes.
    bandwidth : float
        For "motifs": sigma of equation 1, in bits of Jensen-Shannon divergence.
    leave_own_out : bool
        Whether an object's own prototypes are left out of its row in `stimuli_`. They always match, which no
        prototype does for a new object.
    min_support : int
        For "motifs": smallest number of training objects in which a motif must have been seen to be a column
        of the stimuli.
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    dictionary_ : SegmentDictionary
    hierarchies_ : MotifHierarchies
        Vertices, edges and prototypes.
    columns_ : (c,) int64
        Prototype behind each column of the stimuli, in the order in which they were seen; or vertex, ordered
        by dictionary level, number of words, and words.
    stimuli_ : (n_objects, c) csr_matrix of float64
        Rows of the training objects, to learn from. `transform` of the same objects gives other rows, as it
        leaves nothing out.
    """

    _training_stimuli: csr_matrix | None
    _stimuli_parameters: tuple[float, bool, int | None]
    _prototype_field: PrototypeField | None
    _columns: str

    def __init__(
        self,
        dictionary: SegmentDictionary | None = None,
        descriptor: str | Descriptor = "surflet+fpfh+curvature",
        columns: str = "prototypes",
        n_neighbours: int | None = None,
        bandwidth: float = 0.1,
        leave_own_out: bool = True,
        min_support: int = 2,
        n_jobs: int | None = None,
    ) -> None:
        self.dictionary = dictionary
        self.descriptor = descriptor
        self.columns = columns
        self.n_neighbours = n_neighbours
        self.bandwidth = bandwidth
        self.leave_own_out = leave_own_out
        self.min_support = min_support
        self.n_jobs = n_jobs

    @classmethod
    def preset(cls, name: str) -> MotifHierarchyEnsemble:
        """An ensemble with a named choice of parameters.

        Parameters
        ----------
        name : {"default", "paper"}
            "paper" takes the paper at its word: words under L2, FPFH, every vertex a column, sigma 0.025, own
            prototypes in.

        Raises
        ------
        ValueError
            If there is no such preset.
        """
        if name == "default":
            return cls()
        if name == "paper":
            dictionary = SegmentDictionary(n_levels=4, metric="euclidean")
            return cls(dictionary, "fpfh", "motifs", bandwidth=0.025, leave_own_out=False, min_support=1)
        raise ValueError(f"preset must be 'default' or 'paper', got {name!r}")

    def fit(self, X: Iterable[SegmentedObject | DescribedObject], y: object = None) -> MotifHierarchyEnsemble:
        """Learn dictionary and motifs from objects, forgetting what was learned before.

        Parameters
        ----------
        X : iterable of SegmentedObject or DescribedObject
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
        self.check_parameters()
        described = self._described(X)
        dictionary = self._fitted_dictionary(described)
        n_bins = described[0].description.n_bins
        return self._learn(described, dictionary, MotifHierarchies.empty(len(dictionary.words_), n_bins))

    def partial_fit(
        self, X: Iterable[SegmentedObject | DescribedObject], y: object = None
    ) -> MotifHierarchyEnsemble:
        """Add objects to what was learned before; the dictionary stays as it is.

        The first call learns the dictionary, like `fit`. Learning in parts gives the same hierarchies as
        learning all at once with the same dictionary. Columns of prototypes come behind those that are there;
        columns of motifs can appear and move, and what names a motif for good is its dictionary level and its
        words.

        Parameters, errors and result are those of `fit`.
        """
        if not hasattr(self, "hierarchies_"):
            return self.fit(X)
        self.check_parameters()
        return self._learn(self._described(X), self.dictionary_, self.hierarchies_)

    def transform(self, X: Iterable[SegmentedObject | DescribedObject]) -> csr_matrix:
        """Stimuli of objects; what was learned does not change.

        Parameters
        ----------
        X : iterable of SegmentedObject or DescribedObject

        Returns
        -------
        (n, c) csr_matrix of float64
            Stimuli up to 1, without those that are next to nothing. Of "prototypes", a row sums to the share
            of the object's constellations that remind of anything. A row is the same alone and among others.

        Raises
        ------
        ValueError
            If X holds something else, or an object has more than 16 segments or other histograms.
        """
        check_is_fitted(self, "hierarchies_")
        self.check_parameters()
        described = self._described(X, allow_empty=True)
        propagations = [propagate(one, self.dictionary_) for one in described]
        return self._stimuli([(p.histograms, self.hierarchies_.activated(p.words), -1) for p in propagations])

    def fit_transform(self, X: Iterable[SegmentedObject | DescribedObject], y: object = None) -> csr_matrix:
        """Learn from objects, and give the rows to go on with: `stimuli_`, not those of `transform`."""
        return self.fit(X).stimuli_

    def explain(self, X: SegmentedObject | DescribedObject) -> Explanation:
        """Why an object has the stimuli that it has.

        Parameters
        ----------
        X : SegmentedObject or DescribedObject

        Returns
        -------
        Explanation
            What fired, in falling order of the stimulus, each with the constellation behind it and the
            prototypes that it resembles most: of "prototypes", an entry for each constellation; of "motifs",
            for each column of the row.
        """
        check_is_fitted(self, "hierarchies_")
        self.check_parameters()
        (described,) = self._described([X])
        propagation = propagate(described, self.dictionary_)
        if self._columns == "prototypes":
            return explain_by_prototypes(propagation, self.hierarchies_, self.prototype_field_)
        return explain_propagation(propagation, self.hierarchies_, self.columns_, float(self.bandwidth))

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns.

        "object5 s0 s2" is the prototype that segments 0 and 2 of training object 5 left; "d3 m2 w1 w4" is the
        motif of words 1 and 4 of dictionary level 3, first seen at motif level 2.
        """
        check_is_fitted(self, "hierarchies_")
        if self._columns == "prototypes":
            return np.array([self.hierarchies_.prototype_name(t) for t in self.columns_], dtype=object)
        return np.array([self.hierarchies_.name(vertex) for vertex in self.columns_], dtype=object)

    @property
    def stimuli_(self) -> csr_matrix:
        """Rows of the training objects, computed when they are first asked for."""
        check_is_fitted(self, "hierarchies_")
        self.check_parameters()
        parameters = (float(self.bandwidth), bool(self.leave_own_out), self.n_neighbours)
        if self._training_stimuli is None or self._stimuli_parameters != parameters:
            self._stimuli_parameters = parameters
            known = self.hierarchies_
            starts = np.flatnonzero(np.diff(known.prototype_objects, prepend=-1))[1:]
            histograms = np.split(known.prototypes, starts)
            vertices = np.split(known.prototype_vertices, starts)
            left_out = range(known.n_objects) if self.leave_own_out else [-1] * known.n_objects
            self._training_stimuli = self._stimuli(list(zip(histograms, vertices, left_out, strict=True)))
        return self._training_stimuli

    def _learn(
        self, described: list[DescribedObject], dictionary: SegmentDictionary, hierarchies: MotifHierarchies
    ) -> MotifHierarchyEnsemble:
        propagations = [propagate(one, dictionary) for one in described]
        self.hierarchies_ = hierarchies.with_objects(propagations, [one.name for one in described])
        self.dictionary_ = dictionary
        self._columns = self.columns
        self.columns_ = (
            np.arange(len(self.hierarchies_.prototypes))
            if self._columns == "prototypes"
            else _supported_vertices(self.hierarchies_, self.min_support)
        )
        self._training_stimuli = self._prototype_field = None
        return self

    def _fitted_dictionary(self, described: list[DescribedObject]) -> SegmentDictionary:
        if self.dictionary is not None and hasattr(self.dictionary, "words_"):
            return self.dictionary
        dictionary = SegmentDictionary() if self.dictionary is None else clone(self.dictionary)
        segments = [one.description.histograms(1 << np.arange(one.n_segments)) for one in described]
        return dictionary.fit(np.concatenate(segments))

    def _described(
        self, X: Iterable[SegmentedObject | DescribedObject], *, allow_empty: bool = False
    ) -> list[DescribedObject]:
        if not isinstance(X, Iterable):
            raise ValueError(f"X must be a list or another iterable of objects, got one {type(X).__name__}")
        objects = list(X)
        if not objects and not allow_empty:
            raise ValueError("X must hold at least one object, got none")
        for position, one in enumerate(objects):
            if not isinstance(one, SegmentedObject | DescribedObject):
                raise ValueError(
                    "X must hold objects of type SegmentedObject or DescribedObject, "
                    f"got {type(one).__name__} at position {position}"
                )
        flat = [one for one in objects if isinstance(one, DescribedObject)]
        if len(flat) < len(objects):
            flat = in_chunks(_describe_all, objects, self.n_jobs, None, get_descriptor(self.descriptor))
        n_bins = sorted({one.description.n_bins for one in flat})
        if len(n_bins) > 1:
            raise ValueError(f"X must hold objects described by one number of bins, got {n_bins}")
        return flat

    def _stimuli(self, activations: list[Activation]) -> csr_matrix:
        # The kernels run without Python's lock, so threads do, and nothing is copied.
        rows: list[SparseRow]
        if self._columns == "prototypes":
            rows = in_chunks(prototype_rows, activations, self.n_jobs, "threads", self.prototype_field_)
            return sparse_rows(rows, len(self.columns_))
        column_of = np.full(self.hierarchies_.n_vertices, -1, np.int32)
        column_of[self.columns_] = np.arange(len(self.columns_))
        known = (self.hierarchies_, column_of, float(self.bandwidth))
        rows = in_chunks(stimuli_rows, activations, self.n_jobs, "threads", *known)
        return sparse_rows(rows, len(self.columns_))

    @property
    def prototype_field_(self) -> PrototypeField:
        """The prototypes with their bandwidths, computed when they are first asked for."""
        check_is_fitted(self, "hierarchies_")
        n_neighbours = self.n_neighbours or max(1, round(len(self.hierarchies_.prototypes) ** 0.5))
        if self._prototype_field is None or self._prototype_field.n_neighbours != n_neighbours:
            self._prototype_field = PrototypeField.of(self.hierarchies_, n_neighbours)
        return self._prototype_field

    def check_parameters(self) -> None:
        """Raise a ValueError if a parameter is out of range."""
        check_choice("columns", self.columns, COLUMNS)
        if self.n_neighbours is not None:
            check_integer("n_neighbours", self.n_neighbours, 1)
        if (
            isinstance(self.bandwidth, bool)
            or not isinstance(self.bandwidth, Real)
            or not 0 < self.bandwidth < np.inf
        ):
            raise ValueError(f"bandwidth must be a positive number, got {self.bandwidth!r}")
        check_integer("min_support", self.min_support, 1)
        get_descriptor(self.descriptor)


def _supported_vertices(hierarchies: MotifHierarchies, min_support: int) -> NDArray[np.int64]:
    """Vertices with enough support, in an order that does not depend on when they were seen."""
    supported = np.flatnonzero(hierarchies.support >= min_support)
    words = hierarchies.words[supported]
    # Words stand at the end of their row: fewer words mean more -1 before them, so sorting the whole row
    # orders by number first.
    order = np.lexsort((*words.T[::-1], hierarchies.dictionary_levels[supported]))
    return supported[order]


def _describe_all(
    objects: Sequence[SegmentedObject | DescribedObject], descriptor: Descriptor
) -> list[DescribedObject]:
    return [one if isinstance(one, DescribedObject) else describe(one, descriptor) for one in objects]
