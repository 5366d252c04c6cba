"""Whole-object rows, their groupings, and topics over words."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from sklearn.metrics import adjusted_rand_score

from shapeconcepts import datasets, describe, segment
from shapeconcepts.descriptors import compute_fpfh
from shapeconcepts.evaluation import (
    TopicModel,
    baseline_rows,
    ensemble_of_shape_functions,
    grouping_baselines,
    grouping_scores,
    point_histograms,
    point_nn,
    svm_errors,
    whole_object_rows,
)
from shapeconcepts.evaluation.libraries import GROUPING_LIBRARIES


@pytest.fixture(scope="module")
def objects():
    return [segment(scan) for scan in datasets.simulate(n_per_category=4, random_state=5)]


def documents(seed: int = 0) -> tuple[list[np.ndarray], np.ndarray]:
    """Objects of three kinds whose points have histograms of their own two corners of six."""
    rng = np.random.default_rng(seed)
    kinds = np.repeat(np.arange(3), 10)
    corners = 0.05 + 40 * np.eye(6)
    return [
        np.sqrt([rng.dirichlet(corners[2 * kind + rng.integers(2)]) for _ in range(50)]) for kind in kinds
    ], kinds


def test_rows_are_those_of_whole_objects(objects) -> None:
    rows = baseline_rows(objects)
    assert {name: matrix.shape for name, matrix in rows.items()} == {
        "mean FPFH": (28, 33),
        "surflet": (28, 135),
        "ESF": (28, 640),
        "Point-NN": (28, 1152),
    }
    for matrix in rows.values():
        assert (matrix >= 0).all()
        assert matrix.sum(axis=1) == pytest.approx(1)
    one = objects[3]
    of_points = compute_fpfh(one.points, one.normals, 0.03)[one.segment_labels >= 0].sum(axis=0)
    assert rows["mean FPFH"][3] == pytest.approx(of_points / of_points.sum())
    assert np.array_equal(rows["surflet"][3], describe(one, "surflet").description.whole())
    assert np.array_equal(rows["ESF"][3], ensemble_of_shape_functions(one.points))
    assert np.array_equal(rows["Point-NN"][3], point_nn(one.points))


def test_whole_objects_are_constellations_of_all_segments(objects) -> None:
    described = [describe(one) for one in objects[:3]]
    everything = [one.description.histograms([2**one.n_segments - 1])[0] for one in described]
    assert np.array_equal(whole_object_rows(described), everything)


def test_every_method_groups_by_every_choice(objects) -> None:
    labels = [one.label for one in objects]
    rows = baseline_rows(objects)["surflet"]
    groupings = grouping_baselines(rows, 9)
    assert list(groupings) == [
        *(
            f"{method}, {choice}"
            for method in ("k-means", "average linkage", "HDBSCAN", "ToMATo", "Leiden")
            for choice in ("silhouette", "most groups")
        ),
        "PLSCAN",
        "our filtration",
        "our filtration, silhouette",
    ]
    ours = groupings.pop("our filtration")
    assert ours.labels.shape == (28,)
    for grouping in groupings.values():
        assert grouping.labels.shape == (28,)
        assert grouping.n_groups <= 9
        assert grouping.parameters
    assert grouping_scores(groupings["k-means, most groups"].labels, labels).explained > 0.7


def test_stimuli_are_grouped_as_they_are(objects) -> None:
    """Sparse, of any length, and with rows that are empty."""
    rows = baseline_rows(objects)["surflet"]
    rows[5] = 0
    lengths = np.random.default_rng(0).uniform(0.1, 9, (28, 1))
    expected = grouping_baselines(rows, 5)
    for name, grouping in grouping_baselines(csr_matrix(rows * lengths), 5).items():
        assert adjusted_rand_score(grouping.labels, expected[name].labels) == 1


def test_topics_find_kinds_that_share_no_words() -> None:
    model = TopicModel(max_groups=6, n_words=12).fit(documents()[0])
    kinds = documents()[1]
    assert model.rows_.shape == (30, model.grouping_.parameters["topics"])
    assert model.rows_.sum(axis=1) == pytest.approx(1)
    assert grouping_scores(model.grouping_.labels, kinds.astype(str)).mean_purity == 1
    new, new_kinds = documents(1)
    rows = model.transform(new)
    errors = svm_errors(model.rows_, kinds.astype(str), rows, new_kinds.astype(str), "histogram")
    assert errors == {"0": 0, "1": 0, "2": 0}


def test_topics_are_the_same_every_time() -> None:
    first, second = (TopicModel(max_groups=4, n_words=8).fit(documents()[0]) for _ in range(2))
    assert np.array_equal(first.rows_, second.rows_)
    assert first.grouping_.parameters == second.grouping_.parameters
    assert adjusted_rand_score(first.grouping_.labels, second.grouping_.labels) == 1
    alone = first.transform(documents(1)[0][:1])
    assert np.allclose(alone, first.transform(documents(1)[0])[:1])


def test_an_object_without_words_has_even_topics() -> None:
    model = TopicModel(max_groups=4, n_words=8).fit([*documents()[0], np.empty((0, 6))])
    assert model.rows_[-1] == pytest.approx(1 / model.rows_.shape[1])


def test_point_histograms_have_length_1(objects) -> None:
    histograms = point_histograms(objects[0])
    assert histograms.shape[1] == 33
    assert np.linalg.norm(histograms, axis=1) == pytest.approx(1)


def test_unsuitable_documents_are_refused() -> None:
    with pytest.raises(ValueError, match="objects must be at least 5, got 4"):
        TopicModel(4).fit(documents()[0][:4])
    with pytest.raises(ValueError, match="must have points with histograms, got none"):
        TopicModel(4).fit([np.empty((0, 6))] * 5)
    with pytest.raises(ValueError, match="n_words must be an integer of at least 2, got 1"):
        TopicModel(4, n_words=1).fit(documents()[0])
    with pytest.raises(ValueError, match="max_groups must be an integer of at least 2, got 0"):
        TopicModel(0).fit(documents()[0])


def test_libraries_are_imported_only_when_they_group() -> None:
    program = f"import sys, shapeconcepts.evaluation; print(*(set(sys.modules) & {set(GROUPING_LIBRARIES)}))"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""


def test_topics_tell_real_boxes_from_real_cans(shared_data) -> None:
    scans = datasets.load_osd(shared_data / "osd_learn")
    objects = [point_histograms(segment(scan)) for scan in scans]
    model = TopicModel(max_groups=9).fit(objects)
    assert grouping_scores(model.grouping_.labels, [scan.label for scan in scans]).explained > 0.85
