"""Unsupervised concept selection: concepts at the time the model chooses, and an SVM on them (table 1)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.evaluation.classification import svm_errors
from shapeconcepts.evaluation.experiments.concept_numbers import ConceptNumbers
from shapeconcepts.evaluation.experiments.concept_responses import ResponseDistances, fit
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, Progress, run
from shapeconcepts.evaluation.metrics import GroupingScores, grouping_scores, purity, rank_score
from shapeconcepts.evaluation.results import ClassificationRow, ConceptBar, FiltrationResult, SelectionResult
from shapeconcepts.evaluation.splits import Split
from shapeconcepts.model import ShapeConceptModel


class Selection(NamedTuple):
    """One repetition: scores of the training part, errors of the test part on responses and on stimuli."""

    scores: GroupingScores
    errors: dict[str, float]
    stimuli_errors: dict[str, float]
    bars: list[ConceptBar]
    filtration: FiltrationResult | None
    unplaced: int


def unsupervised_selection(
    objects: LabelledObjects,
    preset: str,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
) -> tuple[SelectionResult, ClassificationRow]:
    """Learn from each training part without its labels, then score by them.

    Parameters
    ----------
    objects : LabelledObjects
    preset : str
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional

    Returns
    -------
    SelectionResult
    ClassificationRow
        Of an SVM on the stimuli themselves, which shows what the step to concepts costs.
    """
    described = objects.described[preset]
    tasks = [(described, objects.labels, split, preset, i == 0) for i, split in enumerate(splits)]
    selections = run(select, tasks, n_jobs, progress, f"Concepts, preset {preset}")
    first = selections[0]
    assert first.filtration is not None
    result = SelectionResult(
        preset=preset,
        scores=[one.scores for one in selections],
        errors=by_label([one.errors for one in selections]),
        bars=first.bars,
        filtration=first.filtration,
        unplaced=first.unplaced,
    )
    on_stimuli = by_label([one.stimuli_errors for one in selections])
    return result, ClassificationRow(f"motif stimuli, {preset}", on_stimuli)


def select(
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    split: Split,
    preset: str,
    with_filtration: bool,
    **parameters: object,
) -> Selection:
    """One repetition of `unsupervised_selection`."""
    training, test = split
    model = fit([described[i] for i in training], preset, **parameters)
    concept_of = model.labels_
    stimuli = model.stimuli([described[i] for i in test])
    responses = ResponseDistances.of(model, stimuli).responses(concept_of)
    known, new = labels[training], labels[test]
    return Selection(
        grouping_scores(concept_of, known),
        svm_errors(responses[0], known, responses[1], new, "response"),
        svm_errors(model.stimuli_, known, stimuli, new, "histogram"),
        _ranked_bars(model, known),
        _filtration(model) if with_filtration else None,
        int((np.diff(model.stimuli_.indptr) == 0).sum()),
    )


def by_label(errors: Sequence[dict[str, float]]) -> dict[str, list[float]]:
    """Errors of repetitions, by label; a label without test objects in a repetition has none there."""
    labels = sorted({label for one in errors for label in one})
    return {label: [one[label] for one in errors if label in one] for label in labels}


def _ranked_bars(model: ShapeConceptModel, labels: NDArray[np.str_]) -> list[ConceptBar]:
    bars = []
    for concept in model.concepts_:
        counts = Counter(sorted(labels[concept.members].tolist()))
        pure = purity(labels[concept.members])
        proportions = {label: count / concept.size for label, count in counts.most_common()}
        bars.append(ConceptBar(concept.size, pure, rank_score(concept.size, pure), proportions))
    return sorted(bars, key=lambda bar: bar.rank_score)


def _filtration(model: ShapeConceptModel) -> FiltrationResult:
    filtration = model.filtration_
    step_ends, counts = filtration.annexations()
    numbers = ConceptNumbers.of(filtration)
    return FiltrationResult(
        diagram=filtration.diagram(),
        step_ends=step_ends,
        counts=counts,
        epsilon_max=filtration.epsilon_max_,
        concept_time=filtration.concept_time_,
        times=numbers.times,
        n_concepts=numbers.at_least(filtration.min_concept_size),
    )
