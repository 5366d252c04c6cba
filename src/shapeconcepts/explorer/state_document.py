"""What the page knows of a model that edits change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.corrections.question import DOUBTFUL
from shapeconcepts.model import ShapeConceptModel

_MOST_EDITS_TOLD = 200


def state_document(
    model: ShapeConceptModel, suggested: Mapping[int, str], is_likeness_known: bool
) -> dict[str, Any]:
    """Concepts, doubts, what to ask, and the journal, ready for JSON.

    Parameters
    ----------
    model : ShapeConceptModel
    suggested : mapping of int to str
        What concepts may be called, by their medoids.
    is_likeness_known : bool
        Otherwise it is not asked for, and there are no doubts and no question yet.
    """
    journal = model.journal
    doubts = model.doubts() if is_likeness_known and model.novelty_ is not None else None
    is_doubtful = np.zeros(len(model.labels_), bool) if doubts is None else doubts >= DOUBTFUL
    is_certain = np.isin(np.arange(len(model.labels_)), model.certain_)
    keys = np.array([*(concept.key for concept in model.concepts_), -1])
    question = None if doubts is None else model.next_question()
    return {
        "concepts": [
            {
                "key": concept.key,
                "name": concept.name,
                "size": concept.size,
                "medoid": int(concept.medoid),
                "suggested": suggested.get(concept.medoid, ""),
                "nNamed": int(is_certain[concept.members].sum()),
                "doubtful": int(is_doubtful[concept.members].sum()),
            }
            for concept in model.concepts_
        ],
        "conceptOfScan": keys[model.labels_].tolist(),
        "foreign": model.foreign_.tolist(),
        "pValues": _rounded(model.training_p_values()),
        "doubts": _rounded(doubts),
        "doubtfulFrom": DOUBTFUL,
        "isThinking": not is_likeness_known,
        "question": question
        and {
            "kind": question.kind,
            "key": question.key,
            "scans": question.scans.tolist(),
            "decides": question.decides,
        },
        "journal": [
            {
                "number": edit.number,
                "kind": edit.kind,
                "text": edit.text,
                "undone": edit.is_undone,
                "unfit": edit.unfit,
            }
            for edit in journal[-_MOST_EDITS_TOLD:]
        ],
        "nEdits": len(journal),
        "canUndo": any(not edit.is_undone for edit in journal),
        # An edit that was undone before the last one cannot come back.
        "canRedo": bool(journal) and journal[-1].is_undone,
        "granularity": model.granularity_,
        "links": [list(link) for link in model.links],
    }


def _rounded(values: NDArray[np.float64] | None) -> list[float | None] | None:
    if values is None:
        return None
    return [None if value != value else value for value in np.round(values, 2).tolist()]
