"""What the motifs add to the whole-object histogram of the same descriptor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from shapeconcepts.evaluation.baselines import OUR_FILTRATION, STIMULI, WHOLE_OBJECT
from shapeconcepts.evaluation.report.measures import MEASURES, Measure
from shapeconcepts.evaluation.report.tables import table

if TYPE_CHECKING:
    from shapeconcepts.evaluation.metrics import GroupingScores
    from shapeconcepts.evaluation.results import Evaluation

# Less is not seen in a score of two decimals.
_LEAST = 0.005

# By score, and by way to group.
Gains = Mapping[str, Mapping[str, float]]


def motif_gains(evaluation: Evaluation) -> dict[str, dict[str, float]]:
    """Score of motif stimuli less that of whole-object histograms, grouped in the same way.

    Returns
    -------
    dict of str to dict of str to float
        By score and by way to group: the median over the repetitions of the difference, -1 to 1. Nothing
        where one of the two has not been grouped.
    """
    by_method: dict[str, dict[str, Sequence[GroupingScores]]] = {STIMULI: {}, WHOLE_OBJECT: {}}
    for row in evaluation.baselines:
        if row.representation in by_method:
            by_method[row.representation][row.grouping] = row.scores
    if evaluation.selections:
        # The filtration of stimuli is the model itself.
        by_method[STIMULI][OUR_FILTRATION] = evaluation.selections[0].scores
    shared = [method for method in by_method[WHOLE_OBJECT] if method in by_method[STIMULI]]
    return {
        measure.score: {
            method: _median_gain(by_method[STIMULI][method], by_method[WHOLE_OBJECT][method], measure)
            for method in shared
        }
        for measure in MEASURES
    }


def _median_gain(
    with_motifs: Sequence[GroupingScores], without: Sequence[GroupingScores], measure: Measure
) -> float:
    pairs = zip(with_motifs, without, strict=True)
    return float(np.median([getattr(a, measure.score) - getattr(b, measure.score) for a, b in pairs]))


def said_of_motifs(gains: Gains) -> str:
    """What the motifs add and what they do not, in sentences; empty where there are no gains."""
    methods = list(gains[MEASURES[0].score])
    if not methods:
        return ""
    parts: list[str] = []
    added: list[str] = []
    not_added: list[str] = []
    for score, name, _ in MEASURES:
        values = np.array(list(gains[score].values()))
        median = float(np.median(values))
        more, less = (values >= _LEAST).sum(), (values <= -_LEAST).sum()
        parts.append(f"{name} {signed(median)} (more in {more}, less in {less})")
        (added if median >= _LEAST else not_added).append(name)
    nowhere = [
        method for method in methods if all(gains[measure.score][method] < _LEAST for measure in MEASURES)
    ]
    sentences = [
        f"Motif stimuli instead of the whole-object histogram, in {len(methods)} ways to group, median: "
        f"{'; '.join(parts)}.",
        f"So the motifs add {_listed(added, 'and')}{_and_no(not_added)}."
        if added
        else "So they add nothing.",
    ]
    if nowhere and added:
        sentences.append(f"They add nothing at all under {_listed(nowhere, 'and', '; ')}.")
    return " ".join(sentences)


def motif_gain_table(gains: Gains) -> str:
    """A row for each way to group."""
    methods = list(gains[MEASURES[0].score])
    rows = [[method, *(signed(gains[measure.score][method]) for measure in MEASURES)] for method in methods]
    return table(["stimuli less whole objects", *(measure.name for measure in MEASURES)], rows)


def signed(difference: float) -> str:
    """A difference with its sign and two decimals; one that is too small to be seen is 0."""
    return "0.00" if abs(difference) < _LEAST else f"{difference:+.2f}".replace("-", "−")


def _and_no(names: Sequence[str]) -> str:
    return f", but no {_listed(names, 'and no')}" if names else ""


def _listed(names: Sequence[str], word: str, separator: str = ", ") -> str:
    """Names one after the other, a word before the last."""
    return f" {word} ".join([separator.join(names[:-1]), names[-1]] if len(names) > 1 else names)
