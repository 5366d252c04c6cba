"""The order in which a report tells of the concepts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from shapeconcepts.concepts import Concept

# The small constant of the paper's equation for the rank score.
EPSILON = 1e-3


@dataclass(frozen=True)
class RankedConcept:
    """A concept with what it is ranked by.

    Attributes
    ----------
    number : int
        Position in the model's `concepts_`.
    concept : Concept
    score : float
        Rank score; size times lifetime where there are no labels.
    purity : float or None
        Share of the most frequent label among the members, 0 to 1; None where there are no labels.
    label_counts : tuple of (str, int)
        Members of each label, the most frequent first.
    """

    number: int
    concept: Concept
    score: float
    purity: float | None
    label_counts: tuple[tuple[str, int], ...]


def rank_concepts(concepts: Sequence[Concept], labels: Sequence[str | None]) -> list[RankedConcept]:
    """Concepts by falling rank score `size / (1 - purity + 0.001)` (paper: Unsupervised Concept Selection).

    Where no scan has a label, the score is size times lifetime.

    Parameters
    ----------
    concepts : sequence of Concept
    labels : sequence of (str or None)
        Label of each scan.
    """
    has_labels = any(label is not None for label in labels)
    ranked = []
    for number, concept in enumerate(concepts):
        counts = Counter(labels[i] for i in concept.members.tolist() if labels[i] is not None)
        ordered = sorted(counts.items(), key=lambda item: (-item[1], str(item[0])))
        purity = ordered[0][1] / concept.size if ordered else 0.0
        score = concept.size / (1 - purity + EPSILON) if has_labels else concept.size * concept.lifetime
        ranked.append(
            RankedConcept(
                number,
                concept,
                float(score),
                purity if has_labels else None,
                tuple((str(label), count) for label, count in ordered),
            )
        )
    return sorted(ranked, key=lambda one: (-one.score, one.number))
