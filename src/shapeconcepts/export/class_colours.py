"""Colours of the classes of a data set."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.export.catalogue import ConceptClass
from shapeconcepts.report.palette import LABEL_COLOURS, colours_of


def colour_of(concept: ConceptClass) -> NDArray[np.uint8]:
    """Red, green and blue (3,) of a concept, which an update of the model does not change."""
    return colours_of(np.array([concept.key]), LABEL_COLOURS)[0]
