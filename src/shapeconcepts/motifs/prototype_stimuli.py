"""Stimuli of single prototypes: equation 1 without its mean over a vertex's prototypes."""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass(frozen=True, eq=False)
class PrototypeField:
    """The prototypes of all hierarchies as sources of stimuli, each with a bandwidth of its own.

    A constellation q stimulates a prototype t by

        (1 + m) / (1 + n) * exp(-d(t, q)^2 / (2 * sigma_t * sigma_q)),

    where d is the squared Hellinger distance of their descriptions, sigma is `width` times the divergence d
    to the N-th nearest prototype of other objects (the last where there are fewer; 1e-5 at least), and m of
    the n hierarchies give both the same motif. Where they have nothing in common (d = 1, also without mass)
    there is no stimulus.

    Attributes
    ----------
    hierarchies : MotifHierarchies
    roots : (b, p) float32
        Square roots of the prototypes' histograms.
    scales : (p,) float64
        Divergence of each prototype to its N-th neighbour, at least 1e-5.
    n_neighbours : int
        N.
    width : float
    """

    hierarchies: MotifHierarchies
    roots: NDArray[np.float32]
    scales: NDArray[np.float64]
    n_neighbours: int
    width: float

    @classmethod
    def of(cls, hierarchies: MotifHierarchies, n_neighbours: int, width: float) -> PrototypeField:
        """The field of the prototypes of hierarchies."""
        roots = np.ascontiguousarray(np.sqrt(hierarchies.prototypes).T)
        scales = neighbourhood_scales(roots, hierarchies.prototype_objects, n_neighbours)
        return cls(hierarchies, roots, scales, n_neighbours, width)

    def stimuli(self, histogram: NDArray[np.float32], activated: NDArray[np.int32]) -> NDArray[np.float64]:
        """Stimulus of each prototype by one constellation of a new object, (p,) float64, 0 to 1.

        Stimuli under 1e-3 are 0.

        Parameters
        ----------
        histogram : (b,) float32
        activated : (n,) int32
            Vertex that the constellation activates in each hierarchy, -1 for none.
        """
        stimuli, buffer = np.empty((1, len(self.scales))), np.empty(len(self.scales))
        hellinger_divergences(np.sqrt(histogram)[None], self.roots, stimuli)
        prototype_stimuli(activated, *self._known, -1, *self._constants, stimuli[0], buffer)
        return stimuli[0]

    def row(self, activation: Activation) -> SparseRow:
        """Row of an object: the mean of its constellations' stimuli, each scaled to sum 1.

        A constellation that stimulates nothing counts as zeros, so a row sums to the share of an object's
        constellations that remind of anything.
        """
        histograms, activated, left_out = activation
        row = prototype_row(
            np.sqrt(histograms), self.roots, activated, *self._known, left_out, *self._constants
        )
        columns = np.flatnonzero(row)
        return columns.astype(np.int32), row[columns]

    @property
    def _known(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
        return self.hierarchies.prototype_vertices, self.hierarchies.prototype_objects, self.scales

    @property
    def _constants(self) -> tuple[int, float, float]:
        return self.n_neighbours, self.width, SMALLEST_KERNEL
