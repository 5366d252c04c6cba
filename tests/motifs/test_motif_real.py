"""Motifs of the simulated yardstick's scans, and of recorded ones."""

import numpy as np
import pytest
from motif_objects import assert_same_rows
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

from shapeconcepts import (
    DescribedObject,
    MotifHierarchyEnsemble,
    Scan,
    SegmentDictionary,
    describe,
    read_scan,
    segment,
)
from shapeconcepts.segmentation import SegmentedObject

CATEGORIES = ["amphora", "ball", "box", "can", "plate", "sack", "teddy"]
N_SCANS = 7

pytestmark = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")


@pytest.fixture(scope="module")
def scans(shared_data) -> list[Scan]:
    files = [sorted((shared_data / "seven_shapes" / category).iterdir()) for category in CATEGORIES]
    assert min(map(len, files)) >= N_SCANS
    return [
        read_scan(path)
        for of_category in files
        for path in of_category[:: len(of_category) // N_SCANS][:N_SCANS]
    ]


@pytest.fixture(scope="module")
def segmented(scans) -> list[SegmentedObject]:
    return [segment(scan) for scan in scans]


@pytest.fixture(
    scope="module", params=[("surflet", "motifs"), ("fpfh", "motifs"), ("surflet+fpfh", "prototypes")]
)
def descriptor_and_columns(request) -> tuple[str, str]:
    return request.param


@pytest.fixture(scope="module")
def descriptor(descriptor_and_columns) -> str:
    return descriptor_and_columns[0]


@pytest.fixture(scope="module")
def objects(segmented, descriptor) -> list[DescribedObject]:
    return [describe(one, descriptor) for one in segmented]


@pytest.fixture(scope="module")
def model(objects, descriptor_and_columns) -> MotifHierarchyEnsemble:
    return MotifHierarchyEnsemble(SegmentDictionary(5), descriptor_and_columns[1]).fit(objects)


def moved(scan: Scan, rng: np.random.Generator) -> Scan:
    rotation = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    shift = rng.uniform(-1, 1, 3)
    viewpoint = np.zeros(3) if scan.viewpoint is None else scan.viewpoint
    return Scan(
        scan.points @ rotation.T + shift,
        viewpoint=None if scan.viewpoint is None else rotation @ viewpoint + shift,
        name=scan.name,
        label=scan.label,
    )


def distances(rows, others) -> np.ndarray:
    """Jensen-Shannon distance between the shares of stimuli, (n, m)."""
    a, b = (matrix.toarray() / matrix.sum(axis=1).reshape(-1, 1) for matrix in (rows, others))
    # The root of a rounding error below zero is not a number.
    return np.nan_to_num(cdist(np.asarray(a), np.asarray(b), "jensenshannon"))


def test_moved_scan_finds_its_original(model, scans, objects, descriptor):
    rng = np.random.default_rng(0)
    moved_objects = [describe(segment(moved(scan, rng)), descriptor) for scan in scans[::2]]
    rows = model.transform(objects)
    assert (np.diff(rows.indptr) > 0).all()
    from_original = distances(model.transform(moved_objects), rows)
    is_nearest = from_original <= from_original.min(axis=1, keepdims=True) + 1e-6
    found = is_nearest[np.arange(len(moved_objects)), np.arange(0, len(scans), 2)]
    assert found.mean() >= 0.95, [scan.name for scan, one in zip(scans[::2], found, strict=True) if not one]
    # Not because all rows are equal.
    assert is_nearest.sum(axis=1).max() <= 2


def test_order_of_points_does_not_matter(model, scans, objects, descriptor):
    rng = np.random.default_rng(1)
    for index in range(0, len(scans), 6):
        order = rng.permutation(len(scans[index].points))
        scan = Scan(scans[index].points[order], viewpoint=scans[index].viewpoint)
        one = describe(segment(scan), descriptor)
        expected, actual = (model.transform([each]).toarray() for each in (objects[index], one))
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-6, err_msg=scan.name)


def test_row_is_the_same_alone_in_parts_and_with_more_jobs(model, objects):
    rows = model.transform(objects)
    for index in (0, 17, 48):
        assert_same_rows(model.transform([objects[index]]), rows[index])
    parts = MotifHierarchyEnsemble(model.dictionary_, model.columns, n_jobs=2)
    parts.partial_fit(objects[:20]).partial_fit(objects[20:])
    assert parts.get_feature_names_out().tolist() == model.get_feature_names_out().tolist()
    assert_same_rows(parts.stimuli_, model.stimuli_)
    assert_same_rows(parts.transform(objects[::-1]), rows[::-1])


def test_explanations_name_scans(model, scans, objects):
    names = [scan.name for scan in scans]
    assert model.hierarchies_.object_names == tuple(names)
    for index in range(0, len(scans), 10):
        explanation = model.explain(objects[index])
        assert explanation.motifs
        for motif in explanation.motifs:
            assert all(one.object_name == names[one.object_index] for one in motif.closest)
            assert motif.closest[0].object_index == index or motif.closest[0].divergence < 1e-6


def test_motifs_tell_shapes_apart(model, scans):
    """The row nearest to a training row that leaves the object's own prototypes out has the same label."""
    rows = model.stimuli_
    labels = np.array([scan.label or scan.name.split("_")[0] for scan in scans])
    has_stimuli = np.diff(rows.indptr) > 0
    assert has_stimuli.mean() > 0.9
    rows, labels = rows[has_stimuli], labels[has_stimuli]
    between = distances(rows, rows)
    np.fill_diagonal(between, np.inf)
    assert (labels[between.argmin(axis=1)] == labels).mean() > 0.5


@pytest.mark.parametrize(
    ("describing", "columns"), [({"descriptor": "surflet"}, "motifs"), ({}, "prototypes")], ids=str
)
@pytest.mark.parametrize("category", ["milk", "bowl"])
def test_recorded_views_have_motifs(shared_data, category, describing, columns):
    files = sorted((shared_data / "restaurant_views" / category).iterdir())[:16:2]
    objects = [describe(segment(read_scan(path)), **describing) for path in files]
    model = MotifHierarchyEnsemble(SegmentDictionary(2), columns).fit(objects[:-2])
    assert (np.diff(model.stimuli_.indptr) > 0).all()
    rows = model.transform(objects[-2:])
    assert (np.diff(rows.indptr) > 0).all()
