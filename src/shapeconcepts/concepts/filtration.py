"""Filtration of a topological space, and the concepts that it leaves."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import sparray, spmatrix
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.concepts_of_groups import concepts_of_groups
from shapeconcepts.concepts.mixing import refusals
from shapeconcepts.concepts.settling import settled
from shapeconcepts.concepts.stopping import most_annexations
from shapeconcepts.parameters import (
    check_integer,
    check_parameters,
    choice,
    positive_number,
    share,
    whole_number,
)
from shapeconcepts.topology.annexations import HEATS, Annexations, order_of_edges
from shapeconcepts.topology.groups import Groups
from shapeconcepts.topology.neighbourhood import Neighbourhoods
from shapeconcepts.topology.space import TopologicalSpace

if TYPE_CHECKING:
    import networkx


class Filtration(ClusterMixin, BaseEstimator):
    """Lets the objects of a topological space annex each other along the edges of its tree.

    Edges enter in the order of their heat. Time runs from just above 0, when the first enter, to 1. At each
    edge the class with fewer members dies (paper: Topological Filtration, Persistent Shape Concept
    Extraction). An edge between classes that do not mix can be refused: it never enters, and classes are left
    in the end that never die.

    Parameters
    ----------
    min_concept_size : int
        Smallest number of objects of a concept, at least 2.
    max_steps : int
        Largest number of equal steps of time in which annexations are counted, from 1.
    heat : {"separation", "geodesic"}
        "separation": an edge is the hotter, the longer it is and the larger the classes are that it holds
        apart, divergence times sqrt(a b / (a + b)) for a and b objects. "geodesic": the more central it is in
        the tree (paper: equation 2).
    stop : {"refusal", "annexations"}
        What concepts are. "refusal": the classes that are left in the end, as edges between classes that do
        not mix are refused, see `refusals`; objects at their borders settle, see `settled`. "annexations":
        those at the time of the most annexations, see `most_annexations` (paper); nothing is refused, and a
        single class is left in the end.
    least_mixing : float
        For "refusal": what mixes less is refused, 0 to 1.
    neighbours_per_root : float
        For "refusal": size of the neighbourhoods in which mixing is counted, in square roots of the number of
        objects; 36 objects at least, half of all at most.
    n_nearest : int
        For "refusal": nearest members of a concept that an object at its border is compared with.

    Attributes
    ----------
    space_ : TopologicalSpace
    times_ : (e,) float64
        Time of each annexation, rising, in (0, 1].
    edges_ : (e, 2) int32
        Edges of the spanning tree that enter, in the order of their time, as vertices of the space.
    refused_edges_ : (r, 2) int32
        The others, in this order, too.
    refused_times_ : (r,) float64
        When they would have entered.
    annexations_ : (e, 2) int32
        Representative of the class that dies, and of the one that it dies into: the edges of the filtration
        graph F.
    concept_time_ : float or None
        The time at which concepts are taken; with "refusal", 1. None where there are none.
    epsilon_max_ : float or None
        The paper's indicator of that time: where annexations are most frequent.
    labels_ : (n,) int32
        Concept of each object, -1 for none.
    concepts_ : list of Concept
    n_features_in_ : int
    """

    _parameter_constraints: ClassVar[dict[str, list[Any]]] = {
        "min_concept_size": [whole_number(2)],
        "max_steps": [whole_number(1)],
        "heat": [choice(*HEATS)],
        "stop": [choice("refusal", "annexations")],
        "least_mixing": [share()],
        "neighbours_per_root": [positive_number()],
        "n_nearest": [whole_number(1)],
    }

    def __init__(
        self,
        min_concept_size: int = 3,
        max_steps: int = 200,
        heat: str = "separation",
        stop: str = "refusal",
        least_mixing: float = 0.8,
        neighbours_per_root: float = 3.0,
        n_nearest: int = 10,
    ) -> None:
        self.min_concept_size = min_concept_size
        self.max_steps = max_steps
        self.heat = heat
        self.stop = stop
        self.least_mixing = least_mixing
        self.neighbours_per_root = neighbours_per_root
        self.n_nearest = n_nearest

    def fit(self, X: ArrayLike | spmatrix | sparray, y: object = None) -> Filtration:
        """Filter the space of the rows of a matrix.

        Parameters
        ----------
        X : (n, c) array-like or sparse matrix
            Non-negative, such as stimuli.
        y : ignored

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If a parameter is out of range, or X is not a matrix of finite numbers of at least 0.

        Warns
        -----
        UserWarning
            If no object is in a concept.
        """
        check_parameters(self)
        self._filter(TopologicalSpace().fit(X))
        return self

    def _filter(self, space: TopologicalSpace) -> None:
        order, times = order_of_edges(space, self.heat)
        if self.stop == "annexations":
            self._annex(space, order, times, np.zeros(len(order), bool))
            time = self.epsilon_max_ = self._most_annexations()
            concepts = [] if time is None else self.concepts_at(time)
        else:
            neighbourhoods = Neighbourhoods.of(space, self.neighbours_per_root)
            refused = refusals(space, order, neighbourhoods, self.least_mixing, self.min_concept_size)
            self._annex(space, order, times, refused)
            self.epsilon_max_ = self._most_annexations()
            time = 1.0
            concepts = self._settled(neighbourhoods)
        self.concepts_: list[Concept] = concepts
        self.concept_time_ = time if concepts else None
        if not concepts:
            self._warn_of_no_concepts()
        self.labels_ = np.full(len(space.vertices_), -1, np.int32)
        for number, concept in enumerate(concepts):
            self.labels_[concept.members] = number

    def _most_annexations(self) -> float | None:
        return most_annexations(self._history, self.max_steps, self.min_concept_size)

    def _warn_of_no_concepts(self) -> None:
        size = f"of at least {self.min_concept_size} objects"
        found = (
            f"at no time two concepts {size}, none with more than half"
            if self.stop == "annexations"
            else f"no class {size}"
        )
        multiplicities = self.space_.multiplicities_
        warnings.warn(
            f"the filtration of {int(multiplicities.sum())} objects "
            f"({len(multiplicities)} different places in the space) leaves {found}: "
            "no object is in a concept",
            stacklevel=4,
        )

    def _annex(
        self,
        space: TopologicalSpace,
        order: NDArray[np.int64],
        times: NDArray[np.float64],
        refused: NDArray[np.bool_],
    ) -> None:
        """Let the edges of a space enter, but for those that are refused."""
        self.space_ = space
        self.n_features_in_ = space.n_features_in_
        edges = space.edges_[order]
        self.refused_edges_, self.refused_times_ = edges[refused], times[refused]
        self._history = Annexations.along(space, edges[~refused], times[~refused])
        self.edges_, self.times_ = self._history.edges, self._history.times
        self.annexations_ = np.stack([self._history.dying, self._history.surviving], axis=1)

    def _settled(self, neighbourhoods: Neighbourhoods) -> list[Concept]:
        """The classes that are left in the end, after objects at their borders have settled."""
        groups = self._history.groups_at(1.0)
        chosen = groups.of_size(self.min_concept_size)
        births, deaths = self._history.lives(groups, 1.0)
        number_of = np.full(groups.n_groups, -1, np.int32)
        number_of[chosen] = np.arange(len(chosen))
        of_vertex = settled(
            number_of[groups.of_vertex],
            self.space_.multiplicities_,
            neighbourhoods,
            self.n_nearest,
            self.min_concept_size,
        )
        after = Groups(len(chosen), of_vertex, np.append(of_vertex, np.int32(-1))[self.space_.vertices_])
        largest_first = after.of_size(self.min_concept_size)
        return concepts_of_groups(self.space_, after, largest_first, births[chosen], deaths[chosen])

    def annexations(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Annexations per step of time (paper: annexation curve).

        Returns
        -------
        step_ends : (k,) float64
            End of each step; the last is 1.
        counts : (k,) int64
            Annexations after the end of the step before, and up to this one.
        """
        check_is_fitted(self)
        return self._history.per_step(self.max_steps)

    def diagram(self) -> NDArray[np.float64]:
        """Persistence diagram of homology group 0 (paper: barcode).

        Returns
        -------
        (v, 2) float64
            Birth and death of the class of each vertex of the space. All are born at 0; one that is left in
            the end never dies: its death is infinite.
        """
        check_is_fitted(self)
        return self._history.diagram()

    def graph(self) -> networkx.DiGraph:
        """Filtration graph F: an edge from each class that dies to the one that annexes it.

        Returns
        -------
        networkx.DiGraph
            Vertices of the space, with `objects` (rows of X at this place); edges with `time`.
        """
        check_is_fitted(self)
        return self._history.graph()

    def concepts_at(self, time: float, min_size: int | None = None) -> list[Concept]:
        """Groups of objects at a time.

        Parameters
        ----------
        time : float
            From 0, where every object is alone, to 1.
        min_size : int, optional
            Smallest number of objects, `min_concept_size` by default.

        Returns
        -------
        list of Concept
            Largest first; of equally large ones the one with the smallest vertex first.

        Raises
        ------
        ValueError
            If `time` is not between 0 and 1, or `min_size` is not a positive integer.
        """
        groups, chosen = self._groups_at(time, min_size)
        return concepts_of_groups(self.space_, groups, chosen, *self._history.lives(groups, time))

    def without_refusals(self) -> Filtration:
        """Filtration of the same space in which nothing is refused: down to a single group."""
        check_is_fitted(self)
        whole = Filtration(**{**self.get_params(), "stop": "annexations"})
        with warnings.catch_warnings():
            # The groups at other times are of interest, even if there are no concepts at the paper's.
            warnings.simplefilter("ignore", UserWarning)
            whole._filter(self.space_)
        return whole

    def labels_at(self, time: float, min_size: int | None = None) -> NDArray[np.int32]:
        """Number of each object's group at a time, in the order of `concepts_at`, -1 for none; (n,) int32.

        Parameters and errors are those of `concepts_at`, which takes longer.
        """
        groups, chosen = self._groups_at(time, min_size)
        number_of = np.full(groups.n_groups + 1, -1, np.int32)
        number_of[chosen] = np.arange(len(chosen))
        return number_of[groups.of_object]

    def _groups_at(self, time: float, min_size: int | None) -> tuple[Groups, NDArray[np.int64]]:
        """Groups at a time, and those that are large enough, the largest first."""
        check_is_fitted(self)
        if not 0 <= time <= 1:
            raise ValueError(f"time must be between 0 and 1, got {time!r}")
        smallest = self.min_concept_size if min_size is None else min_size
        check_integer("min_size", smallest, 1)
        groups = self._history.groups_at(time)
        return groups, groups.of_size(smallest)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = True
        tags.input_tags.positive_only = True
        return tags
