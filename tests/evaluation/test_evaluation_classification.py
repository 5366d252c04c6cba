"""The machine that is the same for all rows."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from shapeconcepts.evaluation import svm_errors, svm_predictions
from topology_reference import slow_divergences

RNG = np.random.default_rng(0)
LABELS = np.repeat(["a", "b", "c"], 12)
CENTRES = RNG.dirichlet(np.ones(6), 3)
ROWS = np.array([RNG.dirichlet(20 * CENTRES["abc".index(label)]) for label in LABELS])
TRAINING, TEST = np.arange(36)[::2], np.arange(36)[1::2]


def test_histograms_are_compared_by_divergence() -> None:
    between = slow_divergences(ROWS[TRAINING], ROWS[TRAINING])
    scale = between.mean()
    machine = SVC(kernel="precomputed", C=10).fit(np.exp(-between / scale), LABELS[TRAINING])
    expected = machine.predict(np.exp(-slow_divergences(ROWS[TEST], ROWS[TRAINING]) / scale))
    for form in (np.asarray, csr_matrix):
        predicted = svm_predictions(form(ROWS[TRAINING]), LABELS[TRAINING], form(ROWS[TEST]), "histogram")
        assert predicted.tolist() == expected.tolist()
    assert svm_errors(ROWS[TRAINING], LABELS[TRAINING], ROWS[TEST], LABELS[TEST], "histogram") == {
        label: np.mean(expected[LABELS[TEST] == label] != label) for label in "abc"
    }


def test_responses_are_standardised_and_gaps_filled() -> None:
    responses = -np.log(ROWS + 1e-3) * [1, 1, 100, 1, 1, 1]
    gaps = responses.copy()
    gaps[[0, 1, 4]] = np.nan
    filled = np.where(np.isnan(gaps), np.nanmean(gaps[TRAINING], axis=0), gaps)
    machine = make_pipeline(StandardScaler(), SVC(C=10, gamma="scale")).fit(
        filled[TRAINING], LABELS[TRAINING]
    )
    predicted = svm_predictions(gaps[TRAINING], LABELS[TRAINING], gaps[TEST], "response")
    assert predicted.tolist() == machine.predict(filled[TEST]).tolist()


@pytest.mark.filterwarnings("error")
def test_rows_that_say_nothing_give_an_answer() -> None:
    labels = ["a", "a", "a", "b"]
    assert svm_predictions(np.ones((4, 2)), labels, np.ones((1, 2)), "histogram").tolist() == ["a"]
    assert svm_predictions(np.full((4, 2), np.nan), labels, [[1.0, np.nan]], "response").tolist() == ["a"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((ROWS, LABELS, ROWS, "rows"), "kind must be one of 'histogram', 'response', got 'rows'"),
        ((ROWS, LABELS[:3], ROWS, "histogram"), r"one for each of 36 rows, got \(3,\)"),
        ((ROWS, ["a"] * 36, ROWS, "histogram"), r"at least two labels, got \['a'\]"),
        ((ROWS, LABELS, ROWS[:, :2], "response"), "6 columns as training_rows, got 2"),
        (
            (ROWS, LABELS, np.full((36, 6), np.inf), "response"),
            "test_rows must be a matrix of finite numbers or NaN",
        ),
        ((-ROWS, LABELS, ROWS, "histogram"), "finite numbers of at least 0"),
    ],
)
def test_unsuitable_rows_are_refused(arguments, message) -> None:
    with pytest.raises(ValueError, match=message):
        svm_predictions(*arguments)
