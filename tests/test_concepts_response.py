"""Responses of concepts (paper: equation 3) against plain NumPy, and the most alike concept."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.spatial.distance import jensenshannon
from threadpoolctl import threadpool_limits

from shapeconcepts import ConceptResponse
from topology_reference import random_rows, slow_divergences

DISTANCES = ("divergence", "mahalanobis")
by_both_distances = pytest.mark.parametrize("distance", DISTANCES)


def shares(rows: np.ndarray) -> np.ndarray:
    return rows / rows.sum(axis=1, keepdims=True)


def example(
    seed: int, n: int = 60, n_columns: int = 25, density: float = 0.7
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Training rows of four kinds, some of them empty, their concepts, new rows."""
    rng = np.random.default_rng(seed)
    kinds = random_rows(rng, 4, n_columns, 0.6) + 0.01
    which = rng.integers(0, 4, n + 20)
    rows = kinds[which] * rng.gamma(3, 1, (n + 20, n_columns)) * (rng.random((n + 20, n_columns)) < density)
    rows[[3, n + 4]] = 0
    return rows[:n], np.array([0, 1, 5, -1])[which[:n]], rows[n:]


def slow_whitening(centred: np.ndarray) -> np.ndarray:
    """Main eigenvectors of the covariance over their standard deviation: 95 % of the variance, at most 30."""
    n, n_columns = centred.shape
    # The eigenvectors of the rows' products, times the rows, are those of the covariance.
    fewer_rows = n < n_columns
    variances, vectors = np.linalg.eigh(
        (centred @ centred.T if fewer_rows else centred.T @ centred) / (n - 1)
    )
    variances, vectors = variances[::-1], vectors[:, ::-1]
    kept = min(1 + int((np.cumsum(variances) / variances.sum() < 0.95).sum()), 30, n - 1)
    variances, vectors = variances[:kept], vectors[:, :kept]
    if fewer_rows:
        vectors = centred.T @ vectors / np.sqrt((n - 1) * variances)
    return vectors / np.sqrt(variances)


def slow_responses(distance: str, rows: np.ndarray, labels: np.ndarray, new: np.ndarray) -> np.ndarray:
    placed = rows.any(axis=1)
    training, concepts = shares(rows[placed]), labels[placed]
    if distance == "mahalanobis":
        whitening = slow_whitening(training - training.mean(axis=0))
    responses = np.full((len(new), len(np.unique(concepts[concepts >= 0]))), np.nan)
    for i in np.flatnonzero(new.any(axis=1)):
        if distance == "mahalanobis":
            distances = np.linalg.norm(shares(new[[i]]) @ whitening - training @ whitening, axis=1)
        else:
            distances = np.array([jensenshannon(new[i], row, base=2) ** 2 for row in training])
        for column, concept in enumerate(np.unique(concepts[concepts >= 0])):
            responses[i, column] = distances[concepts == concept].mean()
    return responses


# A few columns, more columns than rows, more than 30 components, and a matrix too large to be dense.
@pytest.mark.parametrize(("n", "n_columns"), [(60, 4), (60, 25), (20, 80), (120, 150), (300, 7000)])
@by_both_distances
def test_against_numpy_and_scipy(n, n_columns, distance):
    rows, labels, new = example(n_columns, n, n_columns, 0.7 if n_columns < 1000 else 0.01)
    response = ConceptResponse(distance).fit(csr_matrix(rows), labels)
    assert response.classes_.tolist() == [0, 1, 5]
    expected = slow_responses(distance, rows, labels, new)
    responses = response.transform(new)
    assert responses.shape == (20, 3) and responses.dtype == np.float64
    np.testing.assert_allclose(responses, expected, rtol=1e-8, equal_nan=True)
    assert distance == "mahalanobis" or np.nanmax(responses) <= 1
    assert np.isnan(responses[4]).all() and np.isfinite(np.delete(responses, 4, 0)).all()


@pytest.mark.parametrize("n_columns", [25, 150])
@by_both_distances
def test_alone_in_a_batch_and_sparse(n_columns, distance):
    rows, labels, new = example(0, 80, n_columns)
    response = ConceptResponse(distance).fit(rows, labels)
    batch, predicted = response.transform(new), response.predict(new)
    for k in range(len(new)):
        assert response.transform(new[[k]]).tobytes() == batch[[k]].tobytes()
        assert response.predict(new[[k]]) == predicted[k]
    for part in (slice(5, 12), slice(None, None, -1)):
        assert response.transform(new[part]).tobytes() == np.ascontiguousarray(batch[part]).tobytes()
    again = ConceptResponse(distance).fit(csr_matrix(rows), labels)
    assert again.transform(csr_matrix(new)).tobytes() == batch.tobytes()
    np.testing.assert_array_equal(again.predict(csr_matrix(new)), predicted)


