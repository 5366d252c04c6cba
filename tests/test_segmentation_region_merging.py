"""Absorbing small segments, and the edges between segments."""

import tracemalloc

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.segmentation.region_merging import (
    MIN_BORDER,
    MIN_MEAN_SHARE,
    absorb_small,
    border_lengths,
)

seeds = st.integers(0, 2**32 - 1)


def mosaic(seed: int, n_regions: int, n: int = 120):
    """Random points in a plane, labelled by the nearest of some centres, a few not at all."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (n, 3)) * [1, 1, 0]
    centres = rng.uniform(0, 1, (n_regions, 3)) * [1, 1, 0]
    nearest = np.linalg.norm(points[:, None] - centres, axis=-1).argmin(axis=1)
    nearest[rng.random(n) < 0.1] = -1
    used = np.unique(nearest[nearest >= 0])
    labels = np.where(nearest >= 0, np.searchsorted(used, nearest), -1).astype(np.int32)
    return radius_neighbours(points, rng.uniform(0.05, 0.2)), labels, rng.integers(1, 9, n)


def pairs_of(adjacency):
    return [
        (i, int(j))
        for i in range(len(adjacency.indptr) - 1)
        for j in adjacency.indices[adjacency.indptr[i] : adjacency.indptr[i + 1]]
    ]


def border(pairs, labels, a: int, b: int) -> int:
    return sum(labels[i] == a and labels[j] == b for i, j in pairs)


def slow_absorb(pairs, labels, weights, min_share, min_voxels, max_segments):
    """Sets of voxels, merged one at a time; every border counted anew."""
    labels = labels.tolist()

    def is_small(mass: int, size: int) -> bool:
        mean_share = (mass / sum(weights) * size / len(labels)) ** 0.5
        return mass / sum(weights) < min_share and mean_share < MIN_MEAN_SHARE

    first_name = sorted(set(labels) - {-1})
    while len(set(labels) - {-1}) > 1:
        alive = sorted(set(labels) - {-1})
        size = {s: labels.count(s) for s in alive}
        mass = {s: sum(w for w, label in zip(weights, labels, strict=True) if label == s) for s in alive}
        small = [s for s in alive if size[s] < min_voxels or is_small(mass[s], size[s])]
        if not small and len(alive) <= max_segments:
            break
        smallest = min(small or alive, key=lambda s: (size[s], -s))
        lengths = {s: border(pairs, labels, smallest, s) for s in alive if s != smallest}
        best = max(lengths, key=lambda s: (lengths[s], -s))
        heir = best if lengths[best] > 0 else -1
        labels = [heir if label == smallest else label for label in labels]
    alive = sorted(set(labels) - {-1}, key=lambda s: (-labels.count(s), first_name.index(s)))
    return [alive.index(s) if s >= 0 else -1 for s in labels]


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 12), st.floats(0, 0.4), st.integers(0, 30), st.integers(1, 12))
def test_absorbing_agrees_with_counting_anew(seed, n_regions, min_share, min_voxels, max_segments):
    adjacency, labels, weights = mosaic(seed, n_regions)
    limits = min_share, min_voxels, max_segments
    absorbed, edges = absorb_small(adjacency, labels, weights, *limits)
    assert absorbed.dtype == np.int32 and edges.dtype == np.int32
    pairs = pairs_of(adjacency)
    assert absorbed.tolist() == slow_absorb(pairs, labels, weights.tolist(), *limits)
    n = absorbed.max() + 1
    long_enough = [
        [a, b] for a in range(n) for b in range(a + 1, n) if border(pairs, absorbed, a, b) >= MIN_BORDER
    ]
    assert edges.tolist() == long_enough and edges.shape[1] == 2
    sizes = np.bincount(absorbed[absorbed >= 0])
    assert 1 <= len(sizes) <= max_segments
    assert (np.diff(sizes) <= 0).all() and sizes.min() > 0


def strip(*lengths: int):
    """Segments of so many voxels in a row, a voxel apart."""
    labels = np.repeat(np.arange(len(lengths)), lengths).astype(np.int32)
    x = np.arange(len(labels), dtype=float)
    return np.column_stack([x, 0 * x, 0 * x]), labels


def test_small_segment_goes_to_the_longer_border_not_the_larger_segment():
    x, y = (part.ravel().astype(float) for part in np.meshgrid(np.arange(20), np.arange(10)))
    labels = np.where(x < 10, 0, 1).astype(np.int32)
    labels[(x >= 9) & (x < 10) & (y >= 1)] = 2  # touches 0 along two sides, 1 along one
    adjacency = radius_neighbours(np.column_stack([x, y, 0 * x]), 1.1)
    absorbed, _ = absorb_small(adjacency, labels, np.ones(200, int), 0.1, 1, 12)
    np.testing.assert_array_equal(absorbed == absorbed[0], x < 10)


def test_voxels_may_be_many_but_points_few():
    points, labels = strip(50, 50)
    weights = np.where(labels == 0, 1000, 1)
    adjacency = radius_neighbours(points, 1.1)
    assert absorb_small(adjacency, labels, weights, 0.05, 1, 12)[0].max() == 0
    assert absorb_small(adjacency, labels, weights, 0.0005, 1, 12)[0].max() == 1


def test_few_points_on_much_surface_are_kept():
    points, labels = strip(80, 20)
    adjacency = radius_neighbours(points, 1.1)
    # 20 % of the voxels, and 2 % or 1 % of the points.
    for dense, kept in ((12, True), (25, False)):
        weights = np.where(labels == 0, dense, 1)
        assert weights[labels == 1].sum() < 0.04 * weights.sum()
        assert (absorb_small(adjacency, labels, weights, 0.04, 1, 12)[0].max() == 1) == kept


def test_last_segment_stays_however_small():
    points, labels = strip(3)
    adjacency = radius_neighbours(points, 1.1)
    assert absorb_small(adjacency, labels, np.ones(3, int), 0.5, 100, 1)[0].tolist() == [0, 0, 0]


def test_segment_without_neighbour_is_dropped():
    points, labels = strip(60, 40, 5)
    points[100:, 0] += 10.0
    absorbed, _ = absorb_small(radius_neighbours(points, 1.1), labels, np.ones(105, int), 0.1, 1, 12)
    np.testing.assert_array_equal(absorbed, np.repeat([0, 1, -1], [60, 40, 5]))


def test_no_segments_at_all():
    points, labels = strip(4)
    adjacency = radius_neighbours(points, 1.1)
    none = np.full_like(labels, -1)
    segments, edges = absorb_small(adjacency, none, np.ones(4, int), 0.1, 1, 12)
    assert segments.tolist() == [-1] * 4
    assert edges.shape == (0, 2)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 9))
def test_borders_agree_with_counting(seed, n_regions):
    adjacency, labels, _ = mosaic(seed, n_regions)
    pairs, n = pairs_of(adjacency), labels.max() + 1
    expected = [
        {b: length for b in range(n) if b != a and (length := border(pairs, labels, a, b))} for a in range(n)
    ]
    assert border_lengths(adjacency, labels) == expected


def test_a_segment_for_each_of_many_voxels_takes_no_square_of_memory():
    n = 20_000
    adjacency = radius_neighbours(strip(n)[0], 1.1)
    tracemalloc.start()
    absorbed, _ = absorb_small(adjacency, np.arange(n, dtype=np.int32), np.ones(n, int), 0.04, 25, 12)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert 1 <= absorbed.max() + 1 <= 12
    assert peak < 1000 * n
