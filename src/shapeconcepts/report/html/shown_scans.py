"""Which scans a report shows, of very many a fair sample, and the spanning tree of those."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration
from shapeconcepts.concepts.response import LEAST_MEMBERS
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.topology.annexation_kernels import annex
from shapeconcepts.topology.groups import Groups
from shapeconcepts.topology.sample import draws
from shapeconcepts.topology.space import TopologicalSpace

# What a browser draws within seconds, in a file that can be sent.
MOST_SHOWN = 20_000
# Scatters numbers that count up evenly over 32 bits: the golden section of them (D. Knuth).
_GOLDEN_SECTION = 0x9E3779B1


class ShownScans(NamedTuple):
    """Scans of a model, and the tree that is left if all other vertices of its space go with one of theirs.

    Attributes
    ----------
    scans : (k,) int64
        Training scans, rising.
    vertices : (u,) int64
        Vertices of the space at which they are, rising.
    vertex_of_scan : (k,) int64
        Position of each scan's vertex in `vertices`, -1 for one without a place.
    edges : (u - 1, 2) int64
        Positions in `vertices` of the ends of each edge, the smaller first, in the order of time.
    times : (u - 1,) float64
        When the edge enters.
    is_between : (u - 1,) bool
        Whether it is between concepts, see `between_concepts`.
    stands_for : (u,) int64
        Number of scans at each vertex and at those that go with it.
    """

    scans: NDArray[np.int64]
    vertices: NDArray[np.int64]
    vertex_of_scan: NDArray[np.int64]
    edges: NDArray[np.int64]
    times: NDArray[np.float64]
    is_between: NDArray[np.bool_]
    stands_for: NDArray[np.int64]


def shown_scans(model: ShapeConceptModel) -> ShownScans:
    """All training scans of a model or, of more than `MOST_SHOWN`, a fair sample of those that could be used.

    Each concept has as many in it as it has in proportion, but 64 at least or all of fewer, and always its
    medoid. The sample follows from what the scans are like, and not from their order.
    """
    filtration, space = model.filtration_, model.filtration_.space_
    scans = np.arange(len(model.labels_))
    if len(scans) > MOST_SHOWN:
        scans = np.delete(scans, sorted(model.skipped_))
        drawn = _draws_of_scans(space, scans)
        drawn[np.searchsorted(scans, [concept.medoid for concept in model.concepts_])] = -1
        strata = np.where(space.vertices_[scans] >= 0, model.labels_[scans], -2)
        scans = scans[_smallest_draws(strata, drawn, MOST_SHOWN)]
    at = space.vertices_[scans]
    vertices = np.unique(at[at >= 0]).astype(np.int64)
    is_between = between_concepts(filtration)
    is_kept, position_of = _contracted(filtration, is_between, vertices)
    return ShownScans(
        scans,
        vertices,
        np.append(position_of, -1)[at],
        np.sort(position_of[filtration.edges_[is_kept]], axis=1),
        filtration.times_[is_kept],
        is_between[is_kept],
        np.bincount(position_of, space.multiplicities_, len(vertices)).astype(np.int64),
    )


def between_concepts(filtration: Filtration) -> NDArray[np.bool_]:
    """Which edges are between concepts, or lead to what is in none, (e,) bool; none if a time makes them."""
    if filtration.granularity_ is None:
        return np.zeros(len(filtration.edges_), bool)
    vertices = filtration.space_.vertices_
    labels = np.full(len(filtration.space_.multiplicities_), -1, np.int32)
    labels[vertices[vertices >= 0]] = filtration.labels_[vertices >= 0]
    first, second = labels[filtration.edges_].T
    return (first != second) | (first < 0)


def _draws_of_scans(space: TopologicalSpace, scans: NDArray[np.int64]) -> NDArray[np.int64]:
    """A random number for each scan that follows from its content, (k,) int64."""
    vertices = space.vertices_[scans]
    drawn = np.append(draws(space.rows_), 0)[vertices]
    # Scans that draw the same, as equal ones do, would be taken all or none: each after the first draws anew.
    order = np.lexsort([vertices, drawn])
    _, first, counts = np.unique(drawn[order], return_index=True, return_counts=True)
    turns = np.empty_like(drawn)
    turns[order] = np.arange(len(order)) - np.repeat(first, counts)
    return np.asarray(drawn ^ (turns * _GOLDEN_SECTION & 0xFFFFFFFF))


def _smallest_draws(strata: NDArray[np.integer], drawn: NDArray[np.int64], n_most: int) -> NDArray[np.int64]:
    """Positions, rising, of the smallest draws of each stratum: of a concept or, below 0, of others."""
    numbers, stratum, counts = np.unique(strata, return_inverse=True, return_counts=True)
    # Were they many, the least members of all concepts could be more than all that is to be shown.
    least_members = max(min(LEAST_MEMBERS, n_most // (2 * len(numbers))), 1)
    least = np.minimum(counts, np.where(numbers >= 0, least_members, 1))
    is_small, before = np.zeros(len(numbers), bool), None
    # What small concepts have beyond their share is taken from the others, of which more may then be small.
    while before is None or not np.array_equal(is_small, before):
        before = is_small
        left, among = n_most - least[is_small].sum(), counts[~is_small].sum()
        share = max(left, 0) / max(among, 1)
        is_small = share * counts < least
    kept = np.where(is_small, least, (share * counts + 1e-9).astype(np.int64))
    order = np.lexsort([drawn, stratum])
    rank = np.arange(len(order)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.sort(order[rank < kept[stratum[order]]])


def _contracted(
    filtration: Filtration, is_between: NDArray[np.bool_], vertices: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which edges of the tree are left, (e,) bool, and which of some vertices each one goes with, (v,) int64.

    Every vertex goes with the class that holds one of them which it joins first. So at any time two of them
    are in one class here if they are in one class of all; where vertices went with the fewest edges away,
    classes would meet too early, as what lies on the way between them would not take any time.
    """
    space = filtration.space_
    is_shown = np.zeros(len(space.multiplicities_), np.int64)
    is_shown[vertices] = 1
    # Concepts are complete before anything between them enters, as on the page.
    order = np.argsort(is_between, kind="stable")
    n_dying = annex(filtration.edges_[order], is_shown)[2]
    is_kept = np.empty(len(order), bool)
    is_kept[order] = n_dying > 0
    cells = Groups.connected_by(filtration.edges_[~is_kept], len(is_shown), space.vertices_).of_vertex
    position_of_cell = np.empty(len(vertices), np.int64)
    position_of_cell[cells[vertices]] = np.arange(len(vertices))
    return is_kept, position_of_cell[cells]
