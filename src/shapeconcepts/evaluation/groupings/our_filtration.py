"""Our own filtration, of any rows."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import sparray, spmatrix

from shapeconcepts.concepts import Filtration
from shapeconcepts.evaluation.groupings.grouping import Grouping


def our_filtration(rows: ArrayLike | spmatrix | sparray) -> Grouping:
    """Group rows as the default preset groups stimuli: it chooses nothing but by itself.

    Parameters
    ----------
    rows : (n, b) array-like or sparse matrix
        Non-negative. A row of zeros is in no group.

    Raises
    ------
    ValueError
        If `rows` is not a matrix of finite numbers of at least 0.
    """
    with warnings.catch_warnings():
        # No group is a result, too.
        warnings.simplefilter("ignore", UserWarning)
        labels = Filtration().fit(rows).labels_
    return Grouping(labels.astype(np.int64))
