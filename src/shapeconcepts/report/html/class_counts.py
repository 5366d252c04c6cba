"""How many classes of scans there are at any time, told in few numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration
from shapeconcepts.report.html.time_scale import TimeScale
from shapeconcepts.topology.annexation_kernels import annex

# Steps of the axis of time of which one has the numbers, of all the slider's and more than there are pixels.
_STEPS = 4000


def class_counts(
    filtration: Filtration, is_between: NDArray[np.bool_], scale: TimeScale
) -> dict[str, list[Any]]:
    """Classes of all scans over time.

    Parameters
    ----------
    filtration : Filtration
    is_between : (e,) bool
        Edges that never enter.
    scale : TimeScale

    Returns
    -------
    dict of str to list
        Of the same length: "times" from which on the other numbers hold, rising from 0; number of "classes";
        number of "groups", which are those of a concept's size; and the scans of the "largest".
    """
    edges, times = filtration.edges_[~is_between], filtration.times_[~is_between]
    sizes, least = filtration.space_.multiplicities_, filtration.min_concept_size
    _, _, dying, surviving = annex(edges, sizes)
    joined = dying + surviving
    changes = (joined >= least).astype(np.int64) - (dying >= least) - (surviving >= least)
    groups = int((sizes >= least).sum()) + np.concatenate([[0], np.cumsum(changes)])
    largest = np.maximum.accumulate(np.concatenate([[sizes.max(initial=0)], joined]))
    kept = np.arange(len(times) + 1)
    if len(times) > _STEPS:
        moments = scale.times(np.arange(_STEPS + 1) / _STEPS)
        moments = np.append(moments, filtration.concept_time_ or 0.0)
        kept = np.unique(np.append(np.searchsorted(times, moments, side="right"), 0))
    return {
        "times": np.concatenate([[0.0], times])[kept].tolist(),
        "classes": (len(sizes) - kept).tolist(),
        "groups": groups[kept].tolist(),
        "largest": largest[kept].tolist(),
    }