@by_both_distances
def test_number_of_threads_does_not_matter(distance):
    """Of those that BLAS and LAPACK take: as many as the machine has, or fewer in the processes of joblib."""
    rng = np.random.default_rng(0)
    rows, labels = rng.gamma(2, 1, (60, 200)), rng.integers(0, 4, 60)
    answers = set()
    for n_threads in (1, 2, 4):
        with threadpool_limits(n_threads):
            response = ConceptResponse(distance).fit(rows, labels)
            answers.add((response.whitening_.tobytes(), response.transform(rows).tobytes()))
    assert len(answers) == 1


@by_both_distances
def test_scale_of_a_row_does_not_matter(distance):
    rows, labels, new = example(1)
    response = ConceptResponse(distance).fit(rows, labels)
    factors = np.random.default_rng(0).uniform(1e-5, 1e5, (80, 1))
    other = ConceptResponse(distance).fit(rows * factors[:60], labels)
    np.testing.assert_allclose(other.transform(new * factors[60:]), response.transform(new), rtol=1e-7)


@pytest.mark.parametrize("seed", range(6))
@by_both_distances
def test_predict_is_the_concept_of_the_nearest_prototypes(seed, distance):
    rows, labels, new = example(seed)
    # So that a concept has fewer than ten.
    labels[np.flatnonzero(labels == 5)[: -4 - seed]] = -1
    rng = np.random.default_rng(seed)
    new[-5:] = random_rows(rng, 5, 25, 0.1)
    response = ConceptResponse(distance).fit(rows, labels)
    is_prototype = rows.any(axis=1) & (labels >= 0)
    between = slow_divergences(new, rows[is_prototype])
    longest = slow_longest_step(rows[is_prototype])
    assert response.largest_divergence_ == pytest.approx(longest, abs=1e-12)
    concepts = np.unique(labels[is_prototype])
    means = [
        np.sort(between[:, labels[is_prototype] == concept])[:, :10].mean(axis=1) for concept in concepts
    ]
    nearest = concepts[np.argmin(means, axis=0)]
    known = new.any(axis=1) & (between.min(axis=1) <= longest)
    np.testing.assert_array_equal(response.predict(new), np.where(known, nearest, -1))
    assert len(set(response.predict(new).tolist())) > 2


def slow_longest_step(rows: np.ndarray) -> float:
    """Longest edge of the rows' spanning tree that joins what has something in common."""
    between = slow_divergences(rows, rows)
    inside, longest = {0}, 0.0
    while len(inside) < len(rows):
        step, _, b = min((between[a, b], a, b) for a in inside for b in range(len(rows)) if b not in inside)
        inside.add(b)
        if step < 1 - 1e-12:
            longest = max(longest, step)
    return longest


@by_both_distances
def test_unknown(distance):
    rows = np.array([[4, 1, 0, 0, 0], [1, 4, 0, 0, 0], [2, 2, 0, 0, 0], [0, 0, 3, 1, 0], [0, 0, 1, 3, 0.0]])
    response = ConceptResponse(distance).fit(rows, [0, 0, 0, 1, 1])
    new = [[1, 1, 0, 0, 0], [0, 0, 1, 1, 0], [0, 0, 0, 0, 1], [1, 0, 0, 0, 9], [0, 0, 0, 0, 0]]
    assert response.predict(new).tolist() == [0, 1, -1, -1, -1]
    # What shares nothing has a response, what is empty has none.
    assert np.isnan(response.transform(new)).all(axis=1).tolist() == [False] * 4 + [True]


@pytest.mark.parametrize("n_columns", [0, 3])
@pytest.mark.parametrize("n", [1, 2, 7])
@by_both_distances
def test_no_concepts(n, n_columns, distance):
    rows = np.ones((n, n_columns))
    response = ConceptResponse(distance).fit(rows, np.full(n, -1))
    assert response.transform(rows).shape == (n, 0)
    assert response.predict(rows).tolist() == [-1] * n
    assert response.get_feature_names_out().tolist() == [] and response.classes_.tolist() == []


@by_both_distances
def test_no_rows_to_respond_to(distance):
    rows, labels, _ = example(0)
    response = ConceptResponse(distance).fit(rows, labels)
    assert response.transform(np.empty((0, 25))).shape == (0, 3)
    assert response.predict(csr_matrix((0, 25))).shape == (0,)


@pytest.mark.filterwarnings("error")
@by_both_distances
def test_one_concept_and_rows_that_are_all_equal(distance):
    rows, _, new = example(2)
    response = ConceptResponse(distance).fit(rows, np.zeros(60, int))
    np.testing.assert_allclose(
        response.transform(new),
        slow_responses(distance, rows, np.zeros(60, int), new),
        rtol=1e-8,
        equal_nan=True,
    )
    assert response.get_feature_names_out().tolist() == ["concept0"]
    same = ConceptResponse(distance).fit(np.tile([1.0, 2, 3], (6, 1)), [0, 0, 0, 1, 1, -1])
    # There is no variance to measure a distance by.
    expected = jensenshannon([1, 2, 3], [3, 2, 1], base=2) ** 2 if distance == "divergence" else 0
    np.testing.assert_allclose(
        same.transform([[1, 2, 3], [3, 2, 1]]), [[0, 0], [expected, expected]], atol=1e-12
    )
    assert same.predict([[2, 4, 6], [3, 2, 1]]).tolist() == [0, -1]


