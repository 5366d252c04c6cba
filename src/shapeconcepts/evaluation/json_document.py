"""Results as plain values for JSON."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from math import isfinite
from typing import Any

import numpy as np


def plain_values(result: object) -> Any:
    """Dataclasses as dicts, arrays as lists, and numbers that are not finite as None, at any depth.

    Parameters
    ----------
    result : object
        An `Evaluation`, or any part of it.
    """
    if is_dataclass(result) and not isinstance(result, type):
        return {field.name: plain_values(getattr(result, field.name)) for field in fields(result)}
    if isinstance(result, np.ndarray):
        return plain_values(result.tolist())
    if isinstance(result, np.generic):
        return plain_values(result.item())
    if isinstance(result, dict):
        return {str(key): plain_values(value) for key, value in result.items()}
    if isinstance(result, list | tuple):
        return [plain_values(value) for value in result]
    if isinstance(result, float) and not isfinite(result):
        return None
    return result
