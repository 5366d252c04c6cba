"""The protocol of descriptors, and what holds for every one of them."""

import doctest

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from shapeconcepts.descriptors import (
    FPFH,
    Curvature,
    Description,
    Descriptor,
    Joint,
    PointDistances,
    Surflet,
    get_descriptor,
)
from shapeconcepts.segmentation.segmented_object import SegmentedObject

DESCRIPTORS = [FPFH(), Surflet(), Surflet(scale="metric"), Curvature(), PointDistances()]
N_BINS = {FPFH: 33, Surflet: 135, Curvature: 66, PointDistances: 14}
every_descriptor = pytest.mark.parametrize("descriptor", DESCRIPTORS, ids=repr)


def as_segmented(points, normals, labels, n_segments=None) -> SegmentedObject:
    labels = np.asarray(labels, np.int32)
    return SegmentedObject(
        points=np.asarray(points, float).reshape(-1, 3),
        normals=np.asarray(normals, float).reshape(-1, 3),
        patch_labels=labels,
        segment_labels=labels,
        segment_edges=np.empty((0, 2), np.int32),
        n_segments=int(labels.max(initial=-1)) + 1 if n_segments is None else n_segments,
        point_to_voxel=np.arange(len(labels), dtype=np.int32),
        voxel_size=0.005,
    )


