"""A sample of sparse rows that follows how frequent they are, the same whatever their order."""

from __future__ import annotations

from itertools import pairwise
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

# What is made of rows to compare them takes several times their memory.
ROWS_AT_ONCE = 4096


def draws(rows: csr_matrix) -> NDArray[np.int64]:
    """A number for each row that a hash of its content draws: it is random, and knows no order, (n,) int64.

    Parameters
    ----------
    rows : (n, c) csr_matrix of float64
        With sum 1, or empty.
    """
    drawn = np.empty(rows.shape[0], np.int64)
    for start in range(0, len(drawn), ROWS_AT_ONCE):
        stop = min(start + ROWS_AT_ONCE, len(drawn))
        entries = slice(rows.indptr[start], rows.indptr[stop])
        # Of thousandths, as last bits differ between processors.
        thousandths = np.round(1000 * rows.data[entries]).astype("<i2")
        kept = thousandths > 0
        content = np.empty(int(kept.sum()), np.dtype([("column", "<i4"), ("value", "<i2")]))
        content["column"], content["value"] = rows.indices[entries][kept], thousandths[kept]
        ends = np.concatenate([[0], np.cumsum(kept)])[rows.indptr[start : stop + 1] - rows.indptr[start]]
        drawn[start:stop] = [crc32(content[a:b].tobytes()) for a, b in pairwise(ends.tolist())]
    return drawn


def sampled(drawn: NDArray[np.int64], n_most: int) -> NDArray[np.int64]:
    """The rows with the smallest draws, at most so many, rising; of equal draws the first ones."""
    return np.sort(np.argsort(drawn, kind="stable")[:n_most])
