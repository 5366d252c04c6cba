"""Stages of a model with their parameters as JSON, and back, with types and ranges checked."""

from __future__ import annotations

from typing import Any

import numpy as np
from sklearn.base import BaseEstimator

from shapeconcepts.concepts import ConceptResponse, Filtration
from shapeconcepts.descriptors import FPFH, Curvature, Joint, PointDistances, Surflet
from shapeconcepts.descriptors.registry import DESCRIPTORS
from shapeconcepts.model_file.error import ModelError, require
from shapeconcepts.model_file.layout import check_names
from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.parameters import check_parameters
from shapeconcepts.segmentation import Segmenter

_STAGES: dict[str, type[BaseEstimator]] = {
    stage.__name__: stage
    for stage in (
        Segmenter,
        FPFH,
        Surflet,
        Curvature,
        PointDistances,
        Joint,
        SegmentDictionary,
        MotifHierarchyEnsemble,
        Filtration,
        ConceptResponse,
    )
}
# How many jobs to run is a matter of the machine, not of the model.
_LEFT_OUT = "n_jobs"
_TOO_LARGE = 2**31


def encode_parameters(value: Any) -> Any:
    """A parameter as a JSON value: a stage as an object with its type and parameters.

    Raises
    ------
    ModelError
        If it is or holds something of one's own: what that computes is code, and no file holds code.
    """
    if _STAGES.get(type(value).__name__) is type(value):
        parameters = value.get_params(deep=False)
        kept = {name: encode_parameters(part) for name, part in parameters.items() if name != _LEFT_OUT}
        return {"type": type(value).__name__, **kept}
    if isinstance(value, tuple | list):
        return [encode_parameters(part) for part in value]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or type(value) in (bool, int, float, str):
        return value
    raise ModelError(
        f"a model with a stage of one's own cannot be saved: expected one of {', '.join(_STAGES)}, "
        f"got {value!r:.80}"
    )


def decode_stage(encoded: object, expected: type[BaseEstimator], title: str) -> Any:
    """A stage of an expected type.

    Raises
    ------
    ModelError
        If it is another, or a parameter is missing, unknown, of a wrong type or out of range.
    """
    stage = _decoded(encoded, title)
    require(
        type(stage) is expected, f"{title} must be of type {expected.__name__}, is {type(stage).__name__}"
    )
    return _checked(stage)


def decode_descriptor(encoded: object) -> Any:
    """A descriptor, or the name of one.

    Raises
    ------
    ModelError
        As `decode_stage`.
    """
    if isinstance(encoded, str):
        require(
            encoded in DESCRIPTORS, f"descriptor must be one of {', '.join(DESCRIPTORS)}, got {encoded!r:.60}"
        )
        return encoded
    descriptor = _decoded(encoded, "descriptor")
    _require_descriptor(descriptor)
    return _checked(descriptor)


def _require_descriptor(value: object) -> None:
    require(
        isinstance(value, FPFH | Surflet | Curvature | PointDistances | Joint),
        "descriptor must be a name or of type FPFH, Surflet, Curvature, PointDistances or Joint, "
        f"got {value!r:.60}",
    )
    if isinstance(value, Joint):
        require(
            isinstance(value.descriptors, tuple) and len(value.descriptors) > 0, "descriptor Joint is empty"
        )
        for part in value.descriptors:
            _require_descriptor(part)


def _decoded(encoded: Any, title: str) -> Any:
    if isinstance(encoded, list):
        return tuple(_decoded(part, title) for part in encoded)
    if not isinstance(encoded, dict):
        if isinstance(encoded, int | float):
            require(abs(encoded) < _TOO_LARGE, f"{title} must be below {_TOO_LARGE}, is {encoded!r:.40}")
        return encoded
    name = encoded.get("type")
    require(
        isinstance(name, str) and name in _STAGES,
        f"{title} must have a type of {', '.join(_STAGES)}, has {name!r:.60}",
    )
    stage = _STAGES[str(name)]
    parameters = {key: _decoded(value, f"{title}.{key}") for key, value in encoded.items() if key != "type"}
    check_names(f"entry of {title}", set(parameters), set(stage._get_param_names()) - {_LEFT_OUT})
    return stage(**parameters)


def _checked(stage: Any) -> Any:
    try:
        check_parameters(stage)
    except ValueError as error:
        raise ModelError(f"{error!s:.300}") from None
    return stage
