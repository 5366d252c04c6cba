"""Ours and the baselines as rows that are read side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from shapeconcepts.evaluation.metrics import GroupingScores
    from shapeconcepts.evaluation.results import BaselineRow, SelectionResult


@dataclass(frozen=True)
class ComparedRow:
    """Scores of one way to group, one for each repetition."""

    name: str
    is_ours: bool
    parameters: Sequence[dict[str, Any]]
    scores: Sequence[GroupingScores]

    def values(self, score: str) -> list[float]:
        """One score of all repetitions."""
        return [float(getattr(one, score)) for one in self.scores]

    def median(self, score: str) -> float:
        """Median over the repetitions in which the score is a number, NaN where it never is."""
        return smallest_median_largest(self.values(score))[1]


def compared_rows(
    baselines: Sequence[BaselineRow], selections: Sequence[SelectionResult]
) -> list[ComparedRow]:
    """All rows, those with most information first; where two are equal, ours before baselines."""
    rows = [ComparedRow(f"shapeconcepts, {one.preset}", True, (), one.scores) for one in selections]
    rows += [
        ComparedRow(f"{one.representation}, {one.grouping}", False, one.parameters, one.scores)
        for one in baselines
    ]
    return sorted(rows, key=lambda row: -np.nan_to_num(row.median("adjusted_mutual_information"), nan=-1.0))


def smallest_median_largest(values: Sequence[float]) -> tuple[float, float, float]:
    """Of the values that are numbers; NaN where none is."""
    numbers = [value for value in values if np.isfinite(value)]
    if not numbers:
        return np.nan, np.nan, np.nan
    return float(np.min(numbers)), float(np.median(numbers)), float(np.max(numbers))
