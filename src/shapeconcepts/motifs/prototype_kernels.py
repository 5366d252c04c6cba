"""Kernels of the stimuli of single prototypes, with bandwidths that follow the prototypes' neighbourhoods."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel
from shapeconcepts.motifs.stimulus_kernels import ONE

TILE = 512
AT_ONCE = 16


# Fused with the sum or not, a product of two single precision numbers is exact.
@kernel(fastmath={"contract"})
def hellinger_divergences(
    roots: NDArray[np.float32], prototype_roots: NDArray[np.float32], divergences: NDArray[np.float64]
) -> None:
    """Squared Hellinger distance of histograms to every prototype, 1 minus the sum of sqrt(p q).

    Parameters
    ----------
    roots : (k, b) float32
        Square roots of the histograms.
    prototype_roots : (b, p) float32
        Square roots of the prototypes, bin by bin, so that the inner loop compiles to vector instructions.
    divergences : (k, p) float64, output
        0 (same) to 1 (nothing in common). It does not depend on the other histograms, to the last bit.
    """
    n_bins, n = prototype_roots.shape
    in_fours = n_bins - n_bins % 4
    # Prototypes are read from memory once for all histograms: those of a tile stay in the cache.
    for first in range(0, n, TILE):
        end = min(first + TILE, n)
        for q in range(len(roots)):
            for t in range(first, end):
                divergences[q, t] = 1.0
            # Four bins in one pass load and store each divergence once; the sum is that of one bin after the
            # other.
            for b in range(0, in_fours, 4):
                r0, r1 = np.float64(roots[q, b]), np.float64(roots[q, b + 1])
                r2, r3 = np.float64(roots[q, b + 2]), np.float64(roots[q, b + 3])
                for t in range(np.uint64(first), np.uint64(end)):
                    d = divergences[q, t] - r0 * np.float64(prototype_roots[b, t])
                    d -= r1 * np.float64(prototype_roots[b + 1, t])
                    d -= r2 * np.float64(prototype_roots[b + 2, t])
                    divergences[q, t] = d - r3 * np.float64(prototype_roots[b + 3, t])
            for b in range(in_fours, n_bins):
                r0 = np.float64(roots[q, b])
                for t in range(np.uint64(first), np.uint64(end)):
                    divergences[q, t] -= r0 * np.float64(prototype_roots[b, t])
            for t in range(first, end):
                divergences[q, t] = max(divergences[q, t], 0.0)


@kernel
def neighbourhood_scale(
    divergences: NDArray[np.float64],
    objects: NDArray[np.int32],
    left_out: int,
    n_neighbours: int,
    resolution: float,
    others: NDArray[np.float64],
) -> float:
    """Divergence to the n-th nearest prototype of other objects, or to the last where there are fewer.

    At least `resolution`, and that where there is no other object. `others` is a buffer as long as
    `divergences`.
    """
    n = 0
    for t in range(len(divergences)):
        if objects[t] != left_out:
            others[n] = divergences[t]
            n += 1
    if n == 0:
        return resolution
    k = min(n_neighbours, n) - 1
    return max(np.partition(others[:n], k)[k], resolution)


@kernel
def neighbourhood_scales(
    prototype_roots: NDArray[np.float32], objects: NDArray[np.int32], n_neighbours: int, resolution: float
) -> NDArray[np.float64]:
    """`neighbourhood_scale` of every prototype, (p,) float64."""
    n = prototype_roots.shape[1]
    scales = np.empty(n)
    divergences, others = np.empty((AT_ONCE, n)), np.empty(n)
    for first in range(0, n, AT_ONCE):
        end = min(first + AT_ONCE, n)
        hellinger_divergences(prototype_roots[:, first:end].T.copy(), prototype_roots, divergences)
        for t in range(first, end):
            scales[t] = neighbourhood_scale(
                divergences[t - first], objects, objects[t], n_neighbours, resolution, others
            )
    return scales


@kernel
def prototype_stimuli(
    activated: NDArray[np.int32],
    prototype_vertices: NDArray[np.int32],
    prototype_objects: NDArray[np.int32],
    scales: NDArray[np.float64],
    left_out: int,
    n_neighbours: int,
    resolution: float,
    width: float,
    smallest: float,
    stimuli: NDArray[np.float64],
    others: NDArray[np.float64],
) -> None:
    """Stimulus of each prototype by one constellation of an object.

    Parameters
    ----------
    activated : (n,) int32
        Vertex that it activates in each hierarchy, -1 for none.
    prototype_vertices : (p, n) int32
    prototype_objects : (p,) int32
    scales : (p,) float64
        `neighbourhood_scales` of the prototypes.
    left_out : int
        Training object whose prototypes do not count, -1 for none.
    n_neighbours : int
    resolution : float
        Smallest scale.
    width : float
        Bandwidth in parts of the scales.
    smallest : float
        Stimuli under this are 0.
    stimuli : (p,) float64, input and output
        The constellation's `hellinger_divergences`; overwritten with stimuli, 0 to 1.
    others : (p,) float64
        Buffer.
    """
    n_levels = len(activated)
    scale = neighbourhood_scale(stimuli, prototype_objects, left_out, n_neighbours, resolution, others)
    # Beyond this the kernel is under `smallest` whatever the words.
    reach = -2.0 * math.log(smallest) * width * width * scale
    for t in range(len(stimuli)):
        d = stimuli[t]
        stimuli[t] = 0.0
        if prototype_objects[t] == left_out or d >= 1.0 or d * d > reach * scales[t]:
            continue
        n_shared = 1
        for level in range(n_levels):
            if activated[level] == prototype_vertices[t, level]:
                n_shared += 1
        kernel = math.exp(-0.5 * d * d / (width * width * scale * scales[t]))
        stimulus = kernel * n_shared / (n_levels + 1)
        if stimulus >= smallest:
            stimuli[t] = stimulus


@kernel
def prototype_row(
    roots: NDArray[np.float32],
    prototype_roots: NDArray[np.float32],
    activated: NDArray[np.int32],
    prototype_vertices: NDArray[np.int32],
    prototype_objects: NDArray[np.int32],
    scales: NDArray[np.float64],
    left_out: int,
    n_neighbours: int,
    resolution: float,
    width: float,
    smallest: float,
    by_strength: bool,
) -> NDArray[np.float64]:
    """Mean over an object's constellations of their `prototype_stimuli`, each scaled to sum 1, (p,) float64.

    Parameters are those of `hellinger_divergences` and `prototype_stimuli`, with `activated` (k, n) of all
    constellations. One that stimulates nothing counts as zeros. With `by_strength`, each is scaled to sum to
    its strongest stimulus instead.
    """
    n_constellations, n = len(roots), prototype_roots.shape[1]
    row = np.zeros(n)
    batch, others = np.empty((AT_ONCE, n)), np.empty(n)
    for first in range(0, n_constellations, AT_ONCE):
        end = min(first + AT_ONCE, n_constellations)
        hellinger_divergences(roots[first:end], prototype_roots, batch)
        for q in range(first, end):
            stimuli = batch[q - first]
            prototype_stimuli(
                activated[q],
                prototype_vertices,
                prototype_objects,
                scales,
                left_out,
                n_neighbours,
                resolution,
                width,
                smallest,
                stimuli,
                others,
            )
            # As whole numbers: the order in which the prototypes were seen does not matter to their sum, and
            # none exceeds it.
            total, strongest = 0, 0.0
            for t in range(n):
                if stimuli[t] > 0.0:
                    strongest = max(strongest, stimuli[t])
                    stimuli[t] = round(ONE * stimuli[t])
                    total += int(stimuli[t])
            if total > 0:
                scale = strongest if by_strength else 1.0
                for t in range(n):
                    row[t] += scale * (stimuli[t] / total)
    return row / n_constellations
