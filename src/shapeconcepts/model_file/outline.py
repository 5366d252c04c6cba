"""What can be told of a model before it is read: which scans are in which concepts."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.model_file.container import read_parts
from shapeconcepts.model_file.description import check_description
from shapeconcepts.model_file.error import ModelError, require


class Outline(NamedTuple):
    """Scans and concepts of a model as it was learned, without what was said of them since.

    Attributes
    ----------
    scan_names : list of str
    scan_labels : list of (str or None)
    skipped : list of int
        Scans that could not be used.
    concept_names : list of str
    concept_keys : list of int
    labels : (n,) int32
        Concept of each scan, -1 for none.
    medoids : (c,) int64
    granularity : float or None
    """

    scan_names: list[str]
    scan_labels: list[str | None]
    skipped: list[int]
    concept_names: list[str]
    concept_keys: list[int]
    labels: NDArray[np.int32]
    medoids: NDArray[np.int64]
    granularity: float | None


def read_outline(path: str | PathLike[str]) -> Outline:
    """Read the outline of a model that `write_state` wrote, in a small part of the time that the model takes.

    Numbers are checked to be what they say; whether the rest of the file is damaged is not looked at.

    Raises
    ------
    ModelError
        If there is no such file, or no model of this version in it.
    """
    path = Path(path)
    try:
        tensors, description = read_parts(path, ("concepts.labels", "concepts.medoids"))
        labels, medoids = tensors["concepts.labels"], tensors["concepts.medoids"]
        check_description(description, len(labels), len(medoids))
        fits = bool(((labels >= -1) & (labels < len(medoids))).all())
        require(fits, f"tensor concepts.labels must hold numbers from -1 to {len(medoids) - 1}")
        fits = bool(((medoids >= 0) & (medoids < len(labels))).all())
        require(fits, f"tensor concepts.medoids must hold numbers from 0 to {len(labels) - 1}")
    except ModelError as error:
        raise ModelError(f"{path}: {error}") from None
    except RecursionError:
        raise ModelError(f"{path}: is no model file: its description is nested too deep") from None
    return Outline(
        description["scan_names"],
        description["scan_labels"],
        [row for row, _ in description["skipped"]],
        description["concept_names"],
        description["concept_keys"],
        labels,
        medoids,
        description["granularity"],
    )
