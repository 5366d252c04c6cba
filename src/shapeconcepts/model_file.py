"""Model files: being written."""

from __future__ import annotations

from os import PathLike

from shapeconcepts.model import ShapeConceptModel


class ModelError(ValueError):
    """A model file cannot be read."""


def save_model(model: ShapeConceptModel, path: str | PathLike[str]) -> None:
    """Write a model."""
    raise NotImplementedError


def load_model(path: str | PathLike[str]) -> ShapeConceptModel:
    """Read a model."""
    raise NotImplementedError
