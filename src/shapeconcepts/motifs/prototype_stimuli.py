"""Stimuli of single prototypes: equation 1 without its mean over a vertex's prototypes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.prototype_kernels import (
    hellinger_divergences,
    neighbourhood_scales,
    prototype_row,
    prototype_stimuli,
)
from shapeconcepts.motifs.stimuli import Activation, SparseRow

SMALLEST_KERNEL = 1e-3
# With fewer, a bandwidth says more about which scans there happen to be than about their shapes.
LEAST_NEIGHBOURS = 25


class PrototypeRows(NamedTuple):
    """All that a row of stimuli is computed from; little enough to be sent to other machines.

    Attributes
    ----------
    roots, scales, n_neighbours, resolution, width
        As in `PrototypeField`.
    vertices : (c, n) int32
        Vertex of each column's prototype in each hierarchy.
    objects : (c,) int32
        Training object of each.
    """

    roots: NDArray[np.float32]
    vertices: NDArray[np.int32]
    objects: NDArray[np.int32]
    scales: NDArray[np.float64]
    n_neighbours: int
    resolution: float
    width: float

    def row(self, activation: Activation, by_strength: bool = False) -> SparseRow:
        """Row of an object: the mean of its constellations' stimuli, each scaled to sum 1.

        A constellation that stimulates nothing counts as zeros, so a row sums to the share of an object's
        constellations that remind of anything. With `by_strength`, each sums to its strongest stimulus: what
        is like nothing known says little.
        """
        histograms, activated, left_out = activation
        row = prototype_row(
            np.sqrt(histograms),
            self.roots,
            activated,
            self.vertices,
            self.objects,
            self.scales,
            left_out,
            self.n_neighbours,
            self.resolution,
            self.width,
            SMALLEST_KERNEL,
            by_strength,
        )
        columns = np.flatnonzero(row)
        return columns.astype(np.int32), row[columns]


@dataclass(frozen=True, eq=False)
class PrototypeField:
    """Prototypes of all hierarchies as sources of stimuli, each with a bandwidth of its own.

    A constellation q stimulates a prototype t by

        (1 + m) / (1 + n) * exp(-d(t, q)^2 / (2 * sigma_t * sigma_q)),

    where d is the squared Hellinger distance of their descriptions, sigma is `width` times the divergence d
    to the N-th nearest prototype of other objects (the last where there are fewer; `resolution` at least),
    and m of the n hierarchies give both the same motif. Where they have nothing in common (d = 1, also
    without mass) there is no stimulus.

    Attributes
    ----------
    hierarchies : MotifHierarchies
    columns : (c,) int64
        Prototype behind each column, rising.
    roots : (b, c) float32
        Square roots of their histograms.
    scales : (c,) float64
        Divergence of each to its N-th neighbour, at least `resolution`.
    n_neighbours : int
        N.
    resolution : float
    width : float
    """

    hierarchies: MotifHierarchies
    columns: NDArray[np.int64]
    roots: NDArray[np.float32]
    scales: NDArray[np.float64]
    n_neighbours: int
    resolution: float
    width: float

    @classmethod
    def of(
        cls,
        hierarchies: MotifHierarchies,
        columns: NDArray[np.int64],
        n_neighbours: int | None,
        resolution: float,
        width: float,
    ) -> PrototypeField:
        """The field of some prototypes of hierarchies; N is their square root, at least 25, if it is None."""
        if n_neighbours is None:
            n_neighbours = max(LEAST_NEIGHBOURS, round(len(columns) ** 0.5))
        roots = np.ascontiguousarray(np.sqrt(hierarchies.prototypes[columns]).T)
        scales = neighbourhood_scales(roots, hierarchies.prototype_objects[columns], n_neighbours, resolution)
        return cls(hierarchies, columns, roots, scales, n_neighbours, resolution, width)

    def stimuli(self, histogram: NDArray[np.float32], activated: NDArray[np.int32]) -> NDArray[np.float64]:
        """Stimulus of each column by one constellation of a new object, (c,) float64, 0 to 1.

        Stimuli under 1e-3 are 0.

        Parameters
        ----------
        histogram : (b,) float32
        activated : (n,) int32
            Vertex that the constellation activates in each hierarchy, -1 for none.
        """
        stimuli, buffer = np.empty((1, len(self.scales))), np.empty(len(self.scales))
        hellinger_divergences(np.sqrt(histogram)[None], self.roots, stimuli)
        rows = self.rows
        prototype_stimuli(
            activated,
            rows.vertices,
            rows.objects,
            self.scales,
            -1,
            self.n_neighbours,
            self.resolution,
            self.width,
            SMALLEST_KERNEL,
            stimuli[0],
            buffer,
        )
        return stimuli[0]

    @cached_property
    def rows(self) -> PrototypeRows:
        """What gives an object's row."""
        known = self.hierarchies
        return PrototypeRows(
            self.roots,
            known.prototype_vertices[self.columns],
            known.prototype_objects[self.columns],
            self.scales,
            self.n_neighbours,
            self.resolution,
            self.width,
        )
