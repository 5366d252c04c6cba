"""Recognition of test objects of which a part is hidden."""

import numpy as np
import pytest
from labelled_scans import simulated_objects
from sklearn.neighbors import KNeighborsClassifier

import shapeconcepts
from shapeconcepts.evaluation import stratified_splits
from shapeconcepts.evaluation.experiments.hidden_parts import ROWS, hidden_parts
from shapeconcepts.evaluation.foreign_points import with_foreign_points
from shapeconcepts.topology import jensen_shannon_divergences

OBJECTS = simulated_objects()
SPLITS = stratified_splits(OBJECTS.labels, 2, 0.25, 0)


def test_errors_are_those_of_the_model_and_of_nearest_histograms() -> None:
    result = hidden_parts(OBJECTS, "default", SPLITS)
    assert result is not None and tuple(row.recognised_by for row in result.rows) == ROWS
    described, labels = OBJECTS.described["default"], OBJECTS.labels
    for repetition, (training, test) in enumerate(SPLITS):
        model = shapeconcepts.ShapeConceptModel().fit([described[i] for i in training])
        hidden = [(rest, labels[i]) for i in test for rest, _ in described[i].occlusions]
        assert len(hidden) > len(test)
        for some, truth, errors in (
            ([described[i] for i in test], labels[test], [row.nothing_hidden for row in result.rows]),
            ([one for one, _ in hidden], np.array([label for _, label in hidden]),
             [row.part_hidden for row in result.rows]),
            (*with_something_foreign(test), [row.foreign for row in result.rows]),
        ):  # fmt: skip
            wrong = 0
            for concept, label in zip(model.predict(some).tolist(), truth, strict=True):
                members = labels[training][model.concepts_[concept].members] if concept >= 0 else []
                names, counts = np.unique(members, return_counts=True)
                wrong += concept < 0 or names[counts.argmax()] != label
            assert errors[0][repetition] == pytest.approx(wrong / len(truth))

            rows = np.array([one.description.whole() for one in some])
            known = np.array([described[i].description.whole() for i in training])
            machine = KNeighborsClassifier(5, metric="precomputed")
            machine.fit(jensen_shannon_divergences(known, known), labels[training])
            predicted = machine.predict(jensen_shannon_divergences(rows, known))
            # Where two labels are equally frequent, ours takes the nearer one.
            assert errors[2][repetition] == pytest.approx((predicted != truth).mean(), abs=1.1 / len(truth))
            reminders = model.ensemble_.reminders(some).toarray()
            by_label = [
                max(np.unique(labels), key=lambda one: row[labels[training] == one].sum())
                for row in reminders
            ]
            assert errors[1][repetition] == pytest.approx((np.array(by_label) != truth).mean())
        assert errors[3][repetition] <= errors[2][repetition] + 1 / len(hidden)


def with_something_foreign(test):
    """Test objects with a part of another one that touches them, or with a strip of a table."""
    objects, truth = [], []
    for number in test.tolist():
        others = [i for i, label in enumerate(OBJECTS.labels) if label != OBJECTS.labels[number]]
        other = OBJECTS.segmented[others[number % len(others)]]
        one = with_foreign_points(OBJECTS.segmented[number], other, number, "surflet+fpfh+curvature")
        objects.append(one)
        truth.append(OBJECTS.labels[number])
    assert all(objects)
    return objects, np.array(truth)


def test_a_preset_that_imagines_nothing_has_no_hidden_parts() -> None:
    assert hidden_parts(OBJECTS, "paper", SPLITS) is None
