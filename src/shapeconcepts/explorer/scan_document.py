"""What the page shows of one scan."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.motifs.explanation import FiredMotif
from shapeconcepts.report.html import preview
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.segmentation import SegmentedObject
from shapeconcepts.topology.divergence import jensen_shannon_divergences

N_ELEMENTS = 3000
_N_NEAREST = 12
_N_MOTIFS = 12


def scan_document(
    model: ShapeConceptModel, row: int, segmented: SegmentedObject | None, reason: str, path: Path | None
) -> dict[str, Any]:
    """Picture, motifs, responses and nearest scans, ready for JSON.

    Parameters
    ----------
    model : ShapeConceptModel
    row : int
    segmented : SegmentedObject or None
        None where there is no picture: `reason` says why.
    reason : str
    path : Path or None
    """
    document: dict[str, Any] = {
        "row": row,
        "path": None if path is None else str(path),
        "reason": reason or model.skipped_.get(row, ""),
        "preview": None,
        "segments": 0,
        "motifs": [],
        "responses": _responses(model, row),
        "nearest": _nearest(model, row),
        "pValue": _p_value(model, row),
    }
    if segmented is None:
        return document
    try:
        with scan_errors(model.scan_names_[row], "drawn"):
            shown = preview(segmented, N_ELEMENTS)
            document |= {
                "preview": base64.b64encode(shown.to_bytes()).decode("ascii"),
                "extent": shown.extent,
                "spacing": shown.spacing,
                "sides": list(shown.sides),
                "segments": segmented.n_segments,
            }
        with scan_errors(model.scan_names_[row], "explained"):
            document["motifs"] = _motifs(model, segmented)
    except ScanError as error:
        document["reason"] = str(error)
    return document


def _responses(model: ShapeConceptModel, row: int) -> list[list[float]]:
    responses = model.response_.transform(model.stimuli_[[row]])[0].tolist()
    pairs = [
        [one.key, round(value, 4)]
        for one, value in zip(model.concepts_, responses, strict=True)
        if value == value
    ]
    return sorted(pairs, key=lambda pair: pair[1])


def _nearest(model: ShapeConceptModel, row: int) -> list[list[float]]:
    divergences = jensen_shannon_divergences(model.stimuli_[[row]], model.stimuli_)[0]
    divergences[row] = np.inf
    nearest = np.argsort(divergences, kind="stable")[:_N_NEAREST]
    return [[int(one), round(float(divergences[one]), 4)] for one in nearest if divergences[one] < 1]


def _p_value(model: ShapeConceptModel, row: int) -> float | None:
    p_values = model.training_p_values()
    return None if p_values is None or np.isnan(p_values[row]) else float(p_values[row])


def _motifs(model: ShapeConceptModel, segmented: SegmentedObject) -> list[dict[str, Any]]:
    is_seen = ~np.isin(np.arange(len(model.labels_)), list(model.skipped_))
    row_of_object = np.flatnonzero(is_seen)

    def one(motif: FiredMotif) -> dict[str, Any]:
        return {
            "name": motif.name,
            "stimulus": round(motif.stimulus, 4),
            "segments": list(motif.segments),
            "reminds": [
                {"row": int(row_of_object[similar.object_index]), "divergence": round(similar.divergence, 4)}
                for similar in motif.closest
            ],
        }

    return [one(motif) for motif in model.explain(segmented).motifs[:_N_MOTIFS]]
