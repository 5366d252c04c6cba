"""Filtration of a topological space: annexations over time, persistence diagram, and groups at any time."""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import sparray, spmatrix
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.concepts_of_groups import concepts_of_groups, lives
from shapeconcepts.concepts.mixing import refusals
from shapeconcepts.concepts.settling import settled
from shapeconcepts.concepts.stopping import States, most_annexations
from shapeconcepts.parameters import check_choice, check_integer
from shapeconcepts.topology.annexation_kernels import annex
from shapeconcepts.topology.groups import Groups, members_of_groups
from shapeconcepts.topology.neighbourhood import Neighbourhoods
from shapeconcepts.topology.separation_kernels import separation_order
from shapeconcepts.topology.space import TopologicalSpace

if TYPE_CHECKING:
    import networkx

HEATS = ("separation", "geodesic")
STOPS = ("refusal", "annexations")


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
    """

    def __init__(
        self,
        min_concept_size: int = 3,
        max_steps: int = 200,
        heat: str = "separation",
        stop: str = "refusal",
    ) -> None:
        self.min_concept_size = min_concept_size
        self.max_steps = max_steps
        self.heat = heat
        self.stop = stop

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
        self.check_parameters()
        self._filter(TopologicalSpace().fit(X))
        return self

    def check_parameters(self) -> None:
        """Raise a ValueError if a parameter is out of range."""
        check_choice("heat", self.heat, HEATS)
        check_choice("stop", self.stop, STOPS)
        check_integer("min_concept_size", self.min_concept_size, 2)
        check_integer("max_steps", self.max_steps, 1)

    def _filter(self, space: TopologicalSpace) -> None:
        order, times = self._order(space)
        if self.stop == "annexations":
            states = self._annex(space, order, times, np.zeros(len(order), bool))
            self.epsilon_max_ = most_annexations(states, *self.annexations())
            time = self.epsilon_max_
            self.concepts_: list[Concept] = [] if time is None else self.concepts_at(time)
        else:
            neighbourhoods = Neighbourhoods.of(space)
            refused = refusals(space, order, neighbourhoods, self.min_concept_size)
            states = self._annex(space, order, times, refused)
            self.epsilon_max_ = most_annexations(states, *self.annexations())
            time = 1.0
            self.concepts_ = self._settled(neighbourhoods)
        self.concept_time_ = time if self.concepts_ else None
        if not self.concepts_:
            size = f"of at least {self.min_concept_size} objects"
            found = (
                f"at no time two concepts {size}, none with more than half"
                if self.stop == "annexations"
                else f"no class {size}"
            )
            warnings.warn(
                f"the filtration of {int(space.multiplicities_.sum())} objects "
                f"({len(space.multiplicities_)} different places in the space) leaves {found}: "
                "no object is in a concept",
                stacklevel=3,
            )
        self.labels_ = np.full(len(space.vertices_), -1, np.int32)
        for number, concept in enumerate(self.concepts_):
            self.labels_[concept.members] = number

    def _order(self, space: TopologicalSpace) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Order in which the edges of a space would enter, and when."""
        if self.heat == "separation":
            order, edge_heat = separation_order(space.edges_, space.divergences_, space.multiplicities_)
        else:
            order = np.argsort(space.edge_heat_, kind="stable")
            edge_heat = space.edge_heat_[order]
        return order, _times(edge_heat)

    def _annex(
        self,
        space: TopologicalSpace,
        order: NDArray[np.int64],
        times: NDArray[np.float64],
        refused: NDArray[np.bool_],
    ) -> States:
        """Let the edges of a space enter, but for those that are refused."""
        self.space_ = space
        self.n_features_in_ = space.n_features_in_
        edges = space.edges_[order]
        self.edges_, self.times_ = edges[~refused], times[~refused]
        self.refused_edges_, self.refused_times_ = edges[refused], times[refused]
        dying, surviving, dying_sizes, surviving_sizes = annex(self.edges_, space.multiplicities_)
        self.annexations_ = np.stack([dying, surviving], axis=1)
        return States.of(
            self.times_, dying_sizes, surviving_sizes, space.multiplicities_, self.min_concept_size
        )

    def _settled(self, neighbourhoods: Neighbourhoods) -> list[Concept]:
        """The classes that are left in the end, after objects at their borders have settled."""
        groups, chosen = self._groups_at(1.0, None)
        births, deaths = lives(groups, self.edges_, self.times_, len(self.times_))
        number_of = np.full(groups.n_groups, -1, np.int32)
        number_of[chosen] = np.arange(len(chosen))
        sizes = self.space_.multiplicities_
        of_vertex = settled(number_of[groups.of_vertex], sizes, neighbourhoods, self.min_concept_size)
        after = Groups(len(chosen), of_vertex, np.append(of_vertex, np.int32(-1))[self.space_.vertices_])
        largest_first = after.of_size(self.min_concept_size)
        return concepts_of_groups(self.space_, after, largest_first, births[chosen], deaths[chosen])

    @property
    def times(self) -> NDArray[np.float64]:
        """Time of each annexation, rising, (e,) float64."""
        check_is_fitted(self)
        return self.times_

    @property
    def edges(self) -> NDArray[np.int32]:
        """Edges of the spanning tree in the order of their time, (e, 2) int32."""
        check_is_fitted(self)
        return self.edges_

    @property
    def concept_time(self) -> float | None:
        """Time at which concepts are taken, None where there are none."""
        check_is_fitted(self)
        return self.concept_time_

    @property
    def epsilon_max(self) -> float | None:
        """The paper's time of the most annexations, None where no step qualifies."""
        check_is_fitted(self)
        return self.epsilon_max_

    @property
    def n_steps(self) -> int:
        """Number of equal steps of time: as many as the first annexation fits into 1, at most `max_steps`."""
        check_is_fitted(self)
        if len(self.times_) == 0:
            return 1
        # Without the hair, rounding would add a step where the first time is an exact fraction.
        return int(min(self.max_steps, np.ceil(1 / self.times_[0] - 1e-9)))

    def annexations(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Annexations per step of time (paper: annexation curve).

        Returns
        -------
        step_ends : (k,) float64
            End of each step; the last is 1.
        counts : (k,) int64
            Annexations after the end of the step before, and up to this one.
        """
        n_steps = self.n_steps
        return np.arange(1, n_steps + 1) / n_steps, np.bincount(self._steps(), minlength=n_steps)

    def diagram(self) -> NDArray[np.float64]:
        """Persistence diagram of homology group 0 (paper: barcode).

        Returns
        -------
        (v, 2) float64
            Birth and death of the class of each vertex of the space. All are born at 0; one that is left in
            the end never dies: its death is infinite.
        """
        check_is_fitted(self)
        diagram = np.zeros((len(self.space_.multiplicities_), 2))
        diagram[:, 1] = np.inf
        diagram[self.annexations_[:, 0], 1] = self.times_
        return diagram

    def graph(self) -> networkx.DiGraph:
        """Filtration graph F: an edge from each class that dies to the one that annexes it.

        Returns
        -------
        networkx.DiGraph
            Vertices of the space, with `objects` (rows of X at this place); edges with `time`.
        """
        import networkx

        check_is_fitted(self)
        graph = networkx.DiGraph()
        objects, starts = members_of_groups(self.space_.vertices_, len(self.space_.multiplicities_))
        for vertex, (start, end) in enumerate(pairwise(starts)):
            graph.add_node(vertex, objects=objects[start:end].tolist())
        for (dying, surviving), time in zip(self.annexations_.tolist(), self.times_.tolist(), strict=True):
            graph.add_edge(dying, surviving, time=time)
        return graph

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
        n_joined = int(np.searchsorted(self.times_, time, side="right"))
        births, deaths = lives(groups, self.edges_, self.times_, n_joined)
        return concepts_of_groups(self.space_, groups, chosen, births, deaths)

    def without_refusals(self) -> Filtration:
        """Filtration of the same space in which nothing is refused: down to a single group."""
        check_is_fitted(self)
        whole = Filtration(self.min_concept_size, self.max_steps, self.heat, "annexations")
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
        joined = self.edges_[: np.searchsorted(self.times_, time, side="right")]
        groups = Groups.connected_by(joined, len(self.space_.multiplicities_), self.space_.vertices_)
        return groups, groups.of_size(smallest)

    def _steps(self) -> NDArray[np.int64]:
        """Step in which each annexation falls."""
        n_steps = self.n_steps
        return np.clip(np.ceil(self.times_ * n_steps - 1e-9).astype(np.int64) - 1, 0, n_steps - 1)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = True
        tags.input_tags.positive_only = True
        return tags


def _times(edge_heat: NDArray[np.float64]) -> NDArray[np.float64]:
    """Heat as time in (0, 1]: the coldest edges enter first, and nothing does at 0."""
    if len(edge_heat) == 0 or edge_heat.min() == edge_heat.max():
        return np.ones(len(edge_heat))
    smallest = edge_heat[edge_heat > 0].min()
    coldest = edge_heat.min()
    return (edge_heat - coldest + smallest) / (edge_heat.max() - coldest + smallest)
