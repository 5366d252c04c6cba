"""Baselines on the splits of the experiments."""

from collections import Counter

import pytest
from labelled_scans import simulated_objects

from shapeconcepts.evaluation import grouping_baselines, grouping_scores, most_groups, stratified_splits
from shapeconcepts.evaluation.experiments.baseline_comparison import baseline_comparison
from shapeconcepts.evaluation.experiments.concept_responses import fit

OBJECTS = simulated_objects()
SPLITS = stratified_splits(OBJECTS.labels, 2, 0.25, 0)
OF_WHOLE_OBJECTS = ["mean FPFH", "surflet", "ESF", "Point-NN", "whole object"]


@pytest.fixture(scope="module")
def compared():
    """Groupings, classifications, and how many tasks each step had."""
    totals = []

    def progress(items, total, description):
        totals.append(total)
        return items

    return *baseline_comparison(OBJECTS, "default", SPLITS, progress=progress), totals


def test_every_representation_is_grouped_by_every_method(compared) -> None:
    groupings, _, totals = compared
    assert len({(row.representation, row.grouping) for row in groupings}) == len(groupings)
    assert Counter(row.representation for row in groupings) == {
        **dict.fromkeys(OF_WHOLE_OBJECTS, 13),
        "motif stimuli": 12,
        "bag of FPFH words": 1,
    }
    most = most_groups(len(SPLITS[0][0]))
    for row in groupings:
        assert len(row.scores) == len(row.parameters) == 2
        assert row.grouping == "our filtration" or all(scores.n_groups <= most for scores in row.scores)
    assert totals == [36, 10, 2, 2]


def test_what_others_do_not_classify_is_classified(compared) -> None:
    _, classifications, _ = compared
    assert [row.representation for row in classifications] == [*OF_WHOLE_OBJECTS, "bag of FPFH words"]
    for row in classifications:
        assert {label: len(errors) for label, errors in row.errors.items()} == dict.fromkeys(
            ["ball", "box", "can"], 2
        )


def test_stimuli_are_those_of_the_model_of_the_training_part(compared) -> None:
    groupings, _, _ = compared
    training, _ = SPLITS[1]
    model = fit([OBJECTS.described["default"][i] for i in training], "default")
    expected = grouping_baselines(model.stimuli_, most_groups(len(training)))
    for row in groupings:
        if row.representation == "motif stimuli":
            assert row.scores[1] == grouping_scores(expected[row.grouping].labels, OBJECTS.labels[training])
    assert expected["our filtration"].labels.tolist() == model.labels_.tolist()
