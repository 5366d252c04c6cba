"""Supervised concept selection: number and minimum size of concepts by cross-validation (table 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration
from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.evaluation.classification import svm_errors
from shapeconcepts.evaluation.experiments.concept_numbers import ConceptNumbers
from shapeconcepts.evaluation.experiments.concept_responses import ResponseDistances, fit
from shapeconcepts.evaluation.experiments.folds import stratified_folds
from shapeconcepts.evaluation.experiments.unsupervised import by_label
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, Progress, run
from shapeconcepts.evaluation.metrics import GroupingScores, grouping_scores
from shapeconcepts.evaluation.results import Floats, SupervisedResult
from shapeconcepts.evaluation.splits import Split

NUMBERS = (3, 5, 7, 9, 11, 13, 15, 18, 21, 24, 27, 30, 33, 36, 40, 45, 50, 56, 62, 68, 74)
SIZES = (2, 3, 4, 6, 8)
FOLDS = 5
LEAST_COVERAGE = 0.75


class Surfaces(NamedTuple):
    """What each number and minimum size of concepts gave, (…, a, b); NaN where it is never reached."""

    purity: Floats
    error: Floats
    coverage: Floats


class TestPart(NamedTuple):
    """What the chosen concepts of a training part give."""

    scores: GroupingScores
    errors: dict[str, float]


def supervised_selection(
    objects: LabelledObjects,
    preset: str,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
    *,
    numbers: Sequence[int] = NUMBERS,
    sizes: Sequence[int] = SIZES,
    random_state: int = 0,
) -> SupervisedResult:
    """Choose number and minimum size of concepts on each training part, then classify its test part.

    Concepts are the groups at a time of the filtration.

    Parameters
    ----------
    objects : LabelledObjects
    preset : str
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional
    numbers, sizes : sequence of int
        To choose from. Numbers that are never reached are left out.
    random_state : int
        Seed of the folds.
    """
    described, labels = objects.described[preset], objects.labels
    fewest = min(len(training) for training, _ in splits)
    numbers = [number for number in numbers if number <= fewest // 2] or [min(numbers)]
    instances = objects.instances
    tasks = []
    for training, _ in splits:
        folds = stratified_folds(
            labels[training], FOLDS, random_state, None if instances is None else instances[training]
        )
        tasks += [
            (described, labels, (training[fitted], training[left_out]), preset, numbers, sizes)
            for fitted, left_out in folds
        ]
    found = run(fold_surfaces, tasks, n_jobs, progress, "Cross-validation")
    n_folds = len(found) // len(splits)
    by_split = [
        Surfaces(*(np.stack(surface) for surface in zip(*found[i : i + n_folds], strict=True)))
        for i in range(0, len(found), n_folds)
    ]
    choices = [choose(surfaces, numbers, sizes) for surfaces in by_split]
    test_tasks = [
        (described, labels, split, preset, *choice) for split, choice in zip(splits, choices, strict=True)
    ]
    tests = run(_test, test_tasks, n_jobs, progress, "Concepts chosen with labels")
    everything = Surfaces(*(np.concatenate(surfaces) for surfaces in zip(*by_split, strict=True)))
    chosen = choose(everything, numbers, sizes)
    purity, error, coverage = (_mean(surface) for surface in everything)
    is_reached = ~np.isnan(everything.error).all(axis=(0, 2))
    at_chosen = (numbers.index(chosen[0]), list(sizes).index(chosen[1]))
    with_five = purity[numbers.index(5), 0] if 5 in numbers else np.nan
    return SupervisedResult(
        numbers=np.array(numbers)[is_reached],
        sizes=np.array(sizes),
        purity=purity[is_reached],
        error=error[is_reached],
        coverage=coverage[is_reached],
        chosen=chosen,
        chosen_purity=float(purity[at_chosen]),
        chosen_error=float(error[at_chosen]),
        chosen_coverage=float(coverage[at_chosen]),
        purity_with_five=None if np.isnan(with_five) else float(with_five),
        errors=by_label([one.errors for one in tests]),
        choices=choices,
        scores=[one.scores for one in tests],
    )


def fold_surfaces(
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    split: Split,
    preset: str,
    numbers: Sequence[int],
    sizes: Sequence[int],
) -> Surfaces:
    """Learn from one part of the training objects, and go through all choices with the part left out."""
    fitted, left_out = split
    model = fit([described[i] for i in fitted], preset)
    stimuli = model.stimuli([described[i] for i in left_out])
    filtration = model.filtration_
    concept_numbers = ConceptNumbers.of(filtration)
    distances = ResponseDistances.of(model, stimuli)
    surfaces = Surfaces(*np.full((3, len(numbers), len(sizes)), np.nan))
    for i, number in enumerate(numbers):
        for j, size in enumerate(sizes):
            concept_of = _concepts(filtration, concept_numbers, number, size)
            if concept_of is None:
                continue
            scores = grouping_scores(concept_of, labels[fitted])
            responses = distances.responses(concept_of)
            errors = svm_errors(responses[0], labels[fitted], responses[1], labels[left_out], "response")
            surfaces.purity[i, j] = scores.mean_purity
            surfaces.error[i, j] = np.mean(list(errors.values()))
            surfaces.coverage[i, j] = scores.coverage
    return surfaces


def choose(surfaces: Surfaces, numbers: Sequence[int], sizes: Sequence[int]) -> tuple[int, int]:
    """The choice that cross-validation makes.

    Among the choices that every fold reaches and whose mean coverage is at least 0.75: those whose mean error
    is within one standard error of the lowest (Breiman et al. 1984), and of these the one with the highest
    mean purity, of equal ones the one with the fewest and largest concepts. Where no coverage is enough, the
    largest coverage counts as enough; where no choice is reached by every fold, those that are by most.

    Parameters
    ----------
    surfaces : Surfaces
        Of each fold, (k, a, b) each.
    numbers, sizes : sequence of int
        Of length a and b.
    """
    reached = (~np.isnan(surfaces.error)).sum(axis=0)
    is_open = reached == reached.max()
    purity, error, coverage = (_mean(surface) for surface in surfaces)
    enough = min(LEAST_COVERAGE, np.max(coverage[is_open], initial=0.0))
    is_open &= coverage >= enough
    if not is_open.any():
        return numbers[0], sizes[0]
    best = np.unravel_index(np.where(is_open, error, np.inf).argmin(), error.shape)
    of_best = surfaces.error[:, best[0], best[1]]
    of_best = of_best[~np.isnan(of_best)]
    margin = of_best.std(ddof=1) / np.sqrt(len(of_best)) if len(of_best) > 1 else 0.0
    is_open &= error <= error[best] + margin
    candidates = [(-purity[i, j], numbers[i], -sizes[j]) for i, j in zip(*np.nonzero(is_open), strict=True)]
    _, number, negative_size = min(candidates)
    return number, -negative_size


def _test(
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    split: Split,
    preset: str,
    number: int,
    size: int,
) -> TestPart:
    training, test = split
    model = fit([described[i] for i in training], preset)
    filtration = model.filtration_
    concept_of = _concepts(filtration, ConceptNumbers.of(filtration), number, size)
    if concept_of is None:
        # The folds had that many concepts, the whole training part has not: as the model would choose.
        concept_of = model.labels_
    stimuli = model.stimuli([described[i] for i in test])
    responses = ResponseDistances.of(model, stimuli).responses(concept_of)
    errors = svm_errors(responses[0], labels[training], responses[1], labels[test], "response")
    return TestPart(grouping_scores(concept_of, labels[training]), errors)


def _concepts(
    filtration: Filtration, concept_numbers: ConceptNumbers, number: int, size: int
) -> NDArray[np.int32] | None:
    """Concept of each training object when there are `number` concepts; None where there never are."""
    time = concept_numbers.time_of(number, size)
    if time is None:
        return None
    return filtration.labels_at(time, size)


def _mean(surfaces: Floats) -> Floats:
    """Mean over the folds, NaN where one of them has none."""
    return np.asarray(surfaces.mean(axis=0))
