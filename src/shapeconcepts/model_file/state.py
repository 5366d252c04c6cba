"""What a fitted model is made of: all that a file keeps of it."""

from __future__ import annotations

from typing import NamedTuple

from scipy.sparse import csr_matrix

from shapeconcepts.concepts import ConceptResponse, Filtration
from shapeconcepts.concepts.identity import Change
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.descriptors import Descriptor
from shapeconcepts.motifs import MotifHierarchyEnsemble
from shapeconcepts.segmentation import Segmenter


class Update(NamedTuple):
    """What an update of a model changed.

    Attributes
    ----------
    n_before, n_after : int
        Number of scans.
    changes : tuple of Change
        Concepts that were born, grew, split, merged or dissolved.
    moved : tuple of (int, int, int)
        Scans that are in a concept of another identity than before, with both identities; -1 is none. Of the
        last update only.
    """

    n_before: int
    n_after: int
    changes: tuple[Change, ...]
    moved: tuple[tuple[int, int, int], ...]


class ModelState(NamedTuple):
    """Stages as they were fitted, and what is known of the training scans.

    Attributes
    ----------
    segmenter, descriptor
    ensemble, filtration, response
        Fitted.
    stimuli : (n, c) csr_matrix of float64
        Of the training scans; the row of a skipped scan is empty.
    scan_names : list of str
    scan_labels : list of (str or None)
    skipped : dict of int to str
        Scans that could not be used, with the reason.
    novelty : Novelty or None
        None where the ensemble is one of one's own.
    n_identities : int
        How many identities were given to concepts so far.
    history : tuple of Update
        How the model came to know more scans.
    """

    segmenter: Segmenter
    descriptor: str | Descriptor
    ensemble: MotifHierarchyEnsemble
    filtration: Filtration
    response: ConceptResponse
    stimuli: csr_matrix
    scan_names: list[str]
    scan_labels: list[str | None]
    skipped: dict[int, str]
    novelty: Novelty | None
    n_identities: int = 0
    history: tuple[Update, ...] = ()
