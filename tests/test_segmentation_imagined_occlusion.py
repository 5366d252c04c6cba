"""Imagined occlusions: what they hide, and what they depend on."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from shapeconcepts import datasets, segment
from shapeconcepts.segmentation.imagined_occlusion import HIDDEN_SHARES, MIN_VOXELS, imagine_occlusion

SHIFT = np.array([0.3, -0.2, 5.0])


@pytest.fixture(scope="module")
def objects():
    return [segment(scan) for scan in datasets.simulate(n_per_category=4, random_state=3)]


def visible_points(segmented, number: int) -> np.ndarray:
    """Which points are left, by their coordinates."""
    rest = imagine_occlusion(segmented, number).segmented.points
    return (segmented.points[:, None] == rest[None]).all(axis=2).any(axis=1)


def test_the_rest_is_a_part_of_the_object(objects):
    for segmented in objects:
        for number in range(3):
            rest, segments = imagine_occlusion(segmented, number)
            assert rest.n_segments == len(segments) >= 1
            assert (np.diff(segments) > 0).all() and segments[-1] < segmented.n_segments
            counts = np.bincount(rest.segment_labels, minlength=rest.n_segments)
            assert len(counts) == rest.n_segments and counts.min() >= MIN_VOXELS
            label_of = dict(zip(map(tuple, segmented.points), segmented.segment_labels.tolist(), strict=True))
            whole = [label_of[tuple(point)] for point in rest.points]
            assert np.array_equal(segments[rest.segment_labels], whole)
            known = {tuple(edge) for edge in segmented.segment_edges.tolist()}
            assert {tuple(segments[edge].tolist()) for edge in rest.segment_edges} <= known
            assert rest.name == segmented.name and rest.label == segmented.label


def test_a_third_a_half_two_thirds_and_whole_segments_are_hidden(objects):
    shares, whole = [], 0
    for segmented in objects:
        for number in range(3):
            visible = visible_points(segmented, number)
            shares.append(1 - visible.mean())
            of_segment = [visible[segmented.segment_labels == s].mean() for s in range(segmented.n_segments)]
            whole += set(np.round(of_segment, 6)) == {0.0, 1.0}
    # Small leftovers of segments go, too, so that a little more is hidden.
    for share in HIDDEN_SHARES:
        assert sum(share - 0.01 <= found <= share + 0.06 for found in shares) >= 5
    assert whole >= 5


def test_pose_does_not_matter(objects):
    turn = Rotation.random(random_state=0)
    for segmented in objects[::5]:
        moved = replace(
            segmented,
            points=turn.apply(segmented.points) + SHIFT,
            normals=turn.apply(segmented.normals),
        )
        for number in range(3):
            here = imagine_occlusion(segmented, number)
            there = imagine_occlusion(moved, number)
            assert np.array_equal(here.segments, there.segments)
            expected = turn.apply(here.segmented.points) + SHIFT
            assert np.allclose(there.segmented.points, expected, atol=1e-9)


def test_each_number_is_another_occlusion_and_the_same_each_time(objects):
    segmented = max(objects, key=lambda one: one.n_segments)
    seen = [visible_points(segmented, number) for number in range(3)]
    assert not any(np.array_equal(a, b) for a, b in pairwise(seen))
    assert np.array_equal(seen[0], visible_points(segmented, 0))


def test_nothing_is_imagined_where_nothing_would_be_left(objects):
    few = np.arange(2 * MIN_VOXELS - 1)
    segmented = objects[0]
    tiny = replace(
        segmented,
        points=segmented.points[few],
        normals=segmented.normals[few],
        segment_labels=np.zeros(len(few), np.int32),
        patch_labels=segmented.patch_labels[few],
        segment_edges=np.empty((0, 2), np.int32),
        n_segments=1,
    )
    assert imagine_occlusion(tiny, 0) is None
    for points in (np.zeros((60, 3)), np.linspace(0, 1, 60)[:, None] * [1.0, 0, 0]):
        flat = replace(
            tiny,
            points=points,
            normals=np.tile([0.0, 0, -1], (60, 1)),
            segment_labels=np.zeros(60, np.int32),
            patch_labels=np.zeros(60, np.int32),
        )
        for number in range(3):
            rest = imagine_occlusion(flat, number)
            assert rest is None or len(rest.segmented.points) >= MIN_VOXELS
