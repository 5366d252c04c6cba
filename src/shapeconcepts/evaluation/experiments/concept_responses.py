"""Concept responses as features of a classifier."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from sklearn.base import clone

from shapeconcepts.concepts.response import mean_distances
from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.model import ShapeConceptModel


def fit(described: Sequence[DescribedObject], preset: str, **parameters: object) -> ShapeConceptModel:
    """A model; one without any concept is a result too, and says so by its scores."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return ShapeConceptModel.preset(preset, **parameters).fit(described)


class ResponseDistances(NamedTuple):
    """Distances to all training objects, from which the responses of any concepts follow.

    Attributes
    ----------
    training, test : (n, p), (m, p) float64
        To the p training objects that have a stimulus.
    placed : (p,) int64
        Which of the training objects these are.
    """

    training: NDArray[np.float64]
    test: NDArray[np.float64]
    placed: NDArray[np.int64]

    @classmethod
    def of(cls, model: ShapeConceptModel, test: csr_matrix) -> ResponseDistances:
        """Distances as the model's responses take them.

        The rows of training objects leave their own prototypes out where the model wants that: a test object
        has none.

        Parameters
        ----------
        model : ShapeConceptModel
        test : (m, c) csr_matrix of float64
            Stimuli of test objects.
        """
        one_concept = np.zeros(model.stimuli_.shape[0], np.int64)
        response = clone(model.response_).fit(model.stimuli_, one_concept)
        placed = np.flatnonzero(np.diff(model.stimuli_.indptr))
        return cls(response.distances(model.stimuli_), response.distances(test), placed)

    def responses(self, concept_of: NDArray[np.integer]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Responses of concepts to training and test objects.

        Parameters
        ----------
        concept_of : (n,) int
            Concept of each training object, -1 for none.

        Returns
        -------
        (n, k), (m, k) float64
            NaN in the row of an object without any stimulus. Without any concept there is one column of
            zeros, by which nothing can be told apart.
        """
        concepts = concept_of[self.placed]
        is_prototype = concepts >= 0
        if not is_prototype.any():
            return np.zeros((len(self.training), 1)), np.zeros((len(self.test), 1))
        numbers, members = np.unique(concepts[is_prototype], return_inverse=True)
        return (
            mean_distances(self.training[:, is_prototype], members, len(numbers)),
            mean_distances(self.test[:, is_prototype], members, len(numbers)),
        )
