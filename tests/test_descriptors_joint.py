"""Descriptors side by side."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import jensenshannon

from shapeconcepts.descriptors import FPFH, Description, Descriptor, Joint, Surflet, get_descriptor
from shapeconcepts.geometry.surface import normals_within
from shapeconcepts.segmentation.segmented_object import SegmentedObject


@dataclass(frozen=True)
class Given:
    """A descriptor that gives the same description whatever the object."""

    description: Description

    def describe(self, segmented: SegmentedObject) -> Description:
        return self.description


def blob(n_segments: int = 3, seed: int = 0) -> SegmentedObject:
    """A bumpy half ellipsoid; the last segment is a single point, which surflets say nothing about."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions[:, 2] = np.abs(directions[:, 2])
    normals = directions / [0.06, 0.05, 0.08] + 2 * rng.normal(size=(400, 3))
    labels = rng.integers(0, n_segments - 1, 400).astype(np.int32)
    labels[0] = n_segments - 1
    return SegmentedObject(
        points=directions * [0.06, 0.05, 0.08],
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        patch_labels=labels,
        segment_labels=labels,
        segment_edges=np.empty((0, 2), np.int32),
        n_segments=n_segments,
        point_to_voxel=np.arange(400, dtype=np.int32),
        voxel_size=0.005,
    )


def refitted(segmented: SegmentedObject, radius: float = 0.02) -> SegmentedObject:
    return replace(segmented, normals=normals_within(segmented.points, segmented.normals, radius))


def side_by_side(parts: list[np.ndarray]) -> np.ndarray:
    """Histograms with an equal share each; the share of one without mass goes to the others."""
    rows = []
    for of_row in zip(*parts, strict=True):
        n_with_mass = sum(part.any() for part in of_row)
        rows.append(np.concatenate(of_row) / max(n_with_mass, 1))
    return np.array(rows)


@pytest.mark.parametrize("n_segments", [2, 3, 5])
def test_histogram_is_that_of_the_parts_side_by_side(n_segments):
    segmented, masks = blob(n_segments), range(1 << n_segments)
    joint = get_descriptor("surflet+fpfh").describe(segmented)
    parts = [each.describe(refitted(segmented)).histograms(masks) for each in (Surflet(), FPFH())]
    assert joint.blocks == (135, 33) and joint.n_bins == 168
    np.testing.assert_allclose(joint.histograms(masks), side_by_side(parts), rtol=1e-12)
    single_point = parts[0][1 << (n_segments - 1)]
    assert not single_point.any(), "every part has mass everywhere"


def test_by_name():
    assert get_descriptor("surflet+fpfh") == Joint((Surflet(), FPFH()))
    assert isinstance(Joint((FPFH(),)), Descriptor)


@st.composite
def descriptions(draw, n_segments: int) -> Description:
    n_bins = draw(st.integers(1, 3))
    mass = st.lists(st.sampled_from([0.0, 0.0, 1.0, 3.5, 1e5]), min_size=n_bins, max_size=n_bins)
    pairs = [(a, b) for a in range(n_segments) for b in range(a + 1, n_segments) if draw(st.booleans())]
    return Description(
        np.array(draw(st.lists(mass, min_size=n_segments, max_size=n_segments))).reshape(-1, n_bins),
        np.array(pairs, np.int32).reshape(-1, 2),
        np.array([draw(mass) for _ in pairs]).reshape(-1, n_bins),
    )


@st.composite
def parts_of_one_object(draw) -> list[Description]:
    n_segments = draw(st.integers(0, 4))
    return [draw(descriptions(n_segments)) for _ in range(draw(st.integers(1, 4)))]


