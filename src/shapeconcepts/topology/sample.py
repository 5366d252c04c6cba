"""A sample of sparse rows that follows how frequent they are, the same whatever their order."""

from __future__ import annotations

from itertools import pairwise
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix


def draws(rows: csr_matrix) -> NDArray[np.int64]:
    """A number for each row that a hash of its content draws: it is random, and knows no order, (n,) int64.

    Parameters
    ----------
    rows : (n, c) csr_matrix of float64
        With sum 1, or empty.
    """
    # Of thousandths, as last bits differ between processors.
    thousandths = np.round(1000 * rows.data).astype("<i2")
    kept = thousandths > 0
    entries = np.empty(int(kept.sum()), np.dtype([("column", "<i4"), ("value", "<i2")]))
    entries["column"], entries["value"] = rows.indices[kept], thousandths[kept]
    content, size = entries.tobytes(), entries.itemsize
    ends = np.concatenate([[0], np.cumsum(kept)])[rows.indptr].tolist()
    return np.array([crc32(content[a * size : b * size]) for a, b in pairwise(ends)], np.int64)


def sampled(drawn: NDArray[np.int64], n_most: int) -> NDArray[np.int64]:
    """The rows with the smallest draws, at most so many, rising; of equal draws the first ones."""
    return np.sort(np.argsort(drawn, kind="stable")[:n_most])
