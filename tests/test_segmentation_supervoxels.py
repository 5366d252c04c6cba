"""Kernels of the supervoxel clustering against slow Python versions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.geometry.neighbours import Neighbours, radius_neighbours
from shapeconcepts.segmentation.supervoxel_kernels import (
    central_voxels,
    closer_neighbours,
    grow_supervoxels,
    inherit_patches,
    smooth_normals,
)
from shapeconcepts.segmentation.supervoxels import supervoxels

seeds = st.integers(0, 2**32 - 1)


def lists_of(neighbours: Neighbours) -> list[list[int]]:
    return [part.tolist() for part in np.split(neighbours.indices, neighbours.indptr[1:-1])]


def surface(seed: int, n: int = 250) -> tuple[np.ndarray, np.ndarray, Neighbours]:
    """Random points on a gable roof, with noisy normals, neighbours within 0.25."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1, 1, (2, n))
    normals = np.column_stack([np.sign(x), np.zeros(n), np.ones(n)]) + rng.normal(0, 0.2, (n, 3))
    points = np.column_stack([x, y, -np.abs(x)])
    return points, unit(normals), radius_neighbours(points, 0.25)


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def slow_smooth(points, normals, lists, width, angular_width, rounds):
    for _ in range(rounds):
        sums = normals.copy()
        for i, near in enumerate(lists):
            for j in near:
                spatial = 1 / (1 + np.sum((points[i] - points[j]) ** 2) / (2 * width**2))
                turn = (1 - normals[i] @ normals[j]) / (1 - np.cos(angular_width))
                sums[i] += spatial * max(0.0, 1 - turn) ** 2 * normals[j]
        normals = unit(sums)
    return normals


def slow_growth(points, normals, lists, centres, seed_size, normal_weight, rounds):
    """Every voxel takes the best of the supervoxels around it, all at once, until nothing changes."""

    def distance(voxel, supervoxel):
        centre = centres[supervoxel]
        apart = np.sum((points[voxel] - points[centre]) ** 2) / seed_size**2
        return apart + normal_weight * (1 - normals[voxel] @ normals[centre])

    owner = [-1] * len(points)
    for s, centre in enumerate(centres):
        owner[centre] = s
    for _ in range(rounds):
        before = list(owner)
        for i, near in enumerate(lists):
            if i in centres:
                continue
            candidates = {before[j] for j in [i, *near]} - {-1}
            owner[i] = min(candidates, key=lambda s: distance(i, s)) if candidates else -1
        if owner == before:
            break
    return owner


@settings(max_examples=20, deadline=None)
@given(seeds, st.floats(0.05, 1), st.floats(0.1, 1.2), st.integers(0, 3))
def test_smooth_normals_agrees(seed, width, angular_width, rounds):
    points, normals, neighbours = surface(seed, 120)
    before = normals.copy()
    smoothed = smooth_normals(points, normals, *neighbours, width, angular_width, rounds)
    expected = slow_smooth(points, normals, lists_of(neighbours), width, angular_width, rounds)
    np.testing.assert_allclose(smoothed, expected, atol=1e-12)
    np.testing.assert_array_equal(normals, before)


def test_smoothing_removes_noise_but_keeps_the_crease():
    points, noisy, neighbours = surface(3, 1500)
    truth = unit(np.column_stack([np.sign(points[:, 0]), np.zeros(1500), np.ones(1500)]))

    def error(normals):
        return np.degrees(np.arccos(np.einsum("ij,ij->i", normals, truth).clip(-1, 1)))

    smoothed = smooth_normals(points, noisy, *neighbours, 0.2, np.radians(45), 3)
    assert np.median(error(smoothed)) < 0.35 * np.median(error(noisy))
    at_crease = np.abs(points[:, 0]) < 0.1
    assert np.median(error(smoothed)[at_crease]) < 0.5 * np.median(error(noisy)[at_crease])


@settings(max_examples=25, deadline=None)
@given(seeds, st.integers(1, 25), st.integers(0, 12), st.floats(0, 5))
def test_growth_agrees(seed, n_seeds, rounds, normal_weight):
    points, normals, neighbours = surface(seed, 150)
    centres = np.random.default_rng(seed).choice(len(points), n_seeds, replace=False)
    owner = grow_supervoxels(points, normals, *neighbours, centres, 0.4, normal_weight, rounds)
    assert owner.dtype == np.int32
    expected = slow_growth(
        points, normals, lists_of(neighbours), centres.tolist(), 0.4, normal_weight, rounds
    )
    assert owner.tolist() == expected


