"""How ours does among the rivals, and what its motifs are for, said in a few sentences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from shapeconcepts.evaluation.report.compared_rows import ComparedRow, compared_rows
from shapeconcepts.evaluation.report.measures import MEASURES, Measure
from shapeconcepts.evaluation.report.motif_gain import motif_gains, said_of_motifs

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation


def verdict(evaluation: Evaluation) -> str:
    """By each measure, how many rivals are better than the first preset and which is best; the motifs' part.

    Empty where there is nothing to compare.
    """
    if not evaluation.selections or not evaluation.baselines:
        return ""
    (ours,) = compared_rows([], evaluation.selections[:1])
    rivals = compared_rows(evaluation.baselines, [])
    sentences = [f"{ours.name}, beside {len(rivals)} rivals that saw no label either:"]
    sentences += [_beside(ours, rivals, measure) for measure in MEASURES]
    return " ".join([*sentences, said_of_motifs(motif_gains(evaluation))]).strip()


def _beside(ours: ComparedRow, rivals: Sequence[ComparedRow], measure: Measure) -> str:
    def value(row: ComparedRow) -> float:
        return float(np.nan_to_num(row.median(measure.score), nan=-1.0))

    best = max(rivals, key=value)
    n_better = sum(value(row) > value(ours) for row in rivals)
    better = f"{n_better} {'is' if n_better == 1 else 'are'} better" if n_better else "none is better"
    written = measure.written(ours.median(measure.score))
    return f"{measure.name} {written}, {better}, best {best.name} ({measure.written(value(best))})."
