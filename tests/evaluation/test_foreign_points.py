"""Foreign points: how many there are, and that they touch the object."""

from dataclasses import replace

import numpy as np
import pytest
from labelled_scans import simulated_objects
from scipy.spatial import cKDTree

from shapeconcepts import segment
from shapeconcepts.evaluation.foreign_points import (
    FOREIGN_SHARE,
    table_strip,
    touching_part,
    with_foreign_points,
)

OBJECTS = simulated_objects()
DESCRIPTOR = "surflet+fpfh+curvature"


@pytest.mark.parametrize("kind", ["part", "table"])
@pytest.mark.parametrize("share", [0.1, 0.3])
@pytest.mark.parametrize("number", [0, 7, 15])
def test_foreign_points_are_a_share_and_touch(kind, share, number):
    segmented, other = OBJECTS.segmented[number], OBJECTS.segmented[-1]
    points = segmented.points
    sight = points.mean(axis=0) - segmented.viewpoint
    rng = np.random.default_rng(number)
    if kind == "part":
        foreign = touching_part(points, sight, other.points, share, rng)
    else:
        foreign = table_strip(points, sight, share, rng)
    expected = round(share / (1 - share) * len(points))
    assert len(foreign) == (min(expected, len(other.points)) if kind == "part" else expected)
    nearest = cKDTree(points).query(foreign)[0]
    assert nearest.min() < 0.25 * np.linalg.norm(np.ptp(points, axis=0))
    # Most of it is beside the object, not within.
    assert np.median(nearest) > segmented.voxel_size
    if kind == "table":
        assert np.linalg.svd(foreign - foreign.mean(axis=0))[1][2] < 1e-9


def test_the_object_itself_stays():
    segmented, other = OBJECTS.segmented[0], OBJECTS.segmented[-1]
    for number in (0, 1):
        one = with_foreign_points(segmented, other, number, DESCRIPTOR)
        assert one.label == segmented.label and one.n_segments >= 1
        again = with_foreign_points(segmented, other, number, DESCRIPTOR)
        assert np.array_equal(one.description.whole(), again.description.whole())
    unknown = with_foreign_points(replace(segmented, viewpoint=None), other, 0, DESCRIPTOR)
    assert unknown is not None
    assert 0 < FOREIGN_SHARE < 1


@pytest.mark.parametrize("n_points", [1, 2, 3])
def test_objects_of_hardly_any_points(n_points):
    points = np.array([[0.0, 0.0, 1.0], [0.1, 0.0, 1.0], [0.0, 0.1, 1.0]])[:n_points]
    tiny = segment(points)
    for number in (0, 1):
        one = with_foreign_points(tiny, OBJECTS.segmented[-1], number, DESCRIPTOR)
        assert one is None or one.n_segments >= 1
        assert with_foreign_points(OBJECTS.segmented[0], tiny, number, DESCRIPTOR) is not None
