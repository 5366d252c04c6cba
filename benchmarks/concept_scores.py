"""What the benchmarks of concepts measure of a model that learned from a part of the objects."""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import adjusted_rand_score

from common import labelled_scans
from shapeconcepts import DescribedObject, Scan, ShapeConceptModel, datasets
from shapeconcepts.evaluation import (
    GroupingScores,
    grouping_scores,
    mean_error_over_labels,
    svm_predictions,
)
from shapeconcepts.evaluation.experiments.concept_responses import ResponseDistances
from shapeconcepts.evaluation.splits import Split

SETS = ("seven_shapes", "simulated", "osd_learn", "restaurant_views")
SUBSET_SHARE = 0.9

Learn = Callable[[Sequence[DescribedObject]], ShapeConceptModel]


class SplitResult(NamedTuple):
    """A model of the training objects, its scores by their labels, and labels told from its responses."""

    model: ShapeConceptModel
    scores: GroupingScores
    told: NDArray[np.str_]


def scans_by_set(parser: ArgumentParser, names: Sequence[str], seeds: Sequence[int]) -> dict[str, list[Scan]]:
    """Labelled scans by the name of the set; "simulated" stands for a set of each seed."""
    scans = {}
    for name in names:
        if name == "simulated":
            for seed in seeds:
                scans[f"simulated {seed}"] = datasets.simulate(n_per_category=66, random_state=seed)
        else:
            scans[name] = labelled_scans(parser, name)
    return scans


def on_splits(
    learn: Learn,
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    splits: Sequence[Split],
) -> list[SplitResult]:
    """Learn from the training objects of each split."""
    results = []
    for training, new in splits:
        model = learn([described[i] for i in training])
        stimuli = model.stimuli([described[i] for i in new])
        responses = ResponseDistances.of(model, stimuli).responses(model.labels_)
        told = svm_predictions(responses[0], labels[training], responses[1], "response")
        results.append(SplitResult(model, grouping_scores(model.labels_, labels[training]), told))
    return results


def pooled_svm_error(
    results: Sequence[SplitResult], labels: NDArray[np.str_], splits: Sequence[Split]
) -> float:
    """Error on concept responses in percent, averaged over labels, of the new objects of all splits."""
    true = np.concatenate([labels[new] for _, new in splits])
    told = np.concatenate([one.told for one in results])
    return 100 * mean_error_over_labels(true, told)[1]


def median_scores(results: Sequence[SplitResult]) -> GroupingScores:
    """Median of each score over splits."""
    return GroupingScores(*np.nanmedian([list(vars(one.scores).values()) for one in results], axis=0))


def random_subsets(n: int, n_subsets: int) -> list[NDArray[np.int64]]:
    """Random 90 % of n objects, rising."""
    rng = np.random.default_rng(0)
    return [np.sort(rng.permutation(n)[: round(SUBSET_SHARE * n)]) for _ in range(n_subsets)]


def stability(learn: Learn, described: Sequence[DescribedObject], n_subsets: int) -> float:
    """Median adjusted Rand index between concepts learned from two random 90 % of the objects."""
    subsets = random_subsets(len(described), n_subsets)
    groupings = [(subset, learn([described[i] for i in subset]).labels_) for subset in subsets]
    return grouping_stability(groupings, len(described))


def grouping_stability(
    groupings: Sequence[tuple[NDArray[np.int64], NDArray[np.int32]]], n_objects: int
) -> float:
    """Median adjusted Rand index between groupings of subsets, given as objects and their groups.

    It is taken over all pairs of subsets, each on the objects that both have. An object in no group is a
    group of its own.
    """
    spread = []
    for subset, labels in groupings:
        # -1 for objects that are not in the subset.
        grouping = np.full(n_objects, -1)
        grouping[subset] = np.where(labels >= 0, labels, n_objects + np.arange(len(labels)))
        spread.append(grouping)
    indices = []
    for one, other in combinations(spread, 2):
        shared = (one >= 0) & (other >= 0)
        indices.append(adjusted_rand_score(one[shared], other[shared]))
    return float(np.median(indices))


def majority_labels(groups: NDArray[np.integer], labels: NDArray[np.str_]) -> NDArray[np.str_]:
    """Most frequent label of each group, the first of equal ones, and behind them "" for group -1."""
    majorities = []
    for group in range(groups.max(initial=-1) + 1):
        names, counts = np.unique(labels[groups == group], return_counts=True)
        majorities.append(names[counts.argmax()])
    return np.array([*majorities, ""])
