"""Model files: safetensors with a JSON description in the header. Reading one never runs code."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shapeconcepts.model_file.error import ModelError
from shapeconcepts.model_file.outline import Outline, read_outline

if TYPE_CHECKING:
    from shapeconcepts.model_file.loading import read_state
    from shapeconcepts.model_file.saving import write_state
    from shapeconcepts.model_file.state import ModelState

__all__ = ["ModelError", "ModelState", "Outline", "read_outline", "read_state", "write_state"]

# They need scikit-learn, for which an outline should not wait.
_HOME_OF = {"ModelState": "state", "read_state": "loading", "write_state": "saving"}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
