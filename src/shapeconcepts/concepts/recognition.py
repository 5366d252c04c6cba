"""Which concept a scan belongs to: the one of whose members it reminds most."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

# A segment that reminds less of a concept is none of its: few of a scan's own segments do, and most of those
# of something else.
LEAST_REMINDER = 0.1


class Recognition(NamedTuple):
    """What a model says of scans.

    Attributes
    ----------
    concepts : (m,) int64
        Concept of each scan, -1 where it is unknown.
    responses : (m, n_concepts) float64
        Paper, equation 3; smaller is more alike. NaN in the row of a scan without any stimulus.
    shares : (m, n_concepts) float64 or None
        Share of what each scan reminds of that the members of each concept have, 0 to 1; zeros where it
        reminds of nothing, and None where the stimuli are of motifs, which know no members.
    p_values : (m,) float64 or None
        Probability that a scan of something known would be as unlike all training scans, or more; see
        `Novelty`. None where the ensemble is one of one's own.
    """

    concepts: NDArray[np.int64]
    responses: NDArray[np.float64]
    shares: NDArray[np.float64] | None
    p_values: NDArray[np.float64] | None


def concept_shares(
    reminders: csr_matrix, concepts: NDArray[np.integer], n_concepts: int
) -> NDArray[np.float64]:
    """Share of what scans remind of that the members of each concept have.

    Parameters
    ----------
    reminders : (m, n) csr_matrix of float64
        How much each scan reminds of each training object.
    concepts : (n,) int
        Concept of each training object, -1 for none.
    n_concepts : int

    Returns
    -------
    (m, n_concepts) float64
        Rows sum to 1 at most: what objects in no concept remind of belongs to none.
    """
    # Row by row: summed over a matrix, the rounding of a row would depend on how many there are.
    shares = np.zeros((reminders.shape[0], n_concepts))
    for row, (start, end) in enumerate(zip(reminders.indptr[:-1], reminders.indptr[1:], strict=True)):
        of, weights = concepts[reminders.indices[start:end]], reminders.data[start:end]
        total = weights.sum()
        if total > 0:
            known = of >= 0
            shares[row] = np.bincount(of[known], weights[known], n_concepts) / total
    return shares


def foreign_segments(reminders: csr_matrix, concepts: NDArray[np.integer], concept: int) -> tuple[int, ...]:
    """Segments of a scan that hardly remind of the concept that it is recognised as, while others do.

    Where none does, there is nothing for the others to be foreign to, and none is.

    Parameters
    ----------
    reminders : (s, n) csr_matrix of float64
        How much each segment by itself reminds of each training object, with a strength of 0 to 1.
    concepts : (n,) int
        Concept of each training object, -1 for none.
    concept : int
    """
    of_concept = csr_matrix(reminders)[:, np.flatnonzero(concepts == concept)].sum(axis=1)
    is_foreign = np.asarray(of_concept).ravel() < LEAST_REMINDER
    return () if is_foreign.all() else tuple(np.flatnonzero(is_foreign).tolist())
