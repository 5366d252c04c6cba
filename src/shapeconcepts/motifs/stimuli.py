"""Stimuli of motifs as sparse rows (paper: equation 1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.stimulus_kernels import mean_activations

SMALLEST_STIMULUS = 1e-6
# Of a row that sums to 1. Of hundreds of entries, a quarter are smaller, and together half a percent of it.
SMALLEST_SHARE = 1e-4

# Histograms (k, b) of an object's constellations, the vertices (k, n) that they activate, and the training
# object whose prototypes do not count, -1 for none.
Activation = tuple[NDArray[np.float32], NDArray[np.int32], int]
SparseRow = tuple[NDArray[np.int32], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class MotifField:
    """Motif vertices as sources of stimuli, each the mean over its prototypes.

    Attributes
    ----------
    hierarchies : MotifHierarchies
    columns : (c,) int64
        Vertex behind each column.
    bandwidth : float
        Sigma of equation 1, bits.
    """

    hierarchies: MotifHierarchies
    columns: NDArray[np.int64]
    bandwidth: float

    @classmethod
    def of(cls, hierarchies: MotifHierarchies, min_support: int, bandwidth: float) -> MotifField:
        """The field of the vertices that were seen in at least `min_support` training objects."""
        supported = np.flatnonzero(hierarchies.support >= min_support)
        words = hierarchies.words[supported]
        # Words stand at the end of their row: fewer words mean more -1 before them, so sorting the whole row
        # orders by number first, and nothing depends on when a vertex was seen.
        order = np.lexsort((*words.T[::-1], hierarchies.dictionary_levels[supported]))
        return cls(hierarchies, supported[order], bandwidth)

    @cached_property
    def _column_of(self) -> NDArray[np.int32]:
        column_of = np.full(self.hierarchies.n_vertices, -1, np.int32)
        column_of[self.columns] = np.arange(len(self.columns))
        return column_of

    def stimuli(self, activation: Activation) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Column (-1 for none) and stimulus of each of an object's constellations in each hierarchy.

        Returns
        -------
        columns : (k, n) int32
        stimuli : (k, n) float64
            Mean kernel over the prototypes; 0 where there is no column.
        """
        histograms, vertices, left_out = activation
        columns = np.where(vertices >= 0, self._column_of[vertices], -1) if len(self._column_of) else vertices
        stimuli = mean_activations(
            histograms,
            np.where(columns >= 0, vertices, -1).astype(np.int32),
            *self.hierarchies.prototypes_of,
            self.hierarchies.prototypes,
            self.hierarchies.prototype_entropies,
            self.hierarchies.prototype_objects,
            left_out,
            self.bandwidth,
        )
        return columns, stimuli

    @property
    def rows(self) -> MotifField:
        """What gives an object's row: itself."""
        return self

    def row(self, activation: Activation) -> SparseRow:
        """Row of an object: rising columns, and the largest stimulus of the constellations at each.

        Stimuli under 1e-6 are dropped.
        """
        columns, stimuli = self.stimuli(activation)
        fired = stimuli >= SMALLEST_STIMULUS
        distinct, position = np.unique(columns[fired], return_inverse=True)
        largest = np.zeros(len(distinct))
        np.maximum.at(largest, position, stimuli[fired])
        return distinct.astype(np.int32), largest


def compact_row(row_of: Callable[[Activation], SparseRow], activation: Activation) -> SparseRow:
    """Row without entries under 1e-4, and what is left in half precision: of a hundred thousand, they fit."""
    columns, stimuli = row_of(activation)
    kept = stimuli >= SMALLEST_SHARE
    return columns[kept], stimuli[kept].astype(np.float16).astype(np.float64)


def sparse_rows(rows: Sequence[SparseRow], n_columns: int) -> csr_matrix:
    """Stack rows to a matrix (n, n_columns)."""
    counts = [len(columns) for columns, _ in rows]
    indptr = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    columns = np.concatenate([np.empty(0, np.int32), *(columns for columns, _ in rows)])
    stimuli = np.concatenate([np.empty(0), *(stimuli for _, stimuli in rows)])
    return csr_matrix((stimuli, columns, indptr), shape=(len(rows), n_columns))


def with_empty_rows(rows: csr_matrix, objects: Sequence[object | None]) -> csr_matrix:
    """Rows of the objects that are there, and an empty one for each that is None or False."""
    lengths = np.zeros(len(objects), np.int64)
    lengths[[i for i, one in enumerate(objects) if one]] = np.diff(rows.indptr)
    indptr = np.concatenate([[0], np.cumsum(lengths)])
    return csr_matrix((rows.data, rows.indices, indptr), shape=(len(objects), rows.shape[1]))
