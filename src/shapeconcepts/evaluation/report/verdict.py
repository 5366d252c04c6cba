"""How ours does among the baselines, said in one sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from shapeconcepts.evaluation.report.compared_rows import ComparedRow, compared_rows
from shapeconcepts.evaluation.report.number_formats import percent

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation


def verdict(evaluation: Evaluation) -> str:
    """How many baselines explain more objects than the first preset, and which explains most."""
    if not evaluation.selections or not evaluation.baselines:
        return ""
    (ours,) = compared_rows([], evaluation.selections[:1])
    baselines = compared_rows(evaluation.baselines, [])
    better = [row for row in baselines if _explained(row) > _explained(ours)]
    best = f"{baselines[0].name} ({percent(_explained(baselines[0]))})"
    start = f"shapeconcepts explains {percent(_explained(ours))} of the training objects; "
    if not better:
        return f"{start}none of the {len(baselines)} baselines explains more, the best of them is {best}."
    return f"{start}{len(better)} of the {len(baselines)} baselines explain more, most of all {best}."


def _explained(row: ComparedRow) -> float:
    return row.median("explained")
