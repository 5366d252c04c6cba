"""Filtration of a topological space, and the concepts that it leaves."""

from __future__ import annotations

import copy
import warnings
from numbers import Integral
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import sparray, spmatrix
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.utils.validation import check_is_fitted

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.concept_tree import ConceptTree
from shapeconcepts.concepts.concepts_of_groups import concepts_of_groups, concepts_of_members
from shapeconcepts.concepts.group_tree import GroupTree
from shapeconcepts.concepts.significance import significant, split_p_values
from shapeconcepts.concepts.stopping import most_annexations
from shapeconcepts.parameters import (
    check_integer,
    check_parameters,
    check_share,
    choice,
    share,
    whole_number,
)
from shapeconcepts.topology.annexations import Annexations, order_by_centrality
from shapeconcepts.topology.groups import Groups
from shapeconcepts.topology.mean_divergence import mean_divergences
from shapeconcepts.topology.space import TopologicalSpace

if TYPE_CHECKING:
    import networkx


# Of so many times the vertices that are compared pair by pair, the exact tree takes about as long as they do.
_EXACT_TREE = 4


class Filtration(ClusterMixin, BaseEstimator):
    """Lets the objects of a topological space annex each other along the edges of its tree.

    Time runs from just above 0, when every object is alone, to 1. At each edge the class with fewer members
    dies (paper: Topological Filtration, Persistent Shape Concept Extraction).

    Parameters
    ----------
    min_concept_size : int
        Smallest number of objects of a concept, at least 2.
    max_steps : int
        Largest number of equal steps of time in which annexations are counted, from 1.
    heat : {"divergence", "geodesic"}
        When an edge enters. "divergence": at the mean Jensen-Shannon divergence between the two classes that
        it joins, in bits. "geodesic": the later, the more central it is in the tree (paper: equation 2).
    stop : {"persistence", "annexations"}
        What concepts are. "persistence", which needs heat "divergence": groups whose splits are significant,
        see `significance`, at a granularity. "annexations": the classes at the time of the most annexations,
        see `most_annexations` (paper).
    error_rate : float
        For "persistence": expected share of false ones among the splits that are taken, and where there is
        only one group the probability that it is split, 0 to 1.
    granularity : float or None
        For "persistence": two groups are two concepts if their objects have less than this in common on
        average, as 1 minus their divergence, 0 (coarse) to 1 (every significant split). None: the cut that
        persists most, see `ConceptTree.most_persistent_granularity`.
    max_vertices : int
        With heat "divergence": of more different objects, the nearest are gathered in small classes before
        mean divergences are taken; and of four times as many, the tree is that of a sample, on which all
        others hang, see `TopologicalSpace`.
    n_jobs : int or None
        As in joblib. The result does not depend on it.

    Attributes
    ----------
    space_ : TopologicalSpace
    times_ : (e,) float64
        Time of each annexation, rising, in (0, 1].
    edges_ : (e, 2) int32
        Edges of the spanning tree in the order of their time, as vertices of the space.
    p_values_ : (e,) float64
        Of the split between the classes that each annexation joins, with "persistence"; NaN where one of them
        is smaller than a concept.
    annexations_ : (e, 2) int32
        Representative of the class that dies, and of the one that it dies into: the edges of the filtration
        graph F.
    concept_tree_ : ConceptTree or None
        All groups that significant splits leave apart, coarse to fine. None for "annexations".
    granularity_ : float or None
        Where concepts are taken. None for "annexations".
    concept_time_ : float or None
        The same as a time. None where there are no concepts.
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
        "heat": [choice("divergence", "geodesic")],
        "stop": [choice("persistence", "annexations")],
        "error_rate": [share()],
        "granularity": [share(), None],
        "max_vertices": [whole_number(2)],
        "n_jobs": [Integral, None],
    }

    def __init__(
        self,
        min_concept_size: int = 3,
        max_steps: int = 200,
        heat: str = "divergence",
        stop: str = "persistence",
        error_rate: float = 0.05,
        granularity: float | None = None,
        max_vertices: int = 4096,
        n_jobs: int | None = None,
    ) -> None:
        self.min_concept_size = min_concept_size
        self.max_steps = max_steps
        self.heat = heat
        self.stop = stop
        self.error_rate = error_rate
        self.granularity = granularity
        self.max_vertices = max_vertices
        self.n_jobs = n_jobs

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
        if self.stop == "persistence" and self.heat != "divergence":
            raise ValueError(
                f"heat must be 'divergence' where stop is 'persistence', got {self.heat!r}: "
                "persistent concepts are cut at a divergence"
            )
        self._filter(TopologicalSpace(self._max_exact, self.n_jobs).fit(X))
        return self

    @property
    def _max_exact(self) -> int | None:
        """Of how many vertices the tree is exact: heat by centrality needs all of it."""
        return None if self.heat == "geodesic" else _EXACT_TREE * int(self.max_vertices)

    def _filter(self, space: TopologicalSpace) -> None:
        if self.heat == "geodesic":
            order, times = order_by_centrality(space)
            classes = None
        else:
            classes = mean_divergences(space, self.max_vertices)
            # Nothing enters at 0.
            order, times = classes.order, np.maximum(classes.means, np.finfo(float).tiny)
        self._annex(space, space.edges_[order], times)
        if classes is not None and self.stop == "persistence":
            could_be_concepts = self._history.dying_sizes >= self.min_concept_size
            self._split(split_p_values(classes, could_be_concepts))
        else:
            self.p_values_ = np.full(len(times), np.nan)
        self._take_concepts()
        if not self.concepts_:
            self._warn_of_no_concepts()

    def _annex(self, space: TopologicalSpace, edges: NDArray[np.int32], times: NDArray[np.float64]) -> None:
        """Let the edges of a space enter."""
        self.space_ = space
        self.n_features_in_ = space.n_features_in_
        self._history = Annexations.along(space, edges, times)
        self.edges_, self.times_ = self._history.edges, self._history.times
        self.annexations_ = np.stack([self._history.dying, self._history.surviving], axis=1)
        self.epsilon_max_ = most_annexations(self._history, self.max_steps, self.min_concept_size)
        self.granularity_: float | None = None
        self.concept_tree_: ConceptTree | None = None
        # One object for each group of the tree: a name that it is given stays in every cut.
        self._concept_of: dict[int, Concept] = {}

    def _split(self, p_values: NDArray[np.float64]) -> ConceptTree:
        """Keep apart what significant splits are between."""
        self.p_values_ = p_values
        splits = significant(p_values, self.error_rate)
        tree = ConceptTree.of(self._history, splits, p_values, self.min_concept_size)
        self.concept_tree_ = tree
        self.granularity_ = (
            tree.most_persistent_granularity() if self.granularity is None else float(self.granularity)
        )
        return tree

    def _take_concepts(self) -> None:
        time = self.epsilon_max_ if self.granularity_ is None else 1.0 - self.granularity_
        concepts: list[Concept] = []
        if self.granularity_ is not None:
            concepts = self.concepts_at(self.granularity_)
        elif time is not None:
            concepts = self.groups_at(time)
        self.concepts_ = concepts
        self.concept_time_ = time if concepts else None
        self.labels_ = np.full(len(self.space_.vertices_), -1, np.int32)
        for number, concept in enumerate(concepts):
            self.labels_[concept.members] = number

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

    def concepts_at(self, granularity: float) -> list[Concept]:
        """Concepts at any granularity, of the groups of `concept_tree_`.

        A concept is the same object in every cut in which it exists, and so keeps its name.

        Parameters
        ----------
        granularity : float
            As the parameter, 0 to 1.

        Returns
        -------
        list of Concept
            Largest first; of equally large ones the one with the smallest vertex first.

        Raises
        ------
        ValueError
            If `granularity` is not between 0 and 1, or `stop` is "annexations", which has a time instead.
        """
        return self._concepts_of(self._groups(granularity))

    def _groups(self, granularity: float) -> list[int]:
        """Groups of the tree at a granularity, in the order of `concepts_at`."""
        tree = self._tree()
        groups = tree.cut(check_share("granularity", granularity)).tolist()
        members = {group: tree.members(group) for group in groups}
        return sorted(
            groups, key=lambda group: (-len(members[group]), self.space_.vertices_[members[group]].min())
        )

    def _concepts_of(self, groups: list[int]) -> list[Concept]:
        """Concepts of groups of the tree, which may be parts of each other."""
        tree = self._tree()
        new = [group for group in groups if group not in self._concept_of]
        members = [tree.members(group) for group in new]
        lives = tree.births[new], tree.deaths[new]
        self._concept_of.update(zip(new, concepts_of_members(self.space_, members, *lives), strict=True))
        return [self._concept_of[group] for group in groups]

    def at_granularity(self, granularity: float) -> Filtration:
        """The same filtration with its concepts taken at another granularity; nothing is filtered again.

        Parameters and errors are those of `concepts_at`.
        """
        self._tree()
        other = copy.copy(self)
        other.granularity = other.granularity_ = check_share("granularity", granularity)
        other._take_concepts()
        return other

    def _group_names(self) -> list[list[Any]]:
        """Groups of the tree that have a name, but for the present concepts, each with its name."""
        present = {id(concept) for concept in self.concepts_}
        return sorted(
            [group, concept.name]
            for group, concept in self._concept_of.items()
            if concept.name and id(concept) not in present
        )

    def _name_groups(self, names: list[list[Any]]) -> None:
        """Give groups of the tree their names, see `_group_names`."""
        concepts = self._concepts_of([group for group, _ in names])
        for concept, (_, name) in zip(concepts, names, strict=True):
            concept.name = name

    def _tree(self) -> ConceptTree:
        check_is_fitted(self)
        if self.concept_tree_ is None:
            raise ValueError(
                "there are no significant splits, and so no granularities, where stop is 'annexations': "
                "groups_at gives the groups at a time"
            )
        return self.concept_tree_

    def group_tree(self) -> GroupTree:
        """All groups of `concept_tree_`, and those that formed within the smallest of them.

        Raises
        ------
        ValueError
            If `stop` is "annexations", where there is no tree.
        """
        return GroupTree.below(self._tree(), self._history, self.min_concept_size)

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
            Birth and death of the class of each vertex of the space. All are born at 0; the last one never
            dies: its death is infinite.
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

    def groups_at(self, time: float, min_size: int | None = None) -> list[Concept]:
        """All groups of objects at a time, whether their splits are significant or not.

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

    def labels_at(self, time: float, min_size: int | None = None) -> NDArray[np.int32]:
        """Number of each object's group at a time, in the order of `groups_at`, -1 for none; (n,) int32.

        Parameters and errors are those of `groups_at`, which takes longer.
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
