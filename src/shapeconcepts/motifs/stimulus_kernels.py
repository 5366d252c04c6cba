"""Kernels of the stimuli: Jensen-Shannon divergences to the prototypes of activated motif vertices."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

# Kernels are summed as integers: the sum does not depend on the order in which the prototypes were seen.
ONE = 1 << 40


@kernel
def negative_entropies(histograms: NDArray[np.float32]) -> NDArray[np.float64]:
    """Sum of p log2 p over each row, and 1 for a row without mass.

    Parameters
    ----------
    histograms : (m, b) float32
        Rows that sum to 1 or to 0.
    """
    sums = np.empty(len(histograms))
    for i in range(len(histograms)):
        total, mass = 0.0, 0.0
        for b in range(histograms.shape[1]):
            # Not float(): numba leaves a float32 as it is, and log2 at single precision costs 1e-7 of JSD.
            p = np.float64(histograms[i, b])
            if p > 0.0:
                total += p * math.log2(p)
                mass += p
        sums[i] = total if mass > 0.0 else 1.0
    return sums


@kernel
def jensen_shannon(
    p: NDArray[np.float32], q: NDArray[np.float32], p_entropy: float, q_entropy: float
) -> float:
    """Jensen-Shannon divergence in bits of two histograms with their `negative_entropies`.

    Between 0 and 1; 1 where one of them has no mass.
    """
    mixed = 0.0
    for b in range(len(p)):
        m = 0.5 * (np.float64(p[b]) + np.float64(q[b]))
        if m > 0.0:
            mixed += m * math.log2(m)
    return min(max(0.5 * (p_entropy + q_entropy) - mixed, 0.0), 1.0)


@kernel
def divergences_to(
    histogram: NDArray[np.float32],
    entropy: float,
    which: NDArray[np.int32],
    prototypes: NDArray[np.float32],
    prototype_entropies: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Jensen-Shannon divergence in bits of a histogram to some of the prototypes, (k,) float64."""
    divergences = np.empty(len(which))
    for k in range(len(which)):
        t = which[k]
        divergences[k] = jensen_shannon(histogram, prototypes[t], entropy, prototype_entropies[t])
    return divergences


@kernel
def mean_activations(
    histograms: NDArray[np.float32],
    activated: NDArray[np.int32],
    vertex_starts: NDArray[np.int64],
    vertex_prototypes: NDArray[np.int32],
    prototypes: NDArray[np.float32],
    prototype_entropies: NDArray[np.float64],
    prototype_objects: NDArray[np.int32],
    left_out: int,
    bandwidth: float,
) -> NDArray[np.float64]:
    """Stimulus of each constellation at the vertices that it activates (paper: equation 1).

    Parameters
    ----------
    histograms : (k, b) float32
        Descriptions of constellations, rows that sum to 1 or to 0. A row without mass is at divergence 1 from
        every other.
    activated : (k, n) int32
        Vertices that each constellation activates, -1 for none.
    vertex_starts : (v + 1,) int64
    vertex_prototypes : (vertex_starts[v],) int32
        The prototypes of vertex v are ``vertex_prototypes[vertex_starts[v]:vertex_starts[v + 1]]``.
    prototypes : (p, b) float32
    prototype_entropies : (p,) float64
        Their `negative_entropies`.
    prototype_objects : (p,) int32
        Training object of each prototype.
    left_out : int
        Training object whose prototypes do not count, -1 for none.
    bandwidth : float
        Sigma of equation 1, in bits of Jensen-Shannon divergence.

    Returns
    -------
    (k, n) float64
        Mean kernel over the prototypes of the vertex; 0 without any.
    """
    stimuli = np.zeros(activated.shape)
    entropies = negative_entropies(histograms)
    # The same prototype lies behind vertices of several dictionary levels: its kernel is computed once.
    kernel = np.empty(len(prototypes), np.int64)
    computed_for = np.full(len(prototypes), -1, np.int64)
    for q in range(len(histograms)):
        for column in range(activated.shape[1]):
            vertex = activated[q, column]
            if vertex < 0:
                continue
            total, count = 0, 0
            for k in range(vertex_starts[vertex], vertex_starts[vertex + 1]):
                t = vertex_prototypes[k]
                if prototype_objects[t] == left_out:
                    continue
                if computed_for[t] != q:
                    divergence = jensen_shannon(
                        histograms[q], prototypes[t], entropies[q], prototype_entropies[t]
                    )
                    kernel[t] = round(ONE * math.exp(-0.5 * (divergence / bandwidth) ** 2))
                    computed_for[t] = q
                total += kernel[t]
                count += 1
            if count > 0:
                stimuli[q, column] = total / (ONE * count)
    return stimuli
