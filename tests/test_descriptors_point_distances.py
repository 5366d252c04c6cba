"""Distances of points in metres, against SciPy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from shapeconcepts.descriptors import PointDistances
from shapeconcepts.descriptors.point_distances import BINS_PER_DOUBLING, N_BINS, SMALLEST_DISTANCE
from test_descriptors import as_segmented

UP = np.array([0.0, 0.0, 1.0])


def spread_out(seed: int, extent: float) -> np.ndarray:
    """Points so far apart that none shares a cell with another."""
    rng = np.random.default_rng(seed)
    corners = np.stack(np.meshgrid(*[np.arange(3)] * 3), axis=-1).reshape(-1, 3)
    points = corners + rng.uniform(-0.1, 0.1, (27, 3))
    return extent * points / 2


def slow_histogram(points: np.ndarray) -> np.ndarray:
    histogram = np.zeros(N_BINS)
    for distance in pdist(points):
        place = np.clip(BINS_PER_DOUBLING * np.log2(distance / SMALLEST_DISTANCE), 0, N_BINS - 1)
        below = min(int(place), N_BINS - 2)
        histogram[below] += 1 - (place - below)
        histogram[below + 1] += place - below
    return histogram / histogram.sum()


@given(st.integers(0, 10**6), st.floats(1e-3, 5.0))
@settings(deadline=None, max_examples=50)
def test_against_a_slow_version(seed, extent):
    points = spread_out(seed, extent)
    labels = np.random.default_rng(seed).permutation(np.arange(27) % 2)
    description = PointDistances().describe(as_segmented(points, np.tile(UP, (27, 1)), labels))
    for mask, chosen in ((1, labels == 0), (2, labels == 1), (3, labels >= 0)):
        np.testing.assert_allclose(
            description.histograms([mask])[0], slow_histogram(points[chosen]), atol=1e-9
        )


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_twice_the_size_is_two_places_on(factor):
    points = spread_out(1, 0.04)
    one, other = (
        PointDistances().describe(as_segmented(scale * points, np.tile(UP, (27, 1)), np.zeros(27))).whole()
        for scale in (1.0, factor)
    )
    moved = BINS_PER_DOUBLING if factor > 1 else -BINS_PER_DOUBLING
    np.testing.assert_allclose(np.roll(one, moved), other, atol=1e-9)


def test_what_is_hidden_does_not_change_distances_within_the_rest():
    points, labels = spread_out(2, 0.1), np.repeat([0, 1, 2], 9)
    whole, rest = (
        PointDistances().describe(
            as_segmented(points[kept], np.tile(UP, (int(kept.sum()), 1)), labels[kept], n_segments=3)
        )
        for kept in (labels >= 0, labels > 0)
    )
    np.testing.assert_allclose(rest.histograms([0b110]), whole.histograms([0b110]), atol=1e-9)
