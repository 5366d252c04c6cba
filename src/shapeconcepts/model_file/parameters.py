"""Parameters of the model and of its estimators as JSON, and back, with types and ranges checked."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator

from shapeconcepts.concepts.filtration import HEATS, STOPS
from shapeconcepts.concepts.response import DISTANCES
from shapeconcepts.descriptors import FPFH, Curvature, Descriptor, Surflet
from shapeconcepts.descriptors.registry import DESCRIPTORS
from shapeconcepts.descriptors.surflet import SCALES
from shapeconcepts.model_file.error import ModelError, require
from shapeconcepts.model_file.layout import check_names
from shapeconcepts.motifs.dictionary import METRICS
from shapeconcepts.motifs.ensemble import COLUMNS

Check = tuple[Callable[[Any], bool], str]

_LARGEST_WHOLE = 2**31


def _whole(smallest: int) -> Check:
    return (
        lambda value: type(value) is int and smallest <= value < _LARGEST_WHOLE,
        f"a whole number of at least {smallest}",
    )


def _is_positive(value: object) -> bool:
    return type(value) in (int, float) and 0 < value < _LARGEST_WHOLE  # type: ignore[operator]


_POSITIVE: Check = (_is_positive, "a positive number")


def _choice(names: Sequence[str]) -> Check:
    return (lambda value: isinstance(value, str) and value in names, f"one of {', '.join(names)}")


_CHECKS: dict[str, Check] = {
    "n_levels": _whole(1),
    "word_metric": _choice(METRICS),
    "metric": _choice(METRICS),
    "bandwidth": _POSITIVE,
    "leave_own_out": (lambda value: type(value) in (bool, int) and value in (0, 1), "true or false"),
    "min_support": _whole(1),
    "min_concept_size": _whole(2),
    "max_steps": _whole(1),
    "voxel_size": (lambda value: value == "auto" or _is_positive(value), '"auto" or a positive number'),
    "seed_size": _POSITIVE,
    "max_segments": _whole(1),
    "radius": _POSITIVE,
    "scale": _choice(SCALES),
    "columns": _choice(COLUMNS),
    "n_neighbours": (
        lambda value: value is None or _whole(1)[0](value),
        "null or a whole number of at least 1",
    ),
    "heat": _choice(HEATS),
    "stop": _choice(STOPS),
    "distance": _choice(DISTANCES),
    "response_distance": _choice(DISTANCES),
}

# Descriptors that a file can hold with parameters of their own.
_WITH_PARAMETERS: dict[str, type[FPFH] | type[Surflet] | type[Curvature]] = {
    "fpfh": FPFH,
    "surflet": Surflet,
    "curvature": Curvature,
}

# How many jobs to run is a matter of the machine, not of the model; a dictionary has an entry of its own.
_LEFT_OUT = ("n_jobs", "dictionary")


def encode_parameters(estimator: BaseEstimator) -> dict[str, Any]:
    """Parameters of an estimator as JSON values.

    Raises
    ------
    ModelError
        If the descriptor is not one of the built-in ones.
    """
    parameters = {k: v for k, v in estimator.get_params(deep=False).items() if k not in _LEFT_OUT}
    return {
        name: _encode_descriptor(value) if name == "descriptor" else _plain(value)
        for name, value in parameters.items()
    }


def decode_parameters(encoded: object, estimator: type[BaseEstimator], title: str) -> dict[str, Any]:
    """Parameters to construct an estimator with.

    Raises
    ------
    ModelError
        If one is missing, unknown, of a wrong type or out of range.
    """
    require(isinstance(encoded, dict), f"{title} must be a JSON object, got {encoded!r:.60}")
    assert isinstance(encoded, dict)
    expected = {name for name in estimator().get_params(deep=False) if name not in _LEFT_OUT}
    check_names(f"entry of {title}", set(encoded), expected)
    return {name: _decoded(name, value) for name, value in encoded.items()}


def _decoded(name: str, value: Any) -> Any:
    if name == "descriptor":
        return _decode_descriptor(value)
    is_valid, expected = _CHECKS[name]
    require(is_valid(value), f"parameter {name} must be {expected}, got {value!r:.60}")
    return value


def _plain(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value


def _encode_descriptor(descriptor: str | Descriptor) -> object:
    if isinstance(descriptor, str):
        return descriptor
    for name, built_in in _WITH_PARAMETERS.items():
        # Not isinstance: what a subclass computes is code, and no file holds that.
        if type(descriptor) is built_in:
            values = {field.name: getattr(descriptor, field.name) for field in dataclasses.fields(built_in)}
            return {"type": name, **{key: _plain(value) for key, value in values.items()}}
    raise ModelError(
        f"a model with a descriptor of one's own cannot be saved: descriptor must be one of "
        f"{', '.join(DESCRIPTORS)}, FPFH, Surflet or Curvature, got {descriptor!r:.80}"
    )


def _decode_descriptor(encoded: object) -> str | Descriptor:
    has_parameters = isinstance(encoded, dict)
    name = encoded.get("type") if isinstance(encoded, dict) else encoded
    if not isinstance(name, str) or name not in (_WITH_PARAMETERS if has_parameters else DESCRIPTORS):
        raise ModelError(f"parameter descriptor must be one of {', '.join(DESCRIPTORS)}, got {encoded!r:.60}")
    if not isinstance(encoded, dict):
        return name
    expected = {field.name for field in dataclasses.fields(_WITH_PARAMETERS[name])}
    check_names("entry of descriptor", set(encoded), {"type", *expected})
    return _WITH_PARAMETERS[name](**{key: _decoded(key, encoded[key]) for key in expected})


def is_share(value: object) -> bool:
    """Whether a JSON value is a number from 0 to 1."""
    return type(value) in (int, float) and 0 <= value <= 1  # type: ignore[operator]
