"""Jensen-Shannon divergence between the rows of sparse matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix, sparray, spmatrix

from shapeconcepts.topology.divergence_kernels import divergences_between
from shapeconcepts.topology.inverted_index_kernels import inverted_index
from shapeconcepts.topology.nearest_kernels import indexed_divergences, nearest_rows


def jensen_shannon_divergences(
    first: ArrayLike | spmatrix | sparray, second: ArrayLike | spmatrix | sparray | None = None
) -> NDArray[np.float64]:
    """Jensen-Shannon divergence in bits of every two rows, as a dense matrix.

    Parameters
    ----------
    first : (n, c) array-like or sparse matrix
        Non-negative. Rows are scaled to sum 1 before they are compared.
    second : (m, c) array-like or sparse matrix, optional
        `first` itself by default.

    Returns
    -------
    (n, m) float64
        From 0 (equal but for their scale) to 1 (nothing in common). A row without any entry is at 1 from all,
        itself included.

    Raises
    ------
    ValueError
        If a matrix is not two-dimensional, holds negative or non-finite numbers, or the columns do not match.
    """
    first_rows = normalised_rows(first, "first")
    second_rows = first_rows if second is None else normalised_rows(second, "second")
    if first_rows.shape[1] != second_rows.shape[1]:
        raise ValueError(
            "first and second must have as many columns, "
            f"got {first_rows.shape[1]} and {second_rows.shape[1]}"
        )
    return divergences_between(*_arrays(first_rows), *_arrays(second_rows), first_rows.shape[1])


class DivergenceIndex:
    """Rows by column, from which the divergences of other rows are quick: most share few columns with most.

    Parameters
    ----------
    rows : (m, c) csr_matrix of float64
        As `normalised_rows` gives them.
    """

    def __init__(self, rows: csr_matrix) -> None:
        self._n_rows = rows.shape[0]
        self._lists = inverted_index(*_arrays(rows), _terms(rows), rows.shape[1])

    def divergences(self, rows: csr_matrix) -> NDArray[np.float64]:
        """Jensen-Shannon divergence in bits of rows (n, c) from the indexed ones, (n, m) float64.

        The same as `jensen_shannon_divergences` but for rounding.
        """
        return indexed_divergences(*_arrays(rows), _terms(rows), self._n_rows, *self._lists)

    def nearest(self, rows: csr_matrix) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Nearest indexed row to each of rows (n, c), the first of equally near ones, and the divergence.

        There must be one at least.
        """
        return nearest_rows(*_arrays(rows), _terms(rows), self._n_rows, *self._lists)


def normalised_rows(rows: ArrayLike | spmatrix | sparray, name: str) -> csr_matrix:
    """Rows scaled to sum 1, without explicit zeros; empty rows stay empty.

    Raises
    ------
    ValueError
        If `rows` is not two-dimensional, or holds negative or non-finite numbers.
    """
    if np.ndim(rows) != 2:
        raise ValueError(f"{name} must be a matrix, got {np.ndim(rows)} dimensions")
    matrix = csr_matrix(rows, dtype=np.float64, copy=True)
    if not (np.isfinite(matrix.data).all() and (matrix.data >= 0).all()):
        raise ValueError(f"{name} must hold finite numbers of at least 0, got others")
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    lengths = np.diff(matrix.indptr)
    sums = np.add.reduceat(matrix.data, matrix.indptr[:-1][lengths > 0]) if matrix.nnz else np.empty(0)
    matrix.data /= np.repeat(sums, lengths[lengths > 0])
    # What is too small beside the rest of its row has become 0.
    matrix.eliminate_zeros()
    return matrix


def _terms(matrix: csr_matrix) -> NDArray[np.float64]:
    terms: NDArray[np.float64] = matrix.data * np.log2(matrix.data)
    return terms


def _arrays(matrix: csr_matrix) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]:
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int32, copy=False), matrix.data
