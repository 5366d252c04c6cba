"""Which splits between classes are real: those with more modes than chance gives.

Null model: the two classes are one, and on the axis between them its objects have a single mode. The dip test
(Hartigan & Hartigan 1985) gives the probability of a dip as deep under the least favourable such model, a
uniform distribution, whatever the number of columns, the scale or the density of the rows. Of all splits
that are tested, those are taken which keep the expected share of false ones under the error rate (Benjamini &
Hochberg 1995); where nothing is split, this is the probability that anything is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.dip import dip_p_value
from shapeconcepts.concepts.split_kernels import split_dips
from shapeconcepts.topology.mean_divergence import ClassOrder


def split_p_values(classes: ClassOrder, tested: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Probability of each split under the null model, (e,) float64; NaN where it is not tested.

    Parameters
    ----------
    classes : ClassOrder
    tested : (e,) bool
        Annexations of two classes that could be concepts.
    """
    dips, counts = split_dips(
        classes.divergences, classes.members, classes.stretches, tested & (classes.stretches[:, 2] > 0)
    )
    p_values = np.full(len(tested), np.nan)
    for k in np.flatnonzero(tested):
        # What is gathered in one place cannot be told apart.
        p_values[k] = dip_p_value(dips[k], int(counts[k])) if counts[k] else 1.0
    return p_values


def significant(p_values: NDArray[np.float64], error_rate: float) -> NDArray[np.bool_]:
    """Which p-values are small enough for a false discovery rate; NaN is none.

    Parameters
    ----------
    p_values : (e,) float64
    error_rate : float
        Largest expected share of false ones among those that are taken.
    """
    tested = np.sort(p_values[~np.isnan(p_values)])
    enough = np.flatnonzero(tested <= error_rate * np.arange(1, len(tested) + 1) / max(len(tested), 1))
    return p_values <= tested[enough[-1]] if len(enough) else np.zeros(len(p_values), bool)
