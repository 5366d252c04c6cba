"""Supervised selection: surfaces, the rule that chooses, and what it may look at."""

from dataclasses import replace

import numpy as np
import pytest
from labelled_scans import simulated_objects

import shapeconcepts
from shapeconcepts.concepts import ConceptResponse
from shapeconcepts.evaluation import grouping_scores, stratified_splits, svm_errors
from shapeconcepts.evaluation.experiments.folds import stratified_folds
from shapeconcepts.evaluation.experiments.supervised import (
    Surfaces,
    choose,
    fold_surfaces,
    supervised_selection,
)

OBJECTS = simulated_objects()
SPLITS = stratified_splits(OBJECTS.labels, 2, 0.25, 0)
NUMBERS, SIZES = (2, 3, 4, 60), (2, 3)


def surfaces(purity: list, error: list, coverage: list) -> Surfaces:
    """Of one fold, (1, a, b)."""
    return Surfaces(*(np.array([surface], float) for surface in (purity, error, coverage)))


def test_lowest_error_wins() -> None:
    given = surfaces([[0.9, 0.8], [0.9, 0.7]], [[0.3, 0.1], [0.2, 0.4]], [[0.9, 0.9], [0.9, 0.9]])
    assert choose(given, (5, 10), (2, 3)) == (5, 3)


def test_purity_decides_within_a_standard_error() -> None:
    error = np.array([[[0.10, 0.12]], [[0.20, 0.22]]])
    coverage = np.full((2, 1, 2), 0.8)
    purity = np.array([[[0.8, 0.9]]] * 2)
    assert choose(Surfaces(purity, error, coverage), (5,), (2, 3)) == (5, 3)
    # Without any spread between the folds, the small difference counts.
    assert choose(Surfaces(purity, error[[0, 0]], coverage), (5,), (2, 3)) == (5, 2)


def test_too_little_coverage_and_numbers_that_are_not_reached_are_left_out() -> None:
    given = surfaces([[1.0, 0.8, 0.7]], [[0.0, 0.1, np.nan]], [[0.5, 0.8, np.nan]])
    assert choose(given, (5,), (2, 3, 4)) == (5, 3)
    sparse = surfaces([[1.0, 0.8]], [[0.0, 0.1]], [[0.5, 0.3]])
    assert choose(sparse, (5,), (2, 3)) == (5, 2)


def test_few_large_concepts_break_ties() -> None:
    given = surfaces([[0.9, 0.9]] * 2, [[0.1, 0.1]] * 2, [[0.8, 0.8]] * 2)
    assert choose(given, (5, 10), (2, 3)) == (5, 3)


def test_nothing_reached_gives_the_first() -> None:
    nothing = np.full((3, 2, 2), np.nan)
    assert choose(Surfaces(nothing, nothing, nothing), (5, 10), (2, 3)) == (5, 2)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_surfaces_are_those_of_concepts_at_a_time(preset: str) -> None:
    described, labels = OBJECTS.described[preset], OBJECTS.labels
    fitted, left_out = stratified_folds(labels, 4, 0)[0]
    found = fold_surfaces(described, labels, (fitted, left_out), preset, NUMBERS, SIZES)
    model = shapeconcepts.ShapeConceptModel.preset(preset).fit([described[i] for i in fitted])
    filtration = model.filtration_
    times = np.unique(filtration.times_)
    seen = 0
    for i, number in enumerate(NUMBERS):
        for j, size in enumerate(SIZES):
            exact = [t for t in times if len(filtration.groups_at(t, size)) == number]
            if not exact:
                continue
            seen += 1
            concept_of = np.full(len(fitted), -1)
            for k, concept in enumerate(filtration.groups_at(exact[-1], size)):
                concept_of[concept.members] = k
            scores = grouping_scores(concept_of, labels[fitted])
            response = ConceptResponse(model.response_.distance).fit(model.stimuli_, concept_of)
            errors = svm_errors(
                response.transform(model.stimuli_),
                labels[fitted],
                response.transform(model.stimuli([described[m] for m in left_out])),
                labels[left_out],
                "response",
            )
            assert found.purity[i, j] == pytest.approx(scores.mean_purity)
            assert found.coverage[i, j] == pytest.approx(scores.coverage)
            assert found.error[i, j] == pytest.approx(np.mean(list(errors.values())))
    assert seen >= 3
    assert np.isnan(found.error[3]).all()


def test_the_choice_looks_at_no_test_label() -> None:
    _, test = SPLITS[0]
    labels = OBJECTS.labels.copy()
    labels[test] = np.roll(labels[test], 1)
    results = [
        supervised_selection(one, "default", SPLITS[:1], numbers=NUMBERS, sizes=SIZES)
        for one in (OBJECTS, replace(OBJECTS, labels=labels))
    ]
    assert results[0].choices == results[1].choices == [results[0].chosen]
    assert np.array_equal(results[0].error, results[1].error, equal_nan=True)
    assert results[0].errors != results[1].errors


def test_result_fits_together() -> None:
    result = supervised_selection(OBJECTS, "default", SPLITS, numbers=NUMBERS, sizes=SIZES)
    assert 60 not in result.numbers
    at = (result.numbers.tolist().index(result.chosen[0]), result.sizes.tolist().index(result.chosen[1]))
    assert result.chosen_error == result.error[at]
    assert result.chosen_purity == result.purity[at]
    assert result.chosen_coverage == result.coverage[at]
    assert result.purity.shape == result.error.shape == result.coverage.shape == (len(result.numbers), 2)
    assert result.purity_with_five is None
    assert len(result.choices) == len(result.scores) == 2
    again = supervised_selection(OBJECTS, "default", SPLITS, numbers=NUMBERS, sizes=SIZES)
    assert again.errors == result.errors
    assert again.choices == result.choices
