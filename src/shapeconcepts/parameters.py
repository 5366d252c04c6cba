"""Checks of parameters that several modules share."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral, Real

import numpy as np


def check_length(name: str, value: object) -> float:
    """Return a positive number of metres, or raise a ValueError that names the parameter."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < np.inf:
        raise ValueError(f"{name} must be a positive number of metres, got {value!r}")
    return float(value)


def check_integer(name: str, value: object, smallest: int) -> int:
    """Return an integer of at least `smallest`, or raise a ValueError that names the parameter."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < smallest:
        raise ValueError(f"{name} must be an integer of at least {smallest}, got {value!r}")
    return int(value)


def check_choice(name: str, value: object, choices: Sequence[str]) -> str:
    """Return one of several names, or raise a ValueError that names the parameter."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, got {value!r}")
    return value
