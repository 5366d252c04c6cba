"""Average-linkage merging against greedy merging of the best pair."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.segmentation.linkage_kernels import average_linkage, patch_borders

seeds = st.integers(0, 2**32 - 1)


def greedy_linkage(n, first, second, total, count, stop):
    borders = {}
    for a, b, t, c in zip(first.tolist(), second.tolist(), total.tolist(), count.tolist(), strict=True):
        t0, c0 = borders.get((a, b), (0.0, 0))
        borders[a, b] = t0 + t, c0 + c
    group = list(range(n))
    while borders:
        (a, b), (t, c) = min(borders.items(), key=lambda item: item[1][0] / item[1][1])
        if not t / c < stop:
            break
        group = [a if g == b else g for g in group]
        joined = {}
        for pair, (t, c) in borders.items():
            low, high = sorted(a if r == b else r for r in pair)
            if low != high:
                t0, c0 = joined.get((low, high), (0.0, 0))
                joined[low, high] = t0 + t, c0 + c
        borders = joined
    # The greedy survivor need not be the smallest member.
    smallest = {g: min(i for i in range(n) if group[i] == g) for g in group}
    return [smallest[g] for g in group]


def random_graph(seed: int, n: int, density: float):
    rng = np.random.default_rng(seed)
    first, second = np.nonzero(np.triu(rng.random((n, n)) < density, 1))
    again = rng.random(len(first)) < 0.2
    first, second = np.r_[first, first[again]], np.r_[second, second[again]]
    count = rng.integers(1, 30, len(first))
    return first, second, rng.random(len(first)) * count, count


@settings(max_examples=100, deadline=None)
@given(seeds, st.integers(1, 40), st.floats(0, 0.5), st.floats(0, 1.1))
def test_same_regions_as_merging_the_best_pair(seed, n, density, stop):
    first, second, total, count = random_graph(seed, n, density)
    copies = [part.copy() for part in (first, second, total, count)]
    group = average_linkage(n, first, second, total, count, stop)
    assert group.tolist() == greedy_linkage(n, first, second, total, count, stop)
    for part, copy in zip((first, second, total, count), copies, strict=True):
        np.testing.assert_array_equal(part, copy)


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(1, 12))
def test_everything_equal_still_ends(seed, n):
    first, second, total, count = random_graph(seed, n, 0.4)
    total = 0.25 * count
    assert average_linkage(n, first, second, total, count, 0.25).tolist() == list(range(n))
    together = average_linkage(n, first, second, total, count, 0.2500001)
    assert together.tolist() == greedy_linkage(n, first, second, total, count, 1.0)


def test_weak_spot_does_not_leak():
    """One smooth pair on a long sharp border does not join what the border as a whole keeps apart."""
    total, count = np.array([20 * 1.0 + 0.0]), np.array([21])
    first, second = np.array([0]), np.array([1])
    assert average_linkage(2, first, second, total, count, 0.5).tolist() == [0, 1]


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 9))
def test_patch_borders_agrees_with_dictionary(seed, n_patches):
    rng = np.random.default_rng(seed)
    points, normals = rng.uniform(0, 1, (70, 3)), rng.normal(size=(70, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    patches = rng.integers(-1, n_patches, 70).astype(np.int32)
    patches[rng.integers(70)] = n_patches - 1
    indptr, indices = radius_neighbours(points, 0.35)
    expected = {}
    for i in range(70):
        for j in indices[indptr[i] : indptr[i + 1]]:
            if 0 <= patches[i] < patches[j]:
                expected.setdefault((patches[i], patches[j]), []).append(1 - normals[i] @ normals[j])
    first, second, total, count = patch_borders(normals, indptr, indices, patches)
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    assert len(set(pairs)) == len(pairs) and set(pairs) == set(expected)
    for pair, t, c in zip(pairs, total, count, strict=True):
        assert c == len(expected[pair])
        np.testing.assert_allclose(t, np.sum(expected[pair]), atol=1e-12)
