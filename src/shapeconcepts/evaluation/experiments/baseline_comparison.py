"""The usual groupings and features on the same splits: whole-object histograms, and a bag of words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.evaluation.bag_of_words import TopicModel, point_histograms
from shapeconcepts.evaluation.baselines import baseline_rows, grouping_baselines
from shapeconcepts.evaluation.classification import svm_errors
from shapeconcepts.evaluation.experiments.unsupervised import by_label
from shapeconcepts.evaluation.groupings import Grouping, most_groups
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, Progress, run
from shapeconcepts.evaluation.metrics import GroupingScores, grouping_scores
from shapeconcepts.evaluation.results import BaselineRow, ClassificationRow, Floats
from shapeconcepts.evaluation.splits import Split
from shapeconcepts.segmentation import SegmentedObject

BAG_OF_WORDS = "bag of FPFH words"
TOPICS = "latent Dirichlet allocation"


class Compared(NamedTuple):
    """A representation in one repetition: its groupings by method, and the errors of an SVM on it."""

    parameters: dict[str, dict[str, Any]]
    scores: dict[str, GroupingScores]
    errors: dict[str, float]


def baseline_comparison(
    objects: LabelledObjects,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
    random_state: int = 0,
) -> tuple[list[BaselineRow], list[ClassificationRow]]:
    """Group each training part by every representation and method, and classify its test part.

    Parameters
    ----------
    objects : LabelledObjects
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional
    random_state : int
        Seed of the bag of words.
    """
    described = run(
        _whole_object, [(one,) for one in objects.segmented], n_jobs, progress, "Whole-object histograms"
    )
    rows = {name: np.concatenate([one[name] for one in described]) for name in described[0]}
    tasks = [(of_objects, objects.labels, split) for of_objects in rows.values() for split in splits]
    compared = run(_compare, tasks, n_jobs, progress, "Baselines")
    topic_tasks = [(objects.segmented, objects.labels, split, random_state) for split in splits]
    compared += run(_compare_topics, topic_tasks, n_jobs, progress, "Bag of words")
    groupings, classifications = [], []
    for number, representation in enumerate([*rows, BAG_OF_WORDS]):
        repetitions = compared[number * len(splits) : (number + 1) * len(splits)]
        for method in repetitions[0].scores:
            groupings.append(
                BaselineRow(
                    representation,
                    method,
                    [one.parameters[method] for one in repetitions],
                    [one.scores[method] for one in repetitions],
                )
            )
        errors = by_label([one.errors for one in repetitions])
        classifications.append(ClassificationRow(representation, errors))
    return groupings, classifications


def _whole_object(segmented: SegmentedObject) -> dict[str, Floats]:
    return baseline_rows([segmented])


def _compare(rows: Floats, labels: NDArray[np.str_], split: Split) -> Compared:
    training, test = split
    groupings = grouping_baselines(rows[training], most_groups(len(training)))
    errors = svm_errors(rows[training], labels[training], rows[test], labels[test], "histogram")
    return _compared(groupings, labels[training], errors)


def _compare_topics(
    segmented: Sequence[SegmentedObject], labels: NDArray[np.str_], split: Split, random_state: int
) -> Compared:
    training, test = split
    histograms = [point_histograms(one) for one in segmented]
    topics = TopicModel(most_groups(len(training)), random_state=random_state)
    topics.fit([histograms[i] for i in training])
    test_rows = topics.transform([histograms[i] for i in test])
    errors = svm_errors(topics.rows_, labels[training], test_rows, labels[test], "histogram")
    return _compared({TOPICS: topics.grouping_}, labels[training], errors)


def _compared(groupings: dict[str, Grouping], labels: NDArray[np.str_], errors: dict[str, float]) -> Compared:
    return Compared(
        {method: grouping.parameters for method, grouping in groupings.items()},
        {method: grouping_scores(grouping.labels, labels) for method, grouping in groupings.items()},
        errors,
    )
