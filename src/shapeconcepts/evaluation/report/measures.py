"""The three measures that ours and the rivals are compared by, none of which tells everything."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from shapeconcepts.evaluation.report.number_formats import decimal, percent


class Measure(NamedTuple):
    """A score of groupings.

    Attributes
    ----------
    score : str
        Its name in `GroupingScores`.
    name : str
        As it is called in a sentence.
    written : callable
        A value as text.
    """

    score: str
    name: str
    written: Callable[[float | None], str]


# Many small groups explain much but share little information with the labels, so that comes last.
MEASURES = (
    Measure("adjusted_mutual_information", "information", decimal),
    Measure("b_cubed_f1", "B-cubed F1", decimal),
    Measure("explained", "objects explained", percent),
)
