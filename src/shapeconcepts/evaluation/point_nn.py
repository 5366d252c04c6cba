"""Point-NN: features of a whole object by a network without anything to learn."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree
from scipy.special import erf

from shapeconcepts.geometry.canonical_frame import canonical_ball
from shapeconcepts.geometry.points import checked_points

# As the authors have it for classification.
N_POINTS = 1024
N_STAGES = 4
WIDTH = 72
N_NEIGHBOURS = 90
_ALPHA, _BETA = 1000.0, 100.0
# Keeps deviations of 0 from dividing.
_SMALLEST_DEVIATION = 1e-5
# Centres at a time: what they need fits into the cache of a processor.
_AT_ONCE = 16


def point_nn(points: ArrayLike) -> NDArray[np.float64]:
    """Features of an object by Point-NN (Zhang et al., CVPR 2023: "Parameter is Not All You Need").

    Each of 1024 points, farthest from each other, gets sines and cosines of its position. Four times, half
    of the points collect what their 90 nearest hold, weighed by sines and cosines of where these lie; what
    is left is pooled over the whole object. Parameters are those that the authors classify with.

    The paper compares features by their cosine. Here they come as the squares of the features at length 1,
    so that Hellinger's affinity of two rows is this cosine: groupings of histograms group them as meant.
    Features below 0, which are small and few, count as 0.

    An object is laid along its principal axes and scaled to a radius of 1 before, as the features depend on
    the pose. Its deviations are its own, where the authors take those of a batch of 16.

    Parameters
    ----------
    points : (m, 3) array-like
        Finite coordinates, in any unit and order.

    Returns
    -------
    (1152,) float64
        Sums to 1; all zero without points.

    Raises
    ------
    ValueError
        If the shape is not (m, 3) or coordinates are not finite.
    """
    cloud = checked_points(points)
    if not len(cloud):
        return np.zeros(WIDTH << N_STAGES)
    laid = canonical_ball(cloud, 1.0).astype(np.float32)
    features = np.maximum(_features(laid).astype(np.float64), 0) ** 2
    return features / features.sum()


def _features(points: NDArray[np.float32]) -> NDArray[np.float32]:
    points = points[farthest_points(points, N_POINTS)]
    features = position_encoding(points, WIDTH)
    for _ in range(N_STAGES):
        centres = farthest_points(points, max(1, len(points) // 2))
        features = _aggregated(points, features, centres)
        points = points[centres]
    return features.max(axis=0) + features.mean(axis=0)


def farthest_points(points: NDArray[np.float32], n: int) -> NDArray[np.int64]:
    """Indices of up to n points, each the farthest from those before it; the first from the origin."""
    chosen = np.empty(min(n, len(points)), np.int64)
    distances = np.full(len(points), np.inf, np.float32)
    farthest = int((points**2).sum(axis=1).argmax())
    for number in range(len(chosen)):
        chosen[number] = farthest
        distances = np.minimum(distances, ((points - points[farthest]) ** 2).sum(axis=1))
        # Points at the same place are taken one after the other, once nothing else is left.
        distances[farthest] = -1
        farthest = int(distances.argmax())
    return chosen


def position_encoding(positions: NDArray[np.float32], width: int) -> NDArray[np.float32]:
    """Sines and cosines of positions at `width` / 6 wavelengths for each axis; (..., 3) to (..., width)."""
    n_waves = width // 6
    frequencies = (_BETA / _ALPHA ** (np.arange(n_waves) / n_waves)).astype(np.float32)
    phases = positions[..., None] * frequencies
    return np.stack([np.sin(phases), np.cos(phases)], axis=-1).reshape(*positions.shape[:-1], width)


def _aggregated(
    points: NDArray[np.float32], features: NDArray[np.float32], centres: NDArray[np.int64]
) -> NDArray[np.float32]:
    """What each centre collects from its nearest points, twice as wide as before."""
    k = min(N_NEIGHBOURS, len(points))
    nearest = KDTree(points).query(points[centres], np.arange(1, k + 1))[1]
    spread = [_deviation(values[nearest] - values[centres, None]) for values in (points, features)]
    width = features.shape[1]
    pooled = np.empty((len(centres), 2 * width), np.float32)
    for start in range(0, len(centres), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        near, own = nearest[rows], centres[rows, None]
        weights = position_encoding((points[near] - points[own]) / spread[0], 2 * width)
        collected = weights.copy()
        collected[..., :width] += (features[near] - features[own]) / spread[1]
        collected[..., width:] += features[own]
        collected *= weights
        pooled[rows] = collected.max(axis=1) + collected.mean(axis=1)
    # Gaussian error linear units. Batch normalisation that has learned nothing changes nothing.
    return pooled * (0.5 + 0.5 * erf(pooled / np.float32(np.sqrt(2))))


def _deviation(differences: NDArray[np.float32]) -> np.float32:
    n = differences.size
    return np.float32(differences.std(dtype=np.float64, ddof=1 if n > 1 else 0) + _SMALLEST_DEVIATION)
