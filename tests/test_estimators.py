"""The topological half as estimators of their own: scikit-learn's contract. Dictionaries: `tests/motifs`."""

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.utils.estimator_checks import parametrize_with_checks

from shapeconcepts import ConceptResponse, Filtration, TopologicalSpace
from topology_reference import random_rows

NO_COLUMNS = "a matrix without columns is what objects have that share no motif: they have no place"
FAILURES = {
    TopologicalSpace: {"check_estimators_empty_data_messages": NO_COLUMNS},
    Filtration: {
        "check_estimators_empty_data_messages": NO_COLUMNS,
        "check_clustering": "gives negative numbers, in spite of the tag positive_only",
    },
    ConceptResponse: {
        "check_estimators_empty_data_messages": NO_COLUMNS,
        "check_dtype_object": "asks for a message about unknown labels, where concepts are integers",
    },
}


@pytest.mark.filterwarnings("ignore:the filtration of")
@parametrize_with_checks(
    [
        TopologicalSpace(),
        Filtration(),
        Filtration(heat="geodesic", stop="annexations"),
        ConceptResponse(),
        ConceptResponse("mahalanobis"),
    ],
    expected_failed_checks=lambda estimator: FAILURES[type(estimator)],
)
def test_scikit_learn_contract(estimator, check):
    check(estimator)


@pytest.mark.parametrize("parameters", [{}, {"heat": "geodesic", "stop": "annexations"}])
def test_clusters_of_any_matrix(parameters):
    """What scikit-learn's own check of clustering asks for, on numbers that are not negative."""
    rng = np.random.default_rng(0)
    kinds = np.kron(np.eye(3), np.ones(4))
    rows = kinds[np.repeat(range(3), 20)] * rng.gamma(4, 1, (60, 12)) + 0.01
    filtration = Filtration(**parameters)
    labels = filtration.fit_predict(rows)
    np.testing.assert_array_equal(labels, filtration.labels_)
    np.testing.assert_array_equal(labels, clone(filtration).fit(rows.tolist()).labels_)
    assert set(labels) - {-1} == set(range(len(filtration.concepts_))) and len(filtration.concepts_) >= 2
    # Every concept is of one kind.
    for concept in filtration.concepts_:
        assert len(set((concept.members // 20).tolist())) == 1


def test_parameters():
    filtration = Filtration(5, 50, "geodesic", "annexations", 0.2, 0.3, 80, 2)
    assert clone(filtration).get_params() == {
        "min_concept_size": 5, "max_steps": 50, "heat": "geodesic", "stop": "annexations",
        "error_rate": 0.2, "granularity": 0.3, "max_vertices": 80, "n_jobs": 2,
    }  # fmt: skip
    assert ConceptResponse("mahalanobis", 5, 7, 0.5, 400).get_params() == {
        "distance": "mahalanobis", "n_nearest": 5, "max_components": 7, "variance_kept": 0.5,
        "max_prototypes": 400,
    }  # fmt: skip
    assert filtration.set_params(max_steps=7).max_steps == 7
    with pytest.raises(ValueError, match="Invalid parameter"):
        filtration.set_params(min_size=3)
    rows = random_rows(np.random.default_rng(0), 30, 10)
    assert not hasattr(clone(filtration.fit(rows)), "labels_")
