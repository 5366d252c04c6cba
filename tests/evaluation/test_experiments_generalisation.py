"""The map of several data sets."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from labelled_scans import segmented_scans, simulated_objects

from shapeconcepts.evaluation import stratified_splits
from shapeconcepts.evaluation.experiments.generalisation import CELLS, generalisation, majority_labels
from shapeconcepts.evaluation.labelled_objects import labelled_objects

OBJECTS = simulated_objects()
SPLIT = stratified_splits(OBJECTS.labels, 1, 0.25, 0)[0]
OTHERS = labelled_objects(
    [replace(one, label="tin" if one.label == "can" else one.label) for one in segmented_scans(4, 7)],
    "others",
    ["default"],
)


@pytest.fixture(scope="module")
def concept_map():
    return generalisation(OBJECTS, [OTHERS], "default", SPLIT)


@given(seed=st.integers(0, 1000), n=st.integers(1, 30), data=st.data())
def test_majority_is_that_of_the_nearest(seed: int, n: int, data: st.DataObject) -> None:
    k = data.draw(st.integers(1, n))
    rng = np.random.default_rng(seed)
    positions, places = rng.random((n, 2)), rng.random((5, 2))
    labels = rng.choice(["a", "b", "c"], n)
    majority, share = majority_labels(places, positions, labels, k)
    for place, label, of_label in zip(places, majority, share, strict=True):
        order = sorted(range(n), key=lambda i: np.hypot(*(positions[i] - place)))
        nearest = [str(labels[i]) for i in order[:k]]
        assert label == max(sorted(set(nearest)), key=nearest.count)
        assert of_label == pytest.approx(nearest.count(str(label)) / k)


def test_everything_is_on_the_map(concept_map) -> None:
    n = len(concept_map.labels)
    assert n + sum(concept_map.unplaced.values()) == len(OBJECTS.labels) + len(OTHERS.labels)
    assert concept_map.positions.shape == (n, 2)
    assert np.isfinite(concept_map.positions).all()
    assert set(concept_map.data_set) == {"simulated, training", "simulated, testing", "others"}
    assert concept_map.label_names == ["ball", "box", "can", "tin"]
    assert concept_map.majority.shape == concept_map.share.shape == (CELLS, CELLS)
    assert concept_map.k == max(1, round(0.05 * n))
    for axis, grid in zip(concept_map.positions.T, (concept_map.grid_x, concept_map.grid_y), strict=True):
        step = grid[1] - grid[0]
        assert np.allclose(np.diff(grid), step)
        assert axis.min() - 3 * step < grid[0] - step / 2 < axis.min()
        assert axis.max() < grid[-1] + step / 2 < axis.max() + 3 * step


def test_matrices_and_shares_count_the_same_objects(concept_map) -> None:
    regions = []
    for x, y in concept_map.positions:
        column = np.abs(concept_map.grid_x - x).argmin()
        row = np.abs(concept_map.grid_y - y).argmin()
        regions.append(concept_map.majority[row, column])
    regions = np.array(regions)
    names = concept_map.label_names
    for i, one in enumerate(names):
        in_region, of_label = regions == one, concept_map.labels == one
        for j, other in enumerate(names):
            if in_region.any():
                share = (concept_map.labels[in_region] == other).mean()
                assert concept_map.region_of_labels[i, j] == pytest.approx(share)
            else:
                assert concept_map.region_of_labels[i, j] == 0
            assert concept_map.labels_to_regions[i, j] == pytest.approx((regions[of_label] == other).mean())
    for name, by_label in concept_map.nearest_region_right.items():
        for label, share in by_label.items():
            chosen = (concept_map.data_set == name) & (concept_map.labels == label)
            assert share == pytest.approx((regions[chosen] == label).mean())


def test_only_the_trained_decide_in_the_stricter_share(concept_map) -> None:
    assert set(concept_map.nearest_trained_right["others"]) == {"ball", "box"}
    renamed = replace(OTHERS, labels=np.where(OTHERS.labels == "box", "ball", OTHERS.labels))
    other = generalisation(OBJECTS, [renamed], "default", SPLIT)
    assert other is not None
    for name in ("simulated, training", "simulated, testing"):
        assert other.nearest_trained_right[name] == concept_map.nearest_trained_right[name]
    assert np.array_equal(other.positions, concept_map.positions)


def test_no_concept_gives_no_map() -> None:
    assert generalisation(OBJECTS, [], "default", (np.array([0, 12]), np.array([1]))) is None
