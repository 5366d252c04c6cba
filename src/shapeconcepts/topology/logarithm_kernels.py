"""Logarithms of many numbers at once: a table and a short series, without branches or calls."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

BLOCK = 128

_N_INTERVALS = 256
_CENTRES = 1 + (np.arange(_N_INTERVALS) + 0.5) / _N_INTERVALS
_INVERSE_CENTRES = 1 / _CENTRES
_LOGARITHMS = np.log2(_CENTRES)
_MANTISSA = (1 << 52) - 1
_EXPONENT_OF_ONE = 1023 << 52
_LOG2_E = 1 / math.log(2)


@kernel
def shared_terms(
    n: int,
    values: NDArray[np.float64],
    value_terms: NDArray[np.float64],
    start: int,
    own_value: float,
    own_term: float,
    sums: NDArray[np.float64],
    mantissas: NDArray[np.int64],
    intervals: NDArray[np.int64],
    terms: NDArray[np.float64],
) -> None:
    """What a shared column adds to the similarity of one row to others: f(p + q) - f(p) - f(q), f = x log2 x.

    Agrees with `math.log2` to the last two digits. Each loop compiles to vector instructions, as it writes to
    other arrays than it reads.

    Parameters
    ----------
    n : int
        Number of other rows, at most `BLOCK`.
    values, value_terms : (m,) float64
        Positive values p of the others, from `start` on, and f(p).
    own_value, own_term : float
        Positive q and f(q).
    sums, mantissas, intervals : (BLOCK,) buffers
    terms : (BLOCK,) float64, output
    """
    for k in range(n):
        sums[k] = values[np.uint64(start + k)] + own_value
    bits = sums.view(np.int64)
    for k in range(n):
        intervals[k] = (bits[k] >> 44) & (_N_INTERVALS - 1)
        mantissas[k] = (bits[k] & _MANTISSA) | _EXPONENT_OF_ONE
        terms[k] = (bits[k] >> 52) - 1023
    mantissa = mantissas.view(np.float64)
    for k in range(n):
        interval = np.uint64(intervals[k])
        r = mantissa[k] * _INVERSE_CENTRES[interval] - 1.0
        series = _LOG2_E * r * (1.0 - r * (1 / 2 - r * (1 / 3 - r * (1 / 4 - r * (1 / 5)))))
        logarithm = terms[k] + _LOGARITHMS[interval] + series
        terms[k] = sums[k] * logarithm - (value_terms[np.uint64(start + k)] + own_term)
