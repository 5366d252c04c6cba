"""Found and true objects of a scene, matched."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from shapeconcepts.evaluation.object_detection import match_objects, touching_objects

# 100 points of a table, 40 of the object 20 in two parts, 20 of the object 30, 10 that do not count.
LABELS = np.repeat([1, 20, 21, 30, 0], [100, 30, 10, 20, 10])
FIRST, SECOND, UNCOUNTED = np.arange(100, 140), np.arange(140, 160), np.arange(160, 170)


def test_what_is_found_exactly_matches():
    matches = match_objects(LABELS, [SECOND, FIRST])
    assert_array_equal(matches.labels, [20, 30])
    assert_array_equal(matches.n_points, [40, 20])
    assert_array_equal(matches.found_by, [1, 0])
    assert_allclose(matches.overlaps, 1.0)
    assert_array_equal(matches.main_labels, [30, 20])
    assert matches.is_right.all()


def test_three_quarters_are_enough():
    assert match_objects(LABELS, [FIRST[:30]]).is_found[0]
    assert not match_objects(LABELS, [FIRST[:29]]).is_found[0]
    assert match_objects(LABELS, [np.r_[FIRST[:36], 0:8]]).is_found[0]
    assert not match_objects(LABELS, [np.r_[FIRST[:36], 0:9]]).is_found[0]


def test_points_without_a_label_do_not_count():
    matches = match_objects(LABELS, [np.r_[SECOND, UNCOUNTED], UNCOUNTED])
    assert_allclose(matches.overlaps, [0.0, 1.0])
    assert_array_equal(matches.is_right, [True, False])


def test_an_object_is_found_once():
    matches = match_objects(LABELS, [FIRST[:32], FIRST, FIRST[:36]])
    assert_array_equal(matches.found_by, [1, -1])
    assert_array_equal(matches.is_right, [False, True, False])


def test_objects_left_together_are_told():
    matches = match_objects(LABELS, [np.r_[FIRST, SECOND]])
    assert_array_equal(matches.is_found, [False, False])
    assert_array_equal(matches.joined_in, [0, 0])
    assert_array_equal(match_objects(LABELS, [FIRST, SECOND]).joined_in, [-1, -1])
    # With as much of the table, it is no object any more.
    assert_array_equal(match_objects(LABELS, [np.r_[FIRST, SECOND, 0:30]]).joined_in, [-1, -1])


def test_what_lies_on_the_background_is_no_object():
    matches = match_objects(LABELS, [np.arange(50), np.r_[FIRST[:10], 0:11], []])
    assert_array_equal(matches.main_labels, [0, 0, 0])
    assert not matches.is_right.any()


def test_nothing_may_be_found_or_there():
    assert not match_objects(LABELS, []).is_found.any()
    matches = match_objects(np.ones(9, int), [np.arange(3)])
    assert len(matches.labels) == 0
    assert_array_equal(matches.is_right, [False])


def test_an_image_of_labels_is_taken_row_by_row():
    assert_array_equal(match_objects(LABELS.reshape(17, 10), [FIRST]).is_found, [True, False])


def test_a_place_that_does_not_exist_is_named():
    with pytest.raises(ValueError, match=r"predicted\[1\] must hold places from 0 to 169, got 3 to 170"):
        match_objects(LABELS, [FIRST, [3, 170]])


def test_objects_within_a_centimetre_touch():
    x = np.arange(0.0, 0.5, 0.005)
    points = np.column_stack([x, np.zeros_like(x), np.ones_like(x)])
    labels = np.select([x < 0.1, x < 0.2, x > 0.25], [20, 31, 40], 1)
    assert touching_objects(points, labels) == {20, 30}
    points[(x > 0.098) & (x < 0.108)] = np.nan
    assert touching_objects(points.reshape(10, 10, 3), labels.reshape(10, 10)) == set()
