"""How far objects are from each other as wholes, without segments and motifs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.topology import jensen_shannon_divergences


def whole_divergences(
    histograms: NDArray[np.float16],
    is_object: NDArray[np.bool_],
    members: NDArray[np.int64],
    described: Sequence[DescribedObject | None] | None,
) -> NDArray[np.float64]:
    """Divergence of whole objects from those of some training scans, bits.

    Parameters
    ----------
    histograms : (o, b) float16
        Of the training scans that could be described, as wholes.
    is_object : (n,) bool
        Which of all training scans these are.
    members : (p,) int64
        Training scans to be compared with.
    described : sequence of (DescribedObject or None), or None
        None: all training scans.

    Returns
    -------
    (m, p) float64
        NaN in the row of what is not described.
    """
    known = histograms[np.cumsum(is_object)[members] - 1]
    if described is None:
        usable, rows = is_object, histograms
    else:
        usable = np.array([one is not None for one in described], bool)
        whole = [one.description.whole().astype(known.dtype) for one in described if one]
        rows = np.array(whole) if whole else known[:0]
    divergences = np.full((len(usable), len(known)), np.nan)
    divergences[usable] = jensen_shannon_divergences(rows, known)
    return divergences
