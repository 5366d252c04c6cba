"""Concept responses as features of a classifier."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from shapeconcepts.concepts import ConceptResponse
from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.topology import Concept


def fit(described: Sequence[DescribedObject], preset: str, **parameters: object) -> ShapeConceptModel:
    """A model; one without any concept is a result too, and says so by its scores."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return ShapeConceptModel.preset(preset, **parameters).fit(described)


def concept_of_objects(concepts: Iterable[Concept], n_objects: int) -> NDArray[np.int64]:
    """Number of each object's concept, -1 for none."""
    number_of = np.full(n_objects, -1)
    for number, concept in enumerate(concepts):
        number_of[concept.members] = number
    return number_of


def concept_responses(
    model: ShapeConceptModel, test: csr_matrix, concept_of: NDArray[np.integer]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Responses of concepts to training and test objects, in the model's distance.

    Parameters
    ----------
    model : ShapeConceptModel
        Fitted to n training objects. Its stimuli leave a training object's own prototypes out where it wants
        that: a test object has none.
    test : (m, c) csr_matrix of float64
        Stimuli of test objects.
    concept_of : (n,) int
        Concept of each training object, -1 for none.

    Returns
    -------
    (n, k), (m, k) float64
        NaN in the row of an object without any stimulus. Without any concept there is one column of zeros, by
        which nothing can be told apart.
    """
    if (concept_of < 0).all():
        return np.zeros((len(concept_of), 1)), np.zeros((test.shape[0], 1))
    response = ConceptResponse(model.response_distance).fit(model.stimuli_, concept_of)
    return response.transform(model.stimuli_), response.transform(test)