@settings(max_examples=200, deadline=None)
@given(parts_of_one_object())
def test_any_parts(parts):
    joint = Joint(tuple(Given(part) for part in parts)).describe(blob())
    masks = range(1 << joint.n_segments)
    rows = joint.histograms(masks)
    np.testing.assert_allclose(rows, side_by_side([p.histograms(masks) for p in parts]), rtol=1e-12)
    np.testing.assert_allclose(rows.sum(axis=1), rows.any(axis=1), rtol=1e-12)
    for mask, row in zip(masks, rows, strict=True):
        np.testing.assert_array_equal(joint.histograms([mask])[0], row)
    # Joints of joints are joints.
    nested = Joint((Joint(tuple(Given(p) for p in parts[:-1])), Given(parts[-1]))) if parts[1:] else None
    if nested:
        again = nested.describe(blob())
        assert again.blocks == joint.blocks
        np.testing.assert_array_equal(again.histograms(masks), rows)


def test_masses_add_up():
    """The description of a union is the sum of its parts' masses, within each block."""
    segmented = blob(4)
    joint = get_descriptor("surflet+fpfh").describe(segmented)
    members, pairs = (0, 2), [k for k, pair in enumerate(joint.pairs.tolist()) if pair == [0, 2]]
    mass = joint.segment_histograms[list(members)].sum(axis=0) + joint.pair_histograms[pairs].sum(axis=0)
    expected = np.concatenate([block / block.sum() / 2 for block in np.split(mass, [135])])
    np.testing.assert_allclose(joint.histograms([0b101])[0], expected, rtol=1e-12)


def test_divergence_is_the_mean_of_the_parts_divergences():
    masks = [0b01, 0b10]
    a, b = blob(3, seed=1), blob(3, seed=2)

    def divergences(descriptor) -> tuple[float, float]:
        p, q = (descriptor.describe(one).histograms(masks)[i] for one, i in ((a, 0), (b, 1)))
        return jensenshannon(p, q, base=2) ** 2, 1 - np.sqrt(p * q).sum()

    joint = divergences(get_descriptor("surflet+fpfh"))
    a, b = refitted(a), refitted(b)
    parts = [divergences(descriptor) for descriptor in (Surflet(), FPFH())]
    np.testing.assert_allclose(joint, np.mean(parts, axis=0), rtol=1e-9)
    assert min(parts[0]) > 1e-3 and abs(parts[0][0] - parts[1][0]) > 3e-4


def test_bad_blocks_are_refused():
    for wrong in [(1, 2), (5,), (4, 0), (5, -1), (1, 1, 1)]:
        with pytest.raises(ValueError, match="blocks must be numbers of bins that sum to 4, got"):
            Description(np.ones((2, 4)), blocks=wrong)
    np.testing.assert_allclose(
        Description(np.array([[1.0, 3.0, 0.0, 2.0]]), blocks=(1, 3)).histograms([1]), [[0.5, 0.3, 0, 0.2]]
    )


@pytest.mark.parametrize(("voxel_size", "radius"), [(0.001, 0.03), (0.015, 0.03), (0.025, 0.05)])
def test_normals_are_fitted_over_a_radius_of_two_voxels_at_least(voxel_size, radius):
    segmented = replace(blob(), voxel_size=voxel_size)
    found = Joint((Surflet(),), normal_radius=0.03).describe(segmented)
    expected = Surflet().describe(refitted(segmented, radius))
    np.testing.assert_array_equal(found.segment_histograms, expected.segment_histograms)
    given_normals = Surflet().describe(segmented)
    assert not np.allclose(found.segment_histograms, given_normals.segment_histograms)


def test_errors_are_those_of_the_parts():
    with pytest.raises(ValueError, match="'scale' parameter of Surflet must be a str among"):
        Joint((FPFH(), Surflet("size"))).describe(blob())
    for radius in (0, -0.02, np.nan, "2 cm"):
        with pytest.raises(ValueError, match="'normal_radius' parameter of Joint must be a float"):
            Joint((FPFH(),), radius).describe(blob())
    with pytest.raises(ValueError, match="descriptors must hold at least one descriptor, got none"):
        Joint(()).describe(blob())
