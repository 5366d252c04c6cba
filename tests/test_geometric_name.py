"""Names of scans by their shape. Bounds were chosen on scans 0 to 5 of each category; these are others."""

import re
from collections import Counter

import numpy as np
import pytest

from shapeconcepts import Scan, Segmenter
from shapeconcepts.datasets import simulate_scan
from shapeconcepts.report.geometric_name import geometric_name

UNSEEN = range(100, 112)


@pytest.mark.parametrize(
    ("category", "expected", "at_least"),
    [("box", {"box-like"}, 9), ("can", {"cylinder-like"}, 9), ("ball", {"ball-like", "rounded"}, 11)],
)
def test_simulated_things_are_called_what_they_look_like(category, expected, at_least):
    names = [geometric_name(Segmenter().segment(simulate_scan(category, i))) for i in UNSEEN]
    shapes = Counter(name.split(",")[0] for name in names)
    assert sum(shapes[one] for one in expected) >= at_least, shapes


def plane(width: float, height: float, turn: float = 0.0) -> np.ndarray:
    grid = np.stack(np.meshgrid(np.arange(0, width, 0.002), np.arange(0, height, 0.002), [0.0]), axis=-1)
    points = grid.reshape(-1, 3)
    c, s = np.cos(turn), np.sin(turn)
    return points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) + [0, 0, 0.8]


def test_a_sheet_is_a_plate_of_its_size():
    name = geometric_name(Segmenter().segment(Scan(plane(0.2, 0.1), viewpoint=np.zeros(3))))
    assert re.fullmatch(r"plate-like, 1 face, 20 × 10 × \d cm", name)


def test_small_and_large_things_have_sizes_that_can_be_read():
    small = geometric_name(Segmenter().segment(Scan(plane(0.08, 0.05), viewpoint=np.zeros(3))))
    assert re.search(r"8\.\d × 5\.\d × \d\.\d cm$", small) or re.search(
        r"7\.\d × [45]\.\d × \d\.\d cm$", small
    )
    large = geometric_name(
        Segmenter(voxel_size=0.02).segment(Scan(10 * plane(0.2, 0.1), viewpoint=np.zeros(3)))
    )
    assert re.search(r"2\.0 × 1\.0 × 0\.\d m$", large)
