"""Scans whose coordinates are large: georeferenced ones, tiny ones, and both."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts import Scan, ScanError, datasets, describe, segment
from shapeconcepts.geometry.neighbour_kernels import renumber
from shapeconcepts.geometry.neighbours import radius_neighbours
from shapeconcepts.geometry.origin import TILE, nearest_tile, origin_amid
from shapeconcepts.preparation import prepare

OFFSETS = {
    "UTM": (447_123.0, 5_411_234.0, 312.0),
    "ECEF": (4.2e6, 1.7e5, 4.78e6),
    "10,000 km": (1e7, -1e7, 1e7),
}
# Billionths of a metre above 4,194,304 m: a few units in the last place.
LAST_PLACES = np.array(
    [
        (4, 2, 3),
        (1, 3, 4),
        (6, 3, 5),
        (5, 0, 5),
        (0, 4, 4),
        (6, 5, 6),
        (4, 0, 0),
        (5, 5, 4),
        (5, 2, 5),
        (1, 5, 1),
    ]
)


def test_points_some_units_in_the_last_place_apart():
    segmented = segment(4_194_304 + 1e-9 * LAST_PLACES)
    assert segmented.n_segments == 1


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.floats(3, 9), st.floats(-9, 2))
def test_small_clouds_anywhere_of_any_size(seed, n, offset_exponent, scale_exponent):
    random = np.random.default_rng(seed)
    cloud = 10**scale_exponent * random.normal(size=(n, 3)) + 10**offset_exponent * random.uniform(-1, 1, 3)
    described = describe(segment(cloud))
    assert np.isfinite(described.description.segment_histograms).all()


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0, 9), st.integers(-12, 0))
def test_neighbours_are_mutual(seed, offset_exponent, scale_exponent):
    random = np.random.default_rng(seed)
    radius = 10.0**scale_exponent
    points = radius * random.normal(size=(60, 3)) + 10**offset_exponent
    indptr, indices = radius_neighbours(points, radius)
    pairs = set(zip(np.repeat(np.arange(60), np.diff(indptr)).tolist(), indices.tolist(), strict=True))
    assert pairs == {(b, a) for a, b in pairs}
    distances = np.linalg.norm(points[:, None] - points, axis=2)
    assert pairs == {(a, b) for a, b in np.argwhere(distances <= radius).tolist() if a != b}


def test_lists_that_are_not_mutual_are_turned_around():
    indptr, indices = np.array([0, 2, 3, 3]), np.array([1, 2, 2], np.int32)
    starts, renumbered = renumber(indptr, indices, np.array([2, 0, 1]))
    # In their new numbers, point 2 names 0 and 1, and point 0 names 1.
    assert starts.tolist() == [0, 1, 3, 3]
    assert renumbered.tolist() == [2, 0, 2]


@pytest.mark.parametrize("place", OFFSETS)
@pytest.mark.parametrize("with_viewpoint", [True, False], ids=["sensor known", "sensor unknown"])
def test_a_scan_on_whole_millimetres_has_the_same_segments_anywhere(place, with_viewpoint):
    for scan in datasets.simulate(n_per_category=1, random_state=5):
        points = np.rint(1e3 * scan.points) / 1e3
        moved = np.rint(1e3 * (points + OFFSETS[place])) / 1e3
        viewpoint = scan.viewpoint if with_viewpoint else None
        here = segment(Scan(points, viewpoint))
        there = segment(Scan(moved, None if viewpoint is None else viewpoint + OFFSETS[place]))
        assert there.point_to_voxel.tolist() == here.point_to_voxel.tolist()
        assert there.segment_labels.tolist() == here.segment_labels.tolist()
        assert there.normals.tolist() == here.normals.tolist()
        assert np.abs(there.points - (here.points + OFFSETS[place])).max() < 1e-8
        one, other = (describe(segmented).description.segment_histograms for segmented in (here, there))
        assert np.abs(one / one.sum() - other / other.sum()).max() < 1e-3


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 7), st.floats(3, 7), st.floats(-1, 1), st.booleans())
def test_decimal_coordinates_are_the_same_to_the_last_bit_anywhere(
    seed, decimals, offset_exponent, scale_exponent, with_viewpoint
):
    random = np.random.default_rng(seed)
    x, y = random.uniform(-1, 1, (2, 400))
    steps = np.rint(10 ** (scale_exponent + decimals) * np.column_stack([x, y, np.maximum(x * x, y)]))
    offset = np.rint(10 ** (offset_exponent + decimals) * random.uniform(-1, 1, 3))
    viewpoint = np.rint(10**decimals * np.array([0.4, -2.0, 9.0]))
    here, there = (
        prepare(
            Scan(
                (steps + moved) / 10**decimals,
                (viewpoint + moved) / 10**decimals if with_viewpoint else None,
            )
        )
        for moved in (np.zeros(3), offset)
    )
    assert there.offsets.tolist() == here.offsets.tolist()
    assert there.normals.tolist() == here.normals.tolist()
    one, other = (segment(prepared).segment_labels for prepared in (here, there))
    assert one.tolist() == other.tolist()


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 15), st.floats(-6, 9))
def test_what_is_left_of_decimal_coordinates_is_nearest_to_the_truth(seed, decimals, exponent):
    largest = min(int(10 ** (exponent + decimals)), 10**15)
    steps = np.random.default_rng(seed).integers(-largest, largest + 1, (20, 3))
    points = np.array([[float(Fraction(int(one), 10**decimals)) for one in row] for row in steps])
    origin = origin_amid(points)
    middle = np.sort(steps, axis=0)[10]
    expected = [[float(Fraction(int(one), 10**decimals)) for one in row] for row in steps - middle]
    assert origin.take_off(points).tolist() == expected
    assert origin.metres.tolist() == np.sort(points, axis=0)[10].tolist()


def test_coordinates_that_are_not_decimal_are_moved_by_whole_tiles():
    points = np.rint(2**20 * np.random.default_rng(0).uniform(-1, 1, (50, 3))) / 2**20
    assert (origin_amid(points).take_off(points) == points).all()
    assert (origin_amid(points + 2**20).take_off(points + 2**20) == points).all()


def test_the_tile_is_that_of_most_points_and_taken_off_without_rounding():
    random = np.random.default_rng(0)
    points = random.uniform(-1, 1, (50, 3)) + np.array(OFFSETS["UTM"])
    points[0] = 1e9
    tile = nearest_tile(points)
    assert tile.tolist() == [447_488.0, 5_410_816.0, 0.0]
    near = points[1:] - tile
    assert np.abs(near).max() <= TILE
    assert (near + tile == points[1:]).all()
    assert nearest_tile(random.uniform(-500, 500, (50, 3))).tolist() == [0, 0, 0]
    assert nearest_tile(np.empty((0, 3))).tolist() == [0, 0, 0]


@pytest.mark.parametrize("viewpoint", [(0, 0, 1e155), (-2e9, 0, 0)])
def test_viewpoint_too_far_to_compute_with(viewpoint):
    with pytest.raises(ScanError, match=r"mug: viewpoint \[.*expected metres \(at most 1e9\)"):
        segment(Scan(np.eye(3), viewpoint, "mug"))


def test_two_points_that_differ_by_next_to_nothing():
    described = describe(segment([[0, 0, 1e6], [-1e-21, 5e-33, 1e6]]))
    assert np.isfinite(described.description.segment_histograms).all()