@settings(max_examples=15, deadline=None)
@given(seeds)
def test_growth_does_not_depend_on_the_order_of_voxels(seed):
    points, normals, _ = surface(seed)
    rng = np.random.default_rng(seed)
    centres = rng.choice(len(points), 20, replace=False)
    order = rng.permutation(len(points))
    place = np.argsort(order)
    args = 0.3, 4.0, 6
    owner = grow_supervoxels(points, normals, *radius_neighbours(points, 0.25), centres, *args)
    shuffled = grow_supervoxels(
        points[order], normals[order], *radius_neighbours(points[order], 0.25), place[centres], *args
    )
    np.testing.assert_array_equal(shuffled, owner[order])


def test_growth_moves_one_layer_a_round():
    n = 30
    points = np.column_stack([np.arange(n), np.zeros(n), np.zeros(n)]).astype(float)
    normals = np.tile([0.0, 0.0, 1.0], (n, 1))
    for rounds in range(12):
        owner = grow_supervoxels(
            points, normals, *radius_neighbours(points, 1.5), np.array([10]), 5.0, 1.0, rounds
        )
        np.testing.assert_array_equal(owner >= 0, np.abs(np.arange(n) - 10) <= rounds)


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 20))
def test_central_voxels_agrees(seed, n_seeds):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(80, 3))
    owner = rng.integers(-1, n_seeds, 80).astype(np.int32)
    centres = rng.choice(80, n_seeds, replace=False)
    owner[centres] = np.arange(n_seeds)
    central = central_voxels(points, owner, centres)
    for s in range(n_seeds):
        members = np.flatnonzero(owner == s)
        apart = np.linalg.norm(points[members] - points[members].mean(axis=0), axis=1)
        assert central[s] in members
        assert np.linalg.norm(points[central[s]] - points[members].mean(axis=0)) == pytest.approx(apart.min())


@settings(max_examples=30, deadline=None)
@given(seeds, st.floats(0.01, 1.0))
def test_closer_neighbours_agrees_with_search(seed, radius):
    points = np.random.default_rng(seed).uniform(0, 1, (120, 3))
    closer = Neighbours(*closer_neighbours(points, *radius_neighbours(points, 1.0), radius))
    expected = radius_neighbours(points, radius)
    np.testing.assert_array_equal(closer.indptr, expected.indptr)
    np.testing.assert_array_equal(closer.indices, expected.indices)


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 8), st.integers(1, 4))
def test_inherited_patches_lie_in_one_segment(seed, n_patches, n_segments):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (90, 2)) @ [[1.0, 0, 0], [0, 1, 0]]
    neighbours = radius_neighbours(points, 0.13)
    patches = rng.integers(-1, n_patches, 90).astype(np.int32)
    segments = rng.integers(-1, n_segments, 90).astype(np.int32)
    patches[0], segments[0] = 0, 0
    inherited = inherit_patches(*neighbours, patches, segments)

    home = {}
    for patch in set(patches.tolist()) - {-1}:
        votes = np.bincount(segments[(patches == patch) & (segments >= 0)], minlength=n_segments)
        home[patch] = int(votes.argmax()) if votes.any() else None
    assert (inherited[segments < 0] == -1).all()
    for i in range(90):
        if patches[i] >= 0 and segments[i] == home[patches[i]]:
            assert inherited[i] == patches[i]
        elif inherited[i] >= 0:
            near = neighbours.indices[neighbours.indptr[i] : neighbours.indptr[i + 1]]
            assert home[int(inherited[i])] == segments[i]
            assert inherited[i] in inherited[near]
        elif segments[i] >= 0:
            near = neighbours.indices[neighbours.indptr[i] : neighbours.indptr[i + 1]]
            assert (inherited[near[segments[near] == segments[i]]] == -1).all()


def test_supervoxels_of_a_box_edge_stay_on_their_face():
    side = np.arange(0.0, 0.1, 0.005)
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    zero = np.zeros(len(x))
    points = np.vstack([np.column_stack([x, y, zero]), np.column_stack([zero, y, -x - 0.005])])
    normals = np.repeat([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]], len(x), axis=0)
    patches = supervoxels(points, normals, radius_neighbours(points, 0.01), 0.005, 0.02)
    assert patches.min() >= 0
    size = np.bincount(patches)
    assert (size > 0).all() and 4 <= np.median(size) <= 32
    on_top = np.bincount(patches, normals[:, 2])
    assert np.all((on_top == 0) | (on_top == size))
    extent = [np.ptp(points[patches == s], axis=0).max() for s in range(len(size))]
    assert max(extent) < 3 * 0.02
