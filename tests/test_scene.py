"""Scenes: what is accepted, and what the errors say."""

import numpy as np
import pytest

from shapeconcepts import ScanError, Scene


def test_a_scene_may_be_organised_or_not():
    assert not Scene(np.zeros((5, 3))).is_organised
    assert Scene(np.zeros((4, 5, 3)), point_labels=np.zeros((4, 5))).is_organised


def test_the_upward_direction_has_the_length_1():
    assert np.allclose(Scene(np.zeros((1, 3)), up=(0, -2, 0)).up, (0, -1, 0))


def test_a_scene_keeps_a_copy():
    points = np.zeros((3, 3))
    scene = Scene(points)
    points[0] = 1.0
    assert not scene.points.any()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (
            {"points": np.zeros((5, 2))},
            r"points must have shape \(n, 3\) or \(height, width, 3\), got \(5, 2\)",
        ),
        ({"points": np.zeros(3)}, "points must have shape"),
        ({"points": [["a", "b", "c"]]}, "points must be numbers"),
        ({"viewpoint": (0, np.nan, 0)}, "viewpoint must be 3 finite numbers"),
        ({"up": (0, 0)}, "up must be 3 finite numbers"),
        ({"up": (0, 0, 0)}, "up must be a direction"),
        ({"time": np.inf}, "time must be seconds since 1970, got inf"),
        ({"point_labels": [0, 1]}, r"point_labels must have shape \(1,\), got \(2,\)"),
        ({"point_labels": [0.5]}, "point_labels must be whole numbers, got 0.5"),
    ],
)
def test_what_does_not_fit_is_told(given, told):
    with pytest.raises(ScanError, match=f"kitchen: {told}"):
        Scene(**{"points": np.zeros((1, 3)), "name": "kitchen", **given})