@pytest.fixture(scope="module")
def blob() -> SegmentedObject:
    """A bumpy half ellipsoid in four segments, one point in twelve in none."""
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(900, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions[:, 2] = np.abs(directions[:, 2])
    points = directions * [0.06, 0.05, 0.08] * (1 + 0.05 * rng.normal(size=(900, 1)))
    normals = directions / [0.06, 0.05, 0.08] + 2 * rng.normal(size=(900, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    labels = (points[:, 0] > 0) + 2 * (points[:, 1] > 0.01)
    labels[rng.uniform(size=900) < 1 / 12] = -1
    return as_segmented(points, normals, labels)


def all_histograms(description: Description) -> np.ndarray:
    return description.histograms(range(1 << description.n_segments))


@every_descriptor
def test_histograms_are_distributions(descriptor, blob):
    histograms = all_histograms(descriptor.describe(blob))
    assert histograms.shape == (16, N_BINS[type(descriptor)])
    assert (histograms >= 0).all()
    np.testing.assert_allclose(histograms[1:].sum(axis=1), 1)
    assert not histograms[0].any()
    assert len(np.unique(histograms.round(6), axis=0)) == 16


@every_descriptor
def test_order_of_points_does_not_matter(descriptor, blob):
    order = np.random.default_rng(1).permutation(len(blob.points))
    permuted = as_segmented(blob.points[order], blob.normals[order], blob.segment_labels[order])
    before, after = (all_histograms(descriptor.describe(each)) for each in (blob, permuted))
    # Curvatures are fitted in single precision: the order of the sums counts in their last digits.
    np.testing.assert_allclose(after, before, atol=1e-6 if isinstance(descriptor, Curvature) else 1e-12)


@every_descriptor
def test_names_of_segments_do_not_matter(descriptor, blob):
    new_name = np.array([2, 0, 3, 1, -1])
    renamed = as_segmented(blob.points, blob.normals, new_name[blob.segment_labels])
    masks = np.arange(16)
    new_masks = sum(((masks >> old) & 1) << new_name[old] for old in range(4))
    np.testing.assert_allclose(
        descriptor.describe(renamed).histograms(new_masks),
        descriptor.describe(blob).histograms(masks),
        atol=1e-12,
    )


def test_rigid_motion_of_the_points_leaves_fpfh(blob):
    rotation = Rotation.random(random_state=3).as_matrix()
    moved = as_segmented(
        blob.points @ rotation.T + [0.3, -0.2, 0.9], blob.normals @ rotation.T, blob.segment_labels
    )
    before, after = (all_histograms(FPFH().describe(each)) for each in (blob, moved))
    # A feature that sits on the border of two bins may cross it by rounding.
    np.testing.assert_allclose(after, before, atol=1e-5)


@pytest.mark.parametrize("scale", ["relative", "metric"])
def test_rigid_motion_of_the_points_does_not_change_surflet(blob, scale):
    smooth = blob.points / [0.06, 0.05, 0.08]
    smooth /= np.linalg.norm(smooth, axis=1, keepdims=True)
    points = smooth * [0.06, 0.05, 0.08]
    translated = as_segmented(points + 0.5, smooth, blob.segment_labels)
    before = all_histograms(Surflet(scale).describe(as_segmented(points, smooth, blob.segment_labels)))
    np.testing.assert_allclose(all_histograms(Surflet(scale).describe(translated)), before, atol=1e-9)
    rotation = Rotation.random(random_state=3).as_matrix()
    rotated = as_segmented(points @ rotation.T, smooth @ rotation.T, blob.segment_labels)
    after = all_histograms(Surflet(scale).describe(rotated))
    np.testing.assert_allclose(after, before, atol=1e-9)  # the grid turns with the object


@every_descriptor
@pytest.mark.parametrize(
    ("points", "normals"),
    [
        (np.zeros((0, 3)), np.zeros((0, 3))),
        (np.ones((1, 3)), [[0, 0, 1]]),
        (np.full((30, 3), 0.7), np.tile([0, 0.6, 0.8], (30, 1))),
        (np.outer(np.arange(30), [0.004, 0.002, 0]), np.tile([0, 0, 1], (30, 1))),
        (np.outer(np.arange(30), [0, 0, 0.005]), np.tile([0, 0, 1], (30, 1))),
        (np.random.default_rng(0).uniform(size=(30, 3)) * 0.05, np.zeros((30, 3))),
        (np.random.default_rng(0).uniform(size=(30, 3)) * 1e4, np.tile([0, 0, 1], (30, 1))),
    ],
    ids=["empty", "one", "duplicates", "collinear", "along the normal", "zero normals", "far apart"],
)
def test_degenerate_clouds(descriptor, points, normals):
    labels = np.arange(len(points)) % 2
    description = descriptor.describe(as_segmented(points, normals, labels, n_segments=2))
    histograms = all_histograms(description)
    assert np.isfinite(histograms).all()
    sums = histograms.sum(axis=1)
    assert (np.isclose(sums, 1) | (sums == 0)).all()
    if len(points) == 30 and np.ptp(points) < 1 and not (points == 0.7).all():
        assert np.isclose(sums[3], 1)


@every_descriptor
def test_segments_without_points(descriptor, blob):
    description = descriptor.describe(as_segmented(blob.points, blob.normals, np.full(900, -1), n_segments=0))
    assert description.n_segments == 0
    assert not description.whole().any()


@every_descriptor
def test_bad_objects(descriptor, blob):
    def describe(points=blob.points, normals=blob.normals, labels=blob.segment_labels):
        descriptor.describe(as_segmented(points, normals, labels, n_segments=4))

    with pytest.raises(ValueError, match="points must be finite"):
        describe(points=np.where(np.arange(2700).reshape(900, 3) == 7, np.nan, blob.points))
    with pytest.raises(ValueError, match=r"normals must be unit vectors .* at row 3"):
        describe(normals=np.where(np.arange(900)[:, None] == 3, 2.0, blob.normals))
    with pytest.raises(ValueError, match="segment_labels must be below n_segments = 4, got 4"):
        describe(labels=blob.segment_labels + 1)
    with pytest.raises(ValueError, match="segment_labels must have shape"):
        describe(labels=blob.segment_labels[1:])


def test_parameters():
    assert FPFH() == FPFH(radius=0.03) != FPFH(0.02)
    assert Curvature() == Curvature(radius=0.4) != Curvature(0.2)
    assert repr(Surflet()) == "Surflet(scale='relative')"
    assert Surflet() != Surflet("metric")
    one = as_segmented(np.zeros((1, 3)), [[0, 0, 1]], [0])
    with pytest.raises(ValueError, match=r"'radius' parameter of FPFH must be a float .* Got -1"):
        FPFH(-1).describe(one)
    with pytest.raises(ValueError, match=r"'radius' parameter of Curvature must be a float .* Got 0"):
        Curvature(0).describe(one)
    with pytest.raises(ValueError, match=r"'scale' parameter of Surflet must be a str among .* Got 'large'"):
        Surflet("large").describe(one)


def test_get_descriptor():
    class Own:
        def describe(self, segmented):
            return Description(np.ones((segmented.n_segments, 1)))

    own = Own()
    assert get_descriptor("fpfh") == FPFH()
    assert get_descriptor("surflet") == Surflet()
    assert get_descriptor("curvature") == Curvature()
    assert get_descriptor("distance") == PointDistances()
    assert get_descriptor("surflet+fpfh") == Joint((Surflet(), FPFH()))
    assert get_descriptor("surflet+fpfh+curvature") == Joint((Surflet(), FPFH(), Curvature()))
    assert get_descriptor(own) is own
    assert all(isinstance(each, Descriptor) for each in [own, *DESCRIPTORS])
    for wrong in ("shot", 3, None, Own):
        with pytest.raises(
            ValueError,
            match=r"one of 'surflet\+fpfh\+curvature', 'surflet\+fpfh\+curvature\+distance', "
            r"'surflet\+fpfh', 'surflet', 'fpfh', 'curvature', 'distance' or have a describe method",
        ):
            get_descriptor(wrong)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 64), st.data())
def test_constellation_is_the_sum_over_its_members(seed, n_segments, data):
    rng = np.random.default_rng(seed)
    pairs = np.argwhere(np.triu(rng.uniform(size=(n_segments, n_segments)) < 0.2, k=1)).astype(np.int32)
    description = Description(rng.uniform(size=(n_segments, 5)), pairs, rng.uniform(size=(len(pairs), 5)))
    masks = data.draw(st.lists(st.integers(0, (1 << n_segments) - 1), max_size=6))
    rows = description.histograms(masks)
    assert rows.shape == (len(masks), 5)
    for mask, row in zip(masks, rows, strict=True):
        members = {i for i in range(n_segments) if mask >> i & 1}
        total = sum((description.segment_histograms[i] for i in members), np.zeros(5))
        for (a, b), histogram in zip(pairs, description.pair_histograms, strict=True):
            total = total + histogram * (a in members and b in members)
        np.testing.assert_allclose(row, total / max(total.sum(), 1e-300))
        np.testing.assert_array_equal(description.histograms([mask])[0], row)
    np.testing.assert_array_equal(description.whole(), description.histograms([(1 << n_segments) - 1])[0])


def test_bad_descriptions_and_constellations():
    description = Description(np.ones((3, 2)))
    np.testing.assert_array_equal(
        description.histograms(np.array([1, 7], np.uint64)), [[0.5, 0.5], [0.5, 0.5]]
    )
    for wrong in (-1, 8, 1.5):
        with pytest.raises(ValueError, match=rf"bitmasks of segments 0 to 2, got {wrong}"):
            description.histograms([1, wrong])
    with pytest.raises(ValueError, match=r"segment_histograms must have shape \(s, b\), got \(3,\)"):
        Description(np.ones(3))
    with pytest.raises(ValueError, match="at most 64 segments, got 65"):
        Description(np.ones((65, 2)))
    with pytest.raises(ValueError, match=r"pair_histograms \(p, 2\), got \(1, 2\) and \(1, 3\)"):
        Description(np.ones((3, 2)), np.array([[0, 1]], np.int32), np.ones((1, 3)))
    with pytest.raises(ValueError, match=r"pairs must name segments 0 to 2, got \[\[0, 3\]\]"):
        Description(np.ones((3, 2)), np.array([[0, 3]], np.int32), np.ones((1, 2)))


def test_documented_example(blob):
    scope = {"np": np, "Description": Description}
    (example,) = doctest.DocTestFinder(recurse=False).find(Descriptor, "Descriptor", globs=scope)
    results = doctest.DocTestRunner().run(example, clear_globs=False)
    assert results == (0, 1)
    descriptor = get_descriptor(example.globs["CentroidDistance"]())
    histograms = all_histograms(descriptor.describe(blob))
    np.testing.assert_allclose(histograms.sum(axis=1), np.arange(16) > 0)
