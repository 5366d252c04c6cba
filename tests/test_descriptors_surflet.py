"""Surflet-pair relations against a slow version over all pairs."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.descriptors import Surflet
from shapeconcepts.segmentation.segmented_object import SegmentedObject


def relation(p, n, q, m):
    """Distance, theta, alpha, phi (Wahl 2003, equations 1 to 5): the origin is less in line."""
    d = q - p
    distance = np.linalg.norm(d)
    if abs(n @ d) > abs(m @ d):
        n, m, d = m, n, -d
    v = np.cross(d, n) / np.linalg.norm(np.cross(d, n))
    w = np.cross(n, v)
    return distance, math.atan2(w @ m, n @ m), v @ m, n @ d / distance


def share(value, n_bins, around=False):
    """Linear shares in the two bins whose centres are nearest to a value in [0, 1]."""
    position = value * n_bins - 0.5
    low = math.floor(position)
    shares = np.zeros(n_bins)
    for index, part in ((low, low + 1 - position), (low + 1, position - low)):
        shares[index % n_bins if around else min(max(index, 0), n_bins - 1)] += part
    return shares


def slow_surflet(points, normals, distance_range):
    histogram = np.zeros((5, 3, 9))
    for i in range(len(points)):
        for j in range(i):
            distance, theta, alpha, phi = relation(points[i], normals[i], points[j], normals[j])
            by_distance = share(min(distance / distance_range, 1), 5)
            angles = [
                share((theta / math.pi + 1) / 2, 9, True),
                share((alpha + 1) / 2, 9),
                share((phi + 1) / 2, 9),
            ]
            histogram += by_distance[:, None, None] * np.array(angles)
    return histogram.ravel() / max(histogram.sum(), 1e-300)


def as_segmented(points, normals, labels, n_segments):
    labels = np.asarray(labels, np.int32)
    return SegmentedObject(
        points, normals, labels, labels, np.empty((0, 2), np.int32), n_segments, labels, voxel_size=0.005
    )


def spread_surface(seed, n):
    """Points that no two of share a cell, with random normals."""
    rng = np.random.default_rng(seed)
    corners = np.stack(np.meshgrid(*[np.arange(4)] * 3), axis=-1).reshape(-1, 3)
    points = 0.04 * (rng.permutation(corners)[:n] + rng.uniform(-0.2, 0.2, (n, 3)))
    normals = rng.normal(size=(n, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 30), st.sampled_from(["relative", "metric"]))
def test_agrees_with_all_pairs_where_the_cells_hold_one_point_each(seed, n, scale):
    points, normals = spread_surface(seed, n)
    labels = np.random.default_rng(seed).integers(-1, 3, n)
    labels[:2] = 0, 1
    description = Surflet(scale).describe(as_segmented(points, normals, labels, 3))
    kept = points[labels >= 0]
    diameter = max(np.linalg.norm(p - q) for p in kept for q in kept)
    for mask in range(8):
        members = [i for i in range(n) if labels[i] >= 0 and mask >> labels[i] & 1]
        expected = slow_surflet(points[members], normals[members], diameter if scale == "relative" else 0.5)
        np.testing.assert_allclose(description.histograms([mask])[0], expected, atol=2e-5)


def test_distances_beyond_the_metric_range_count_as_its_end():
    points = np.array([[0.0, 0, 0], [0.7, 0, 0]])
    normals = np.array([[0.0, 0, 1], [0, 1, 0]])
    whole = Surflet("metric").describe(as_segmented(points, normals, [0, 0], 1)).whole().reshape(5, 27)
    assert whole[:4].sum() == 0 and np.isclose(whole[4].sum(), 1)


@pytest.mark.parametrize(("scale", "same"), [("relative", True), ("metric", False)])
def test_size(scale, same):
    points, normals = spread_surface(5, 60)
    labels = np.arange(60) % 3
    small, large = (
        Surflet(scale).describe(as_segmented(factor * points, normals, labels, 3)).whole()
        for factor in (1, 1.7)
    )
    assert np.allclose(small, large, atol=1e-12) == same


def test_cells_approximate_all_pairs():
    """A can: 1,200 points averaged in cells give nearly the histogram of all 720,000 pairs."""
    rng = np.random.default_rng(0)
    angle, height = rng.uniform(0, math.pi, 1200), rng.uniform(0, 0.12, 1200)
    normals = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = 0.035 * normals + np.outer(height, [0, 0, 1])
    averaged = Surflet("metric").describe(as_segmented(points, normals, np.zeros(1200), 1)).whole()
    sample = rng.permutation(1200)[:120]
    exact = slow_surflet(points[sample], normals[sample], 0.5)
    assert np.abs(averaged - exact).sum() < 0.15


def test_points_stand_for_the_pairs_they_are_part_of():
    """A doubled point weighs twice, and pairs within a cell do not count."""
    points, normals = spread_surface(1, 12)
    twice = np.r_[np.arange(12), 0, 0, 5]
    found = Surflet("metric").describe(as_segmented(points[twice], normals[twice], np.zeros(15), 1))
    mass = found.segment_histograms.sum()
    assert np.isclose(mass, 3 * (15 * 14 / 2 - 3 - 1))


def test_a_single_cell_has_no_mass_of_its_own():
    points, normals = spread_surface(2, 20)
    labels = np.r_[0, np.ones(19)]
    description = Surflet().describe(as_segmented(points, normals, labels, 2))
    alone, rest, both = description.histograms([1, 2, 3])
    assert not alone.any() and np.isclose(rest.sum(), 1) and np.isclose(both.sum(), 1)
    assert not np.allclose(rest, both)


def test_direction_of_the_grid_decides_no_tie():
    """Steps of a stair: both normals are equally far from the connection."""
    points = np.array([[0.0, 0, 0], [0.01, 0, 0.02], [0.03, 0.01, 0.04]])
    normals = np.tile([0.0, 0, 1], (3, 1))
    there, turned = (
        Surflet().describe(as_segmented(points * turn, normals, [0, 0, 0], 1)).whole()
        for turn in ([1, 1, 1], [-1, -1, 1])
    )
    np.testing.assert_allclose(there, turned, atol=1e-12)
