"""Stimuli of objects as sparse rows (paper: equation 1)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.stimulus_kernels import mean_activations

SMALLEST_STIMULUS = 1e-6

# Histograms (k, b) of an object's constellations, the vertices (k, n) that they activate, and the training
# object whose prototypes do not count, -1 for none.
Activation = tuple[NDArray[np.float32], NDArray[np.int32], int]
SparseRow = tuple[NDArray[np.int32], NDArray[np.float64]]


def constellation_stimuli(
    activation: Activation,
    hierarchies: MotifHierarchies,
    column_of: NDArray[np.int32],
    bandwidth: float,
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Column (-1 for none) and stimulus of each of an object's constellations in each hierarchy.

    Parameters
    ----------
    activation : Activation
    hierarchies : MotifHierarchies
    column_of : (v,) int32
        Column of each vertex, -1 for none.
    bandwidth : float

    Returns
    -------
    columns : (k, n) int32
    stimuli : (k, n) float64
        Mean kernel over the prototypes; 0 where there is no column.
    """
    histograms, vertices, left_out = activation
    columns = np.where(vertices >= 0, column_of[vertices], -1) if len(column_of) else vertices
    stimuli = mean_activations(
        histograms,
        np.where(columns >= 0, vertices, -1).astype(np.int32),
        *hierarchies.prototypes_of,
        hierarchies.prototypes,
        hierarchies.prototype_entropies,
        hierarchies.prototype_objects,
        left_out,
        bandwidth,
    )
    return columns, stimuli


def stimuli_rows(
    activations: Sequence[Activation],
    hierarchies: MotifHierarchies,
    column_of: NDArray[np.int32],
    bandwidth: float,
) -> list[SparseRow]:
    """Row of each object: rising columns, and the largest stimulus of the constellations at each.

    Stimuli under 1e-6 are dropped.
    """
    rows = []
    for activation in activations:
        columns, stimuli = constellation_stimuli(activation, hierarchies, column_of, bandwidth)
        fired = stimuli >= SMALLEST_STIMULUS
        distinct, position = np.unique(columns[fired], return_inverse=True)
        largest = np.zeros(len(distinct))
        np.maximum.at(largest, position, stimuli[fired])
        rows.append((distinct.astype(np.int32), largest))
    return rows


def sparse_rows(rows: Sequence[SparseRow], n_columns: int) -> csr_matrix:
    """Stack rows to a matrix (n, n_columns)."""
    counts = [len(columns) for columns, _ in rows]
    indptr = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    columns = np.concatenate([np.empty(0, np.int32), *(columns for columns, _ in rows)])
    stimuli = np.concatenate([np.empty(0), *(stimuli for _, stimuli in rows)])
    return csr_matrix((stimuli, columns, indptr), shape=(len(rows), n_columns))
