"""Why an object has its stimuli: the motifs that fired, and what they remind of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.decomposition import segments_in
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.motifs.propagation import Propagation
from shapeconcepts.motifs.prototype_stimuli import PrototypeField
from shapeconcepts.motifs.stimuli import SMALLEST_STIMULUS, MotifField
from shapeconcepts.motifs.stimulus_kernels import divergences_to, negative_entropies

N_CLOSEST = 5


@dataclass(frozen=True)
class SimilarPrototype:
    """A training constellation that a constellation of the explained object resembles.

    Attributes
    ----------
    object_index : int
        Training object, counted in the order in which they were seen.
    object_name : str
    segments : tuple of int
        The training object's segments behind the prototype.
    divergence : float
        Jensen-Shannon divergence in bits, 0 (same) to 1 (nothing in common).
    count : int
        Number of training constellations that the prototype stands for, itself included.
    others : tuple of str
        Names of some of the other training objects that these are of.
    """

    object_index: int
    object_name: str
    segments: tuple[int, ...]
    divergence: float
    count: int = 1
    others: tuple[str, ...] = ()


@dataclass(frozen=True)
class FiredMotif:
    """A motif vertex that fired.

    Attributes
    ----------
    column : int
        Column of the stimuli; of single prototypes, that of the one stimulated most.
    vertex : int
        Number of the motif vertex; -1 for none.
    name : str
        Name of the vertex: "d3 m2 w1 w4" is words 1 and 4 of dictionary level 3, seen at motif level 2.
    dictionary_level, motif_level : int
        From 1; dictionary level 0 is that without words.
    words : tuple of int
        Words of the motif, rising.
    stimulus : float
    segments : tuple of int
        The object's own segments behind it.
    n_prototypes : int
        Number of prototypes that the stimulus is the mean over, or that are stimulated.
    closest : tuple of SimilarPrototype
        The prototypes of smallest divergence, at most 5, each training object once. Where columns are single
        prototypes, those of largest stimulus.
    """

    column: int
    vertex: int
    name: str
    dictionary_level: int
    motif_level: int
    words: tuple[int, ...]
    stimulus: float
    segments: tuple[int, ...]
    n_prototypes: int
    closest: tuple[SimilarPrototype, ...]


@dataclass(frozen=True)
class Explanation:
    """The motifs that an object fired, strongest first, and those that it could not.

    Attributes
    ----------
    motifs : tuple of FiredMotif
        In falling order of the stimulus; of equal ones the one of more segments first. Where columns are
        single prototypes, one for each constellation, with the largest stimulus of any of them.
    n_constellations : int
        Number of the object's constellations.
    n_unknown : tuple of int
        For each dictionary level, the number of constellations whose motif is no column: never seen, or in
        too few objects.
    columns : {"motifs", "prototypes"}
        What the stimuli are of.
    foreign : tuple of int
        Segments that hardly remind of the concept that the object is recognised as, if a model explains it:
        of something else, that touches or carries it.
    """

    motifs: tuple[FiredMotif, ...]
    n_constellations: int
    n_unknown: tuple[int, ...]
    columns: str = "motifs"
    foreign: tuple[int, ...] = ()


def explain(propagation: Propagation, field: PrototypeField | MotifField) -> Explanation:
    """Explain the stimuli of a propagated object."""
    by = _explain_by_prototypes if isinstance(field, PrototypeField) else _explain_by_motifs
    return by(propagation, field)  # type: ignore[arg-type]


def _explain_by_motifs(propagation: Propagation, field: MotifField) -> Explanation:
    hierarchies = field.hierarchies
    fired_columns, stimuli = field.stimuli(
        (propagation.histograms, hierarchies.activated(propagation.words), -1)
    )
    strongest: dict[int, tuple[float, int]] = {}
    for (constellation, level), stimulus in np.ndenumerate(stimuli):
        column = int(fired_columns[constellation, level])
        if stimulus >= SMALLEST_STIMULUS and stimulus > strongest.get(column, (0.0, -1))[0]:
            strongest[column] = (float(stimulus), constellation)
    motifs = [
        _fired_motif(column, int(field.columns[column]), *fired, propagation, hierarchies)
        for column, fired in strongest.items()
    ]
    motifs.sort(key=lambda motif: (-motif.stimulus, -len(motif.words), motif.column))
    return Explanation(
        motifs=tuple(motifs),
        n_constellations=len(propagation.constellations),
        n_unknown=tuple((fired_columns < 0).sum(axis=0).tolist()),
    )


def _explain_by_prototypes(propagation: Propagation, field: PrototypeField) -> Explanation:
    """One entry for each constellation that stimulates any prototype.

    The motif of an entry is the one of the finest dictionary level that the constellation shares with the
    prototype that it stimulates most; without any, it has level 0 and no words.
    """
    hierarchies = field.hierarchies
    activated = hierarchies.activated(propagation.words)
    motifs = []
    for constellation, histogram in enumerate(propagation.histograms):
        stimuli = field.stimuli(histogram, activated[constellation])
        stimulated = np.flatnonzero(stimuli)
        if len(stimulated) == 0:
            continue
        columns = stimulated[np.argsort(-stimuli[stimulated], kind="stable")]
        behind = field.columns[columns]
        strongest = int(behind[0])
        shared = np.flatnonzero(activated[constellation] == hierarchies.prototype_vertices[strongest])
        vertex = int(activated[constellation, shared[-1]]) if len(shared) else -1
        motifs.append(
            FiredMotif(
                column=int(columns[0]),
                vertex=vertex,
                name=hierarchies.name(vertex) if vertex >= 0 else "d0",
                dictionary_level=int(hierarchies.dictionary_levels[vertex]) if vertex >= 0 else 0,
                motif_level=int(propagation.motif_levels[constellation]),
                words=hierarchies.motif(vertex) if vertex >= 0 else (),
                stimulus=float(stimuli[columns[0]]),
                segments=segments_in(int(propagation.constellations[constellation])),
                n_prototypes=len(behind),
                closest=_similar_prototypes(histogram, behind, hierarchies),
            )
        )
    motifs.sort(key=lambda motif: (-motif.stimulus, -len(motif.segments), motif.column))
    return Explanation(
        motifs=tuple(motifs),
        n_constellations=len(propagation.constellations),
        n_unknown=tuple((activated < 0).sum(axis=0).tolist()),
        columns="prototypes",
    )


def _fired_motif(
    column: int,
    vertex: int,
    stimulus: float,
    constellation: int,
    propagation: Propagation,
    hierarchies: MotifHierarchies,
) -> FiredMotif:
    starts, prototypes = hierarchies.prototypes_of
    behind = prototypes[starts[vertex] : starts[vertex + 1]]
    histogram = propagation.histograms[constellation]
    nearest_first = np.argsort(_divergences(histogram, behind, hierarchies), kind="stable")
    return FiredMotif(
        column=column,
        vertex=vertex,
        name=hierarchies.name(vertex),
        dictionary_level=int(hierarchies.dictionary_levels[vertex]),
        motif_level=int(hierarchies.motif_levels[vertex]),
        words=hierarchies.motif(vertex),
        stimulus=stimulus,
        segments=segments_in(int(propagation.constellations[constellation])),
        n_prototypes=len(behind),
        closest=_similar_prototypes(histogram, behind[nearest_first], hierarchies),
    )


def _similar_prototypes(
    histogram: NDArray[np.float32], ranked: NDArray[np.integer], hierarchies: MotifHierarchies
) -> tuple[SimilarPrototype, ...]:
    """The first of ranked prototypes, each training object once."""
    objects, first = np.unique(hierarchies.prototype_objects[ranked], return_index=True)
    best = np.argsort(first)[:N_CLOSEST]
    chosen = ranked[first[best]]
    divergences = _divergences(histogram, chosen, hierarchies)
    return tuple(
        SimilarPrototype(
            index,
            hierarchies.object_names[index],
            segments_in(int(hierarchies.prototype_constellations[prototype])),
            divergence,
            int(hierarchies.prototype_counts[prototype]),
            tuple(hierarchies.object_names[i] for i in hierarchies.prototype_others[prototype] if i >= 0),
        )
        for index, prototype, divergence in zip(
            objects[best].tolist(), chosen.tolist(), divergences.tolist(), strict=True
        )
    )


def _divergences(
    histogram: NDArray[np.float32], which: NDArray[np.integer], hierarchies: MotifHierarchies
) -> NDArray[np.float64]:
    return divergences_to(
        histogram,
        negative_entropies(histogram[None])[0],
        which.astype(np.int32),
        hierarchies.prototypes,
        hierarchies.prototype_entropies,
    )
