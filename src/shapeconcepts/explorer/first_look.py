"""What the page shows of a model that nobody has said anything of, until it is read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shapeconcepts.explorer.model_document import model_document
from shapeconcepts.model_file.outline import read_outline

if TYPE_CHECKING:
    from shapeconcepts.sources.reader import ReadOptions


def first_look(path: Path, has_scans: bool, reading: ReadOptions) -> tuple[dict[str, Any], dict[str, Any]]:
    """The documents of model and state, with what the outline of the file tells.

    Raises
    ------
    ModelError
        If there is none.
    """
    outline = read_outline(path)
    model = model_document(
        outline.scan_names, outline.scan_labels, outline.skipped, None, path.name, has_scans, reading
    )
    sizes = np.bincount(outline.labels[outline.labels >= 0], minlength=len(outline.medoids))
    concepts = zip(
        outline.concept_keys, outline.concept_names, sizes.tolist(), outline.medoids.tolist(), strict=True
    )
    state = {
        "concepts": [
            {
                "key": key,
                "name": name,
                "size": size,
                "medoid": medoid,
                "suggested": "",
                "nNamed": 0,
                "doubtful": 0,
            }
            for key, name, size, medoid in concepts
        ],
        "conceptOfScan": np.array([*outline.concept_keys, -1])[outline.labels].tolist(),
        "foreign": [],
        "pValues": None,
        "doubts": None,
        "doubtfulFrom": 1.0,
        "isThinking": True,
        "question": None,
        "journal": [],
        "nEdits": 0,
        "canUndo": False,
        "canRedo": False,
        "granularity": outline.granularity,
        "links": [],
    }
    return model, state
