"""Kernels of the stimuli of single prototypes, with bandwidths that follow the prototypes' neighbourhoods."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

# Divergences closer than this are the rounding of equal histograms.
SMALLEST_SCALE = 1e-5


@njit(cache=True, nogil=True)
def hellinger_divergences(
    root: NDArray[np.float32], prototype_roots: NDArray[np.float32], divergences: NDArray[np.float64]
) -> None:
    """Squared Hellinger distance of a histogram to every prototype, 1 minus the sum of sqrt(p q).

    Parameters
    ----------
    root : (b,) float32
        Square roots of the histogram.
    prototype_roots : (b, p) float32
        Square roots of the prototypes, bin by bin, so that the inner loop compiles to vector instructions.
    divergences : (p,) float64, output
        0 (same) to 1 (nothing in common).
    """
    n = prototype_roots.shape[1]
    for t in range(n):
        divergences[t] = 1.0
    for b in range(len(root)):
        if root[b] > 0.0:
            share = np.float64(root[b])
            for t in range(n):
                divergences[t] -= share * np.float64(prototype_roots[b, t])
    for t in range(n):
        divergences[t] = max(divergences[t], 0.0)


@njit(cache=True, nogil=True)
def neighbourhood_scale(
    divergences: NDArray[np.float64],
    objects: NDArray[np.int32],
    left_out: int,
    n_neighbours: int,
    others: NDArray[np.float64],
) -> float:
    """Divergence to the n-th nearest prototype of other objects, or to the last where there are fewer.

    `others` is a buffer of the length of `divergences`. 0 where there is no other object.
    """
    n = 0
    for t in range(len(divergences)):
        if objects[t] != left_out:
            others[n] = divergences[t]
            n += 1
    if n == 0:
        return 0.0
    k = min(n_neighbours, n) - 1
    return max(np.partition(others[:n], k)[k], SMALLEST_SCALE)


@njit(cache=True, nogil=True)
def neighbourhood_scales(
    prototype_roots: NDArray[np.float32], objects: NDArray[np.int32], n_neighbours: int
) -> NDArray[np.float64]:
    """`neighbourhood_scale` of every prototype, (p,) float64."""
    n = prototype_roots.shape[1]
    scales = np.empty(n)
    divergences, others = np.empty(n), np.empty(n)
    for t in range(n):
        hellinger_divergences(prototype_roots[:, t].copy(), prototype_roots, divergences)
        scales[t] = neighbourhood_scale(divergences, objects, objects[t], n_neighbours, others)
    return scales


@njit(cache=True, nogil=True)
def prototype_stimuli(
    roots: NDArray[np.float32],
    activated: NDArray[np.int32],
    prototype_roots: NDArray[np.float32],
    prototype_vertices: NDArray[np.int32],
    prototype_objects: NDArray[np.int32],
    scales: NDArray[np.float64],
    left_out: int,
    n_neighbours: int,
    width: float,
    smallest: float,
) -> NDArray[np.float64]:
    """Stimulus of each prototype by each constellation of an object.

    Parameters
    ----------
    roots : (k, b) float32
        Square roots of the constellations' histograms.
    activated : (k, n) int32
        Vertex that each constellation activates in each hierarchy, -1 for none.
    prototype_roots : (b, p) float32
    prototype_vertices : (p, n) int32
    prototype_objects : (p,) int32
    scales : (p,) float64
        `neighbourhood_scales` of the prototypes.
    left_out : int
        Training object whose prototypes do not count, -1 for none.
    n_neighbours : int
    width : float
        Bandwidth in parts of the scales.
    smallest : float
        Stimuli under this are 0.

    Returns
    -------
    (k, p) float64
    """
    n_constellations, n_levels = activated.shape
    n = prototype_roots.shape[1]
    stimuli = np.zeros((n_constellations, n))
    divergences, others = np.empty(n), np.empty(n)
    for q in range(n_constellations):
        hellinger_divergences(roots[q], prototype_roots, divergences)
        scale = neighbourhood_scale(divergences, prototype_objects, left_out, n_neighbours, others)
        # Beyond this the kernel is under `smallest` whatever the words.
        reach = -2.0 * math.log(smallest) * width * width * scale
        for t in range(n):
            d = divergences[t]
            if prototype_objects[t] == left_out or d * d > reach * scales[t]:
                continue
            n_shared = 1
            for level in range(n_levels):
                if activated[q, level] == prototype_vertices[t, level]:
                    n_shared += 1
            kernel = math.exp(-0.5 * d * d / (width * width * scale * scales[t]))
            stimulus = kernel * n_shared / (n_levels + 1)
            if stimulus >= smallest:
                stimuli[q, t] = stimulus
    return stimuli
