"""Unsupervised selection, and the number of levels."""

import os

import numpy as np
import pytest
from labelled_scans import simulated_objects
from sklearn.metrics import accuracy_score, adjusted_mutual_info_score
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

import shapeconcepts
from shapeconcepts.evaluation import stratified_splits
from shapeconcepts.evaluation.experiments.levels import number_of_levels
from shapeconcepts.evaluation.experiments.unsupervised import select, unsupervised_selection
from shapeconcepts.evaluation.labelled_objects import run

OBJECTS = simulated_objects()
SPLITS = stratified_splits(OBJECTS.labels, 2, 0.25, 0)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_scores_and_errors_are_those_of_the_model(preset: str) -> None:
    result, on_stimuli = unsupervised_selection(OBJECTS, preset, SPLITS)
    assert result.preset == preset
    assert len(result.scores) == 2
    for repetition, (training, test) in enumerate(SPLITS):
        model = shapeconcepts.ShapeConceptModel.preset(preset)
        model.fit([OBJECTS.described[preset][i] for i in training])
        scores = result.scores[repetition]
        assert scores.n_groups == len(model.concepts_) > 1
        assert scores.coverage == pytest.approx((model.labels_ >= 0).mean())
        alone = np.where(model.labels_ >= 0, model.labels_, np.arange(len(training)) + 1000)
        expected = adjusted_mutual_info_score(OBJECTS.labels[training], alone)
        assert scores.adjusted_mutual_information == pytest.approx(expected)

        known = model.response_.transform(model.stimuli_)
        new = model.transform([OBJECTS.described[preset][i] for i in test])
        assert not np.isnan(known).any()
        assert not np.isnan(new).any()
        scaler = StandardScaler().fit(known)
        machine = SVC(C=10, gamma="scale").fit(scaler.transform(known), OBJECTS.labels[training])
        predicted = machine.predict(scaler.transform(new))
        for label, errors in result.errors.items():
            of_label = OBJECTS.labels[test] == label
            assert errors[repetition] == pytest.approx(
                1 - accuracy_score(OBJECTS.labels[test][of_label], predicted[of_label])
            )
    assert on_stimuli.representation == f"motif stimuli, {preset}"
    assert {label: len(errors) for label, errors in on_stimuli.errors.items()} == dict.fromkeys(
        ["ball", "box", "can"], 2
    )


def test_bars_are_ranked_by_equation_five() -> None:
    result, _ = unsupervised_selection(OBJECTS, "default", SPLITS)
    assert len(result.bars) == result.scores[0].n_groups
    for bar in result.bars:
        assert sum(bar.proportions.values()) == pytest.approx(1)
        assert bar.purity == max(bar.proportions.values()) == next(iter(bar.proportions.values()))
        assert bar.rank_score == pytest.approx(bar.size / (1 - bar.purity + 1e-3))
    ranks = [bar.rank_score for bar in result.bars]
    assert ranks == sorted(ranks)
    assert np.mean([bar.purity for bar in result.bars]) == pytest.approx(result.scores[0].mean_purity)


def test_filtration_is_that_of_the_first_repetition() -> None:
    result, _ = unsupervised_selection(OBJECTS, "default", SPLITS)
    filtration = result.filtration
    n_left = int(np.isinf(np.array(filtration.diagram, float)[:, 1]).sum())
    assert filtration.counts.sum() == len(filtration.diagram) - n_left and n_left == 1
    assert filtration.concept_time is not None and 0.75 <= filtration.concept_time <= 1 - 1 / 12
    assert result.unplaced == 0


def test_labels_do_not_change_what_is_found() -> None:
    described, labels = OBJECTS.described["default"], OBJECTS.labels
    one = select(described, labels, SPLITS[0], "default", False)
    other = select(described, np.random.default_rng(0).permutation(labels), SPLITS[0], "default", False)
    assert (one.scores.n_groups, one.scores.coverage) == (other.scores.n_groups, other.scores.coverage)
    assert [bar.size for bar in one.bars] != []
    assert one.scores.mean_purity > other.scores.mean_purity


def test_several_processes_give_the_same() -> None:
    one, _ = unsupervised_selection(OBJECTS, "default", SPLITS, n_jobs=1)
    two, _ = unsupervised_selection(OBJECTS, "default", SPLITS, n_jobs=2)
    assert one.scores == two.scores
    assert one.errors == two.errors
    assert one.bars == two.bars


def test_work_is_done_by_processes() -> None:
    """Its filters of warnings, and limits of threads, are of a process."""
    assert os.getpid() not in run(os.getpid, [()] * 4, 2, None, "")


def test_no_concept_is_a_result_too() -> None:
    """Two training objects cannot make a concept of at least three."""
    labels = OBJECTS.labels
    few = np.array([*np.flatnonzero(labels == "box")[:1], *np.flatnonzero(labels == "can")[:1]])
    test = np.setdiff1d(np.flatnonzero(labels != "ball"), few)
    found = select(OBJECTS.described["default"], labels, (few, test), "default", True)
    assert found.scores.n_groups == 0
    assert found.scores.coverage == 0
    assert found.bars == []
    assert sorted(found.errors.values()) == [0, 1]
    assert found.filtration is not None
    assert found.filtration.concept_time is None


def test_levels_are_the_preset_with_other_levels() -> None:
    result = number_of_levels(OBJECTS, "paper", SPLITS, levels=(1, 3))
    assert result.levels == [1, 3]
    for level, scores, errors in zip((1, 3), result.scores, result.errors, strict=True):
        for repetition, split in enumerate(SPLITS):
            changed = {"ensemble__dictionary__n_levels": level}
            expected = select(OBJECTS.described["paper"], OBJECTS.labels, split, "paper", False, **changed)
            assert scores[repetition] == expected.scores
            assert errors[repetition] == pytest.approx(np.mean(list(expected.errors.values())))
    assert result.scores[0] != result.scores[1]