@by_both_distances
def test_only_empty_rows_in_the_concepts(distance):
    response = ConceptResponse(distance).fit([[0, 0], [0, 0], [1, 2], [2, 1]], [0, 0, -1, -1])
    assert response.classes_.tolist() == [] and response.predict([[1, 2]]).tolist() == [-1]


@by_both_distances
def test_labels_that_are_whole_numbers(distance):
    rows, labels, new = example(3)
    expected = ConceptResponse(distance).fit(rows, labels).transform(new)
    for kind in (np.int32, np.int8, np.float64, list):
        converted = labels.tolist() if kind is list else labels.astype(kind)
        response = ConceptResponse(distance).fit(rows, converted)
        np.testing.assert_array_equal(response.transform(new), expected)
        assert response.predict(new).dtype == np.int64
    assert ConceptResponse(distance).fit(rows, labels).get_feature_names_out().tolist() == [
        "concept0", "concept1", "concept5",
    ]  # fmt: skip


@pytest.mark.parametrize("labels", [["a"] * 4, [0, 1, -2, 0], [0, 0.5, 1, 1], [True, False, True, True]])
def test_labels_of_other_types(labels):
    with pytest.raises(ValueError, match="y must hold integers of at least -1, got"):
        ConceptResponse().fit(np.eye(4), labels)


@by_both_distances
def test_bad_input(distance):
    rows, labels, new = example(0)
    response = ConceptResponse(distance).fit(rows, labels)
    for method in (response.transform, response.predict):
        with pytest.raises(ValueError, match="X has 24 features, but ConceptResponse is expecting 25"):
            method(new[:, 1:])
        with pytest.raises(ValueError, match="Negative values in data"):
            method(-new)
        with pytest.raises(ValueError, match="contains NaN"):
            method(np.where(new > 0.1, np.nan, new))
    with pytest.raises(ValueError, match="inconsistent numbers of samples"):
        ConceptResponse(distance).fit(rows, labels[:-1])
    with pytest.raises(ValueError, match="requires y to be passed"):
        ConceptResponse(distance).fit(rows, None)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"distance": "cosine"}, r"a str among {('divergence'|'mahalanobis'|, ){3}}. Got 'cosine'"),
        ({"n_nearest": 0}, r"an int in the range \[1, 2147483647\]. Got 0"),
        ({"max_components": True}, r"an int in the range \[1, 2147483647\]. Got 'True'"),
        ({"variance_kept": 1.5}, r"a float in the range \[0.0, 1.0\]. Got 1.5"),
    ],
)
def test_bad_parameters(parameters, message):
    (name,) = parameters
    expected = f"The '{name}' parameter of ConceptResponse must be {message} instead"
    with pytest.raises(ValueError, match=expected):
        ConceptResponse(**parameters).fit(np.eye(4), [0, 0, 1, 1])


def test_divergence_needs_no_components():
    rows, labels, _ = example(0)
    assert ConceptResponse().fit(rows, labels).whitening_.shape == (25, 0)
    assert ConceptResponse("mahalanobis").fit(rows, labels).whitening_.shape[1] > 2


def test_divergence_of_what_shares_nothing_is_one():
    response = ConceptResponse().fit([[1, 1, 0, 0], [2, 2, 0, 0], [0, 0, 1, 0]], [0, 0, 1])
    new = [[3, 3, 0, 0], [0, 0, 0, 1], [1, 0, 0, 0], [0, 0, 0, 0]]
    of_half = jensenshannon([1, 0], [0.5, 0.5], base=2) ** 2
    np.testing.assert_allclose(
        response.transform(new), [[0, 1], [1, 1], [of_half, 1], [np.nan, np.nan]], atol=1e-15
    )


def test_a_sample_stands_for_many_training_rows():
    rng = np.random.default_rng(3)
    rows = csr_matrix(rng.dirichlet(np.ones(12), 3000))
    labels = np.repeat([0, 1, 2, -1], [2500, 300, 100, 100])
    order = rng.permutation(3000)
    rows, labels = rows[order], labels[order]
    all_of_them = ConceptResponse(max_prototypes=3000).fit(rows, labels)
    assert np.array_equal(all_of_them.prototype_rows_, np.flatnonzero(labels >= 0))
    few = ConceptResponse(max_prototypes=580).fit(rows, labels)
    assert np.bincount(few.prototype_concepts_).tolist() == [500, 64, 64]
    assert np.array_equal(labels[few.prototype_rows_], few.prototype_concepts_)
    np.testing.assert_allclose(few.prototypes_.toarray(), rows[few.prototype_rows_].toarray())
    new = rng.dirichlet(np.ones(12), 50)
    assert np.abs(few.transform(new) - all_of_them.transform(new)).max() < 0.05
    # The same rows in another order.
    again = rng.permutation(3000)
    other = ConceptResponse(max_prototypes=580).fit(rows[again], labels[again])
    assert sorted(again[other.prototype_rows_].tolist()) == few.prototype_rows_.tolist()
