"""The usual groupings and features on the same splits: of whole objects, motif stimuli and a bag of words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.evaluation.bag_of_words import TopicModel, point_histograms
from shapeconcepts.evaluation.baselines import (
    OUR_FILTRATION,
    STIMULI,
    WHOLE_OBJECT,
    baseline_rows,
    grouping_baselines,
    whole_object_rows,
)
from shapeconcepts.evaluation.classification import svm_errors
from shapeconcepts.evaluation.experiments.concept_responses import fit
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
    """A representation in one repetition: its groupings by method, and the errors of an SVM on it.

    The errors are None where others have them.
    """

    parameters: dict[str, dict[str, Any]]
    scores: dict[str, GroupingScores]
    errors: dict[str, float] | None


def baseline_comparison(
    objects: LabelledObjects,
    preset: str,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
    random_state: int = 0,
) -> tuple[list[BaselineRow], list[ClassificationRow]]:
    """Group each training part by every representation and method, and classify its test part.

    Parameters
    ----------
    objects : LabelledObjects
    preset : str
        Whose descriptor gives the histograms of whole objects, and whose motifs the stimuli.
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional
    random_state : int
        Seed of the bag of words.
    """
    segmented, described, labels = objects.segmented, objects.described[preset], objects.labels
    features = run(_features, [(one,) for one in segmented], n_jobs, progress, "Whole-object features")
    rows = {name: np.concatenate([one[name] for one in features]) for name in features[0]}
    rows[WHOLE_OBJECT] = whole_object_rows(described)
    tasks = [(of_objects, labels, split) for of_objects in rows.values() for split in splits]
    compared = run(_compare, tasks, n_jobs, progress, "Baselines")
    stimuli_tasks = [(described, labels, split, preset) for split in splits]
    compared += run(_compare_stimuli, stimuli_tasks, n_jobs, progress, "Baselines on stimuli")
    topic_tasks = [(segmented, labels, split, random_state) for split in splits]
    compared += run(_compare_topics, topic_tasks, n_jobs, progress, "Bag of words")
    groupings, classifications = [], []
    for number, representation in enumerate([*rows, STIMULI, BAG_OF_WORDS]):
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
        errors = [one.errors for one in repetitions if one.errors is not None]
        if errors:
            classifications.append(ClassificationRow(representation, by_label(errors)))
    return groupings, classifications


def _features(segmented: SegmentedObject) -> dict[str, Floats]:
    return baseline_rows([segmented])


def _compare(rows: Floats, labels: NDArray[np.str_], split: Split) -> Compared:
    training, test = split
    groupings = grouping_baselines(rows[training], most_groups(len(training)))
    errors = svm_errors(rows[training], labels[training], rows[test], labels[test], "histogram")
    return _compared(groupings, labels[training], errors)


def _compare_stimuli(
    described: Sequence[DescribedObject], labels: NDArray[np.str_], split: Split, preset: str
) -> Compared:
    training, _ = split
    stimuli = fit([described[i] for i in training], preset).stimuli_
    groupings = grouping_baselines(stimuli, most_groups(len(training)))
    # Stimuli under the filtration, and a support vector machine on them, stand among ours.
    del groupings[OUR_FILTRATION]
    return _compared(groupings, labels[training], None)


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


def _compared(
    groupings: dict[str, Grouping], labels: NDArray[np.str_], errors: dict[str, float] | None
) -> Compared:
    return Compared(
        {method: grouping.parameters for method, grouping in groupings.items()},
        {method: grouping_scores(grouping.labels, labels) for method, grouping in groupings.items()},
        errors,
    )
