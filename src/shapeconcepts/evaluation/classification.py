"""One support vector machine for all rows: motif stimuli, whole-object histograms and concept responses."""

from __future__ import annotations

import warnings
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import sparray, spmatrix
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from shapeconcepts.evaluation.metrics import mean_error_over_labels
from shapeconcepts.topology import jensen_shannon_divergences

C = 10.0
KINDS = ("histogram", "response")

Rows: TypeAlias = ArrayLike | spmatrix | sparray


def svm_predictions(
    training_rows: Rows, training_labels: ArrayLike, test_rows: Rows, kind: str
) -> NDArray[np.str_]:
    """Labels that a support vector machine (C = 10) gives to the test rows.

    Parameters
    ----------
    training_rows : (n, b) array-like or sparse matrix
    training_labels : (n,) array-like of str
        At least two different ones.
    test_rows : (m, b) array-like or sparse matrix
    kind : {"histogram", "response"}
        Histograms are non-negative; their kernel is ``exp(-JSD / s)``, s the mean divergence of the training
        pairs. Responses are any finite numbers, or NaN where an object has none, which counts as the mean of
        the training rows; they are standardised and compared by a radial basis function of scikit-learn's
        width "scale".

    Returns
    -------
    (m,) str

    Raises
    ------
    ValueError
        If `kind` is unknown, shapes do not fit, numbers are out of range, or there is one label only.
    """
    labels = np.asarray(training_labels)
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(map(repr, KINDS))}, got {kind!r}")
    if labels.shape != (np.shape(training_rows)[0],):
        raise ValueError(
            f"training_labels must be one for each of {np.shape(training_rows)[0]} rows, got {labels.shape}"
        )
    if len(np.unique(labels)) < 2:
        raise ValueError(f"training_labels must hold at least two labels, got {np.unique(labels).tolist()}")
    if kind == "histogram":
        return _predict_histograms(training_rows, labels, test_rows)
    return _predict_responses(training_rows, labels, test_rows)


def svm_errors(
    training_rows: Rows, training_labels: ArrayLike, test_rows: Rows, test_labels: ArrayLike, kind: str
) -> dict[str, float]:
    """Error in [0, 1] of each label among the test rows, by sorted label; see `svm_predictions`."""
    predicted = svm_predictions(training_rows, training_labels, test_rows, kind)
    return mean_error_over_labels(test_labels, predicted)[0]


def _predict_histograms(training: Rows, labels: NDArray[np.str_], test: Rows) -> NDArray[np.str_]:
    divergences = jensen_shannon_divergences(training)
    # Where all rows are equal any scale will do.
    scale = divergences.mean() or 1.0
    machine = SVC(kernel="precomputed", C=C).fit(np.exp(-divergences / scale), labels)
    return machine.predict(np.exp(-jensen_shannon_divergences(test, training) / scale))


def _predict_responses(training: Rows, labels: NDArray[np.str_], test: Rows) -> NDArray[np.str_]:
    known, new = _responses(training, "training_rows"), _responses(test, "test_rows")
    if known.shape[1] != new.shape[1]:
        raise ValueError(f"test_rows must have {known.shape[1]} columns as training_rows, got {new.shape[1]}")
    with warnings.catch_warnings():
        # A response that no training object has is the same for all.
        warnings.filterwarnings("ignore", "Mean of empty slice", RuntimeWarning)
        means = np.nan_to_num(np.nanmean(known, axis=0))
    known, new = (np.where(np.isnan(rows), means, rows) for rows in (known, new))
    machine = make_pipeline(StandardScaler(), SVC(C=C, gamma="scale")).fit(known, labels)
    return machine.predict(new)


def _responses(rows: Rows, name: str) -> NDArray[np.float64]:
    matrix = np.asarray(rows, np.float64)
    if matrix.ndim != 2 or 0 in matrix.shape or np.isinf(matrix).any():
        raise ValueError(f"{name} must be a matrix of finite numbers or NaN, got shape {matrix.shape}")
    return matrix
