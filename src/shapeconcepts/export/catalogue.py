"""What a model knows of the scans that it was learned from: a row each, the most typical ones first."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.topology import jensen_shannon_divergences

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel

# What scans in no concept are called.
NONE = "none"
_AT_ONCE = 256


class CatalogueEntry(NamedTuple):
    """A scan that a model was learned from.

    Attributes
    ----------
    row : int
        In the model.
    name : str
        As in the model.
    label : str or None
        That it came with, such as the name of its folder.
    concept : int
        Number, -1 for none.
    response : float or None
        Of its own concept: the mean distance to the members; smaller is more alike. None in no concept.
    p_value : float or None
        Probability that a scan of something known would be as unlike all others, or more. None with an
        ensemble of one's own.
    rank : int or None
        Among the members of its concept by the Jensen-Shannon divergence of stimuli from those of the medoid,
        which is 0. None in no concept.
    """

    row: int
    name: str
    label: str | None
    concept: int
    response: float | None
    p_value: float | None
    rank: int | None

    @property
    def is_medoid(self) -> bool:
        """Whether it is the most typical scan of its concept."""
        return self.rank == 0


class ConceptClass(NamedTuple):
    """A concept as a class of a data set.

    Attributes
    ----------
    number : int
        -1 for none.
    key : int
        Its identity in the model, which lives through updates; -1 for none.
    name : str
        What the user calls it; empty where it has no name.
    title : str
        What the data set calls it, unlike any other.
    size : int
        Number of scans in the model.
    """

    number: int
    key: int
    name: str
    title: str
    size: int

    @property
    def identifier(self) -> int:
        """Number of the class in formats that have 0 for none; an update of the model does not change it."""
        return self.key + 1


@dataclass(frozen=True)
class Catalogue:
    """All scans of a model.

    Attributes
    ----------
    entries : tuple of CatalogueEntry
        Concept by concept, medoids first; those in no concept last.
    classes : tuple of ConceptClass
        In the order of their numbers; none last.
    skipped : tuple of (str, str)
        Names of scans that the model could not be learned from, with the reason.
    """

    entries: tuple[CatalogueEntry, ...]
    classes: tuple[ConceptClass, ...]
    skipped: tuple[tuple[str, str], ...]

    def class_of(self, entry: CatalogueEntry) -> ConceptClass:
        """The class of a scan."""
        return self.classes[entry.concept]


def catalogue_of(model: ShapeConceptModel) -> Catalogue:
    """What a fitted model knows of its scans."""
    model.consolidate()
    labels, p_values = model.labels_, model.training_p_values()
    responses, ranks = _own_responses(model), _ranks(model)
    entries = [
        CatalogueEntry(
            row=index,
            name=name or f"scan {index}",
            label=model.scan_labels_[index],
            concept=int(labels[index]),
            response=_number(responses[index]),
            p_value=None if p_values is None else _number(p_values[index]),
            rank=int(ranks[index]) if labels[index] >= 0 else None,
        )
        for index, name in enumerate(model.scan_names_)
        if index not in model.skipped_
    ]
    last = len(model.concepts_)
    entries.sort(key=lambda one: (one.concept if one.concept >= 0 else last, one.rank or 0, one.row))
    skipped = [(model.scan_names_[index], reason) for index, reason in sorted(model.skipped_.items())]
    return Catalogue(tuple(entries), _classes(model), tuple(skipped))


def _classes(model: ShapeConceptModel) -> tuple[ConceptClass, ...]:
    titles = [concept.name or f"concept{number}" for number, concept in enumerate(model.concepts_)]
    # A number that is added may make a title equal to another one.
    while len({NONE, *titles}) <= len(titles):
        counts = Counter([NONE, *titles])
        titles = [title if counts[title] == 1 else f"{title} ({i})" for i, title in enumerate(titles)]
    classes = [
        ConceptClass(number, concept.key, concept.name, title, concept.size)
        for number, (concept, title) in enumerate(zip(model.concepts_, titles, strict=True))
    ]
    n_in_none = int((model.labels_ < 0).sum()) - len(model.skipped_)
    return (*classes, ConceptClass(-1, -1, "", NONE, n_in_none))


def _own_responses(model: ShapeConceptModel) -> NDArray[np.float64]:
    """Response of each scan's own concept, (n,), NaN in none."""
    own = np.full(len(model.labels_), np.nan)
    members = np.flatnonzero(model.labels_ >= 0)
    stimuli = model.stimuli_
    for start in range(0, len(members), _AT_ONCE):
        rows = members[start : start + _AT_ONCE]
        responses = model.response_.transform(stimuli[rows])
        own[rows] = responses[np.arange(len(rows)), model.labels_[rows]]
    return own


def _ranks(model: ShapeConceptModel) -> NDArray[np.int64]:
    """Place of each member of a concept by its divergence from the medoid, (n,), -1 in none."""
    ranks = np.full(len(model.labels_), -1)
    stimuli = model.stimuli_
    for concept in model.concepts_:
        members = concept.members
        divergences = jensen_shannon_divergences(stimuli[members], stimuli[[concept.medoid]])[:, 0]
        # Others may be at the same place.
        divergences[members == concept.medoid] = -1.0
        ranks[members[np.argsort(divergences, kind="stable")]] = np.arange(len(members))
    return ranks


def _number(value: float) -> float | None:
    return None if np.isnan(value) else float(value)
