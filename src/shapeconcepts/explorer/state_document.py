"""What the page knows of a model that edits change."""

from __future__ import annotations

from typing import Any

import numpy as np

from shapeconcepts.model import ShapeConceptModel


def state_document(model: ShapeConceptModel, version: int) -> dict[str, Any]:
    """Concepts, doubts and the journal, ready for JSON."""
    keys = np.array([*(concept.key for concept in model.concepts_), -1])
    return {
        "version": version,
        "concepts": [
            {
                "key": concept.key,
                "name": concept.name,
                "size": concept.size,
                "medoid": int(concept.medoid),
                "suggested": "",
                "nNamed": 0,
                "doubtful": 0,
            }
            for concept in model.concepts_
        ],
        "conceptOfScan": keys[model.labels_].tolist(),
        "foreign": [],
        "pValues": None,
        "doubts": None,
        "question": None,
        "journal": [],
        "nEdits": 0,
        "canUndo": False,
        "canRedo": False,
        "granularity": model.filtration_.granularity_,
        "links": [],
    }
