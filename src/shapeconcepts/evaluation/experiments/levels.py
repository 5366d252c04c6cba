"""The number of dictionary levels, and what it does to concepts and to the classification on them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.evaluation.experiments.unsupervised import Selection, select
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, Progress, run
from shapeconcepts.evaluation.results import LevelsResult
from shapeconcepts.evaluation.splits import Split

LEVELS = (1, 2, 3, 4, 5, 6)


def number_of_levels(
    objects: LabelledObjects,
    preset: str,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
    levels: Sequence[int] = LEVELS,
) -> LevelsResult:
    """Unsupervised concept selection with each number of levels, everything else as in the preset.

    Parameters
    ----------
    objects : LabelledObjects
    preset : str
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional
    levels : sequence of int
    """
    described = objects.described[preset]
    tasks = [(described, objects.labels, split, preset, level) for level in levels for split in splits]
    selections = run(_select, tasks, n_jobs, progress, "Number of levels")
    by_level = [selections[i : i + len(splits)] for i in range(0, len(selections), len(splits))]
    return LevelsResult(
        levels=list(levels),
        scores=[[one.scores for one in of_level] for of_level in by_level],
        errors=[[float(np.mean(list(one.errors.values()))) for one in of_level] for of_level in by_level],
    )


def _select(
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    split: Split,
    preset: str,
    n_levels: int,
) -> Selection:
    return select(described, labels, split, preset, False, ensemble__dictionary__n_levels=n_levels)
