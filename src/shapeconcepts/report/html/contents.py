"""What a report shows, as plain lists that its page draws."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts import Filtration
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.report.html.class_counts import class_counts
from shapeconcepts.report.html.filtration_layout import lay_out_filtration
from shapeconcepts.report.html.history import history_contents
from shapeconcepts.report.html.ranking import RankedConcept, rank_concepts
from shapeconcepts.report.html.scan_preview import ScanPreview
from shapeconcepts.report.html.shown_scans import ShownScans, between_concepts, shown_scans
from shapeconcepts.report.html.time_scale import TimeScale, annexation_counts
from shapeconcepts.report.html.tree_layout import lay_out_tree
from shapeconcepts.report.palette import hexadecimal_segment_colours
from shapeconcepts.topology.annexation_kernels import annex
from shapeconcepts.topology.divergence import jensen_shannon_divergences
from shapeconcepts.version import __version__

# All previews of a page together, so that the file stays under 25 MB however many scans there are.
LARGEST_PREVIEWS = 15_000_000
_BYTES_PER_ELEMENT = 6


def report_contents(
    model: ShapeConceptModel,
    previews: Sequence[ScanPreview | None],
    unread: Sequence[tuple[str, str]],
    title: str,
    reading: Mapping[str, str],
) -> dict[str, Any]:
    """Everything that the page needs, ready for JSON.

    Parameters are those of `write_report`.
    """
    labels = sorted({label for label in model.scan_labels_ if label is not None})
    ranked = rank_concepts(model.concepts_, model.scan_labels_)
    shown = shown_scans(model)
    return {
        "title": title,
        "version": __version__,
        "reading": [[option, text] for option, text in reading.items()],
        "parameters": [[name, _shown(value)] for name, value in _parameters(model)],
        "segmentColours": hexadecimal_segment_colours(),
        "labels": labels,
        "scans": _scans(model, shown, previews, labels),
        "counts": _counts(model),
        "concepts": [_concept(model, one, shown, labels) for one in ranked],
        "filtration": _filtration(model.filtration_, shown),
        "groups": _groups(model, ranked, labels),
        "history": history_contents(model),
        "skipped": [[model.scan_names_[i] or f"scan {i}", why] for i, why in sorted(model.skipped_.items())],
        "unread": [[str(file), str(reason)] for file, reason in unread],
    }


def _scans(
    model: ShapeConceptModel, shown: ShownScans, previews: Sequence[ScanPreview | None], labels: list[str]
) -> dict[str, Any]:
    number = {label: i for i, label in enumerate(labels)}
    scans = shown.scans.tolist()
    own_previews = [previews[i] for i in scans]
    n_pictures = max(sum(one is not None for one in own_previews), 1)
    n_points = max(LARGEST_PREVIEWS // (_BYTES_PER_ELEMENT * n_pictures), 1)
    thinned = [one and one.thinned(n_points) for one in own_previews]
    own_labels = [model.scan_labels_[i] for i in scans]
    return {
        "names": [model.scan_names_[i] or f"scan {i}" for i in scans],
        "labels": [-1 if label is None else number[label] for label in own_labels],
        "vertices": shown.vertex_of_scan.tolist(),
        "skipped": np.flatnonzero(np.isin(shown.scans, list(model.skipped_))).tolist(),
        "previews": [one and base64.b64encode(one.to_bytes()).decode("ascii") for one in thinned],
        "extents": [one and round(one.extent, 4) for one in thinned],
        "spacings": [one and round(one.spacing, 5) for one in thinned],
        "sides": [one and [float(f"{side:.3g}") for side in one.sides] for one in thinned],
    }


def _counts(model: ShapeConceptModel) -> dict[str, int]:
    """Numbers of all scans, where the page may show fewer."""
    is_left = model.labels_ < 0
    is_left[list(model.skipped_)] = False
    is_placed = model.filtration_.space_.vertices_ >= 0
    return {
        "scans": len(model.labels_),
        "inConcepts": int((model.labels_ >= 0).sum()),
        "loners": int((is_left & is_placed).sum()),
        "mute": int((is_left & ~is_placed).sum()),
        "places": len(model.filtration_.space_.multiplicities_),
    }


def _concept(
    model: ShapeConceptModel, ranked: RankedConcept, shown: ShownScans, labels: list[str]
) -> dict[str, Any]:
    concept = ranked.concept
    members = np.intersect1d(concept.members, shown.scans, assume_unique=True)
    distances = jensen_shannon_divergences(model.stimuli_[members], model.stimuli_[[concept.medoid]])[:, 0]
    distances[members == concept.medoid] = -1
    from_the_medoid = members[np.argsort(distances, kind="stable")]
    return {
        "number": ranked.number,
        "name": concept.name,
        "size": concept.size,
        "members": np.searchsorted(shown.scans, from_the_medoid).tolist(),
        "birth": _rounded(concept.birth),
        "death": _rounded(concept.death) if np.isfinite(concept.death) else None,
        "score": round(ranked.score, 2),
        "purity": ranked.purity,
        "mix": [[labels.index(label), count] for label, count in ranked.label_counts],
    }


def _groups(
    model: ShapeConceptModel, ranked: Sequence[RankedConcept], labels: list[str]
) -> list[dict[str, Any]]:
    """The tree of concepts, children before parents; none where a time makes concepts."""
    tree = model.concept_tree_
    if tree is None:
        return []
    rank_of = {one.number: rank for rank, one in enumerate(ranked)}
    groups = []
    for group in range(len(tree.parents)):
        members = tree.members(group)
        numbers = set(model.labels_[members].tolist())
        number = numbers.pop() if len(numbers) == 1 else -1
        counts = Counter(label for label in (model.scan_labels_[i] for i in members) if label is not None)
        groups.append(
            {
                "parent": int(tree.parents[group]),
                "from": _rounded(max(1 - tree.deaths[group], 0.0)),
                "to": _rounded(1 - tree.births[group]),
                "size": len(members),
                "rank": rank_of.get(number, -1),
                "isConcept": number >= 0 and len(members) == model.concepts_[number].size,
                "label": labels.index(counts.most_common(1)[0][0]) if counts else -1,
            }
        )
    return groups


def _filtration(filtration: Filtration, shown: ShownScans) -> dict[str, Any]:
    n_vertices = len(shown.vertices)
    scale = TimeScale.of(filtration)
    step_ends, counts = annexation_counts(filtration, scale)
    is_between = between_concepts(filtration)
    edges, times = shown.edges[~shown.is_between], shown.times[~shown.is_between]
    dying, surviving, _, _ = annex(edges.astype(np.int32), shown.stands_for)
    annexations = np.stack([dying, surviving], axis=1)
    # Between concepts nothing enters on the page: what is left in the end are the concepts.
    concept_time = filtration.concept_time_
    if concept_time is not None and filtration.granularity_ is not None:
        concept_time = 1.0
    tree = shown.edges[np.lexsort(shown.edges.T[::-1])]
    joins = _first_joins(filtration, ~is_between, np.inf)[shown.vertices]
    return {
        "heatKind": filtration.heat,
        "stop": filtration.stop,
        "axisEnds": scale.ends,
        "tree": _rounded(lay_out_tree(tree, n_vertices)),
        "heat": _rounded(_vertex_heat(filtration, scale)[shown.vertices]),
        "joins": [time if np.isfinite(time) else None for time in joins.tolist()],
        "equal": filtration.space_.multiplicities_[shown.vertices].tolist(),
        "standsFor": shown.stands_for.tolist(),
        "edges": edges.tolist(),
        "times": times.tolist(),
        "annexations": annexations.tolist(),
        "edgesBetween": shown.edges[shown.is_between].tolist(),
        "timesBetween": shown.times[shown.is_between].tolist(),
        "nBetween": int(is_between.sum()),
        "graph": _rounded(lay_out_filtration(annexations, scale.radii(times), n_vertices)),
        "stepEnds": step_ends,
        "stepCounts": counts,
        "classCounts": class_counts(filtration, is_between, scale),
        "conceptTime": concept_time,
        "granularity": filtration.granularity_,
        "minSize": int(filtration.min_concept_size),
    }


def _first_joins(filtration: Filtration, enters: NDArray[np.bool_], without: float) -> NDArray[np.float64]:
    """When each vertex has its first neighbour, (v,) float64, along the edges that enter, (e,) bool."""
    first_joins = np.full(len(filtration.space_.multiplicities_), without)
    for ends in filtration.edges_[enters].T:
        np.minimum.at(first_joins, ends, filtration.times_[enters])
    return first_joins


def _vertex_heat(filtration: Filtration, scale: TimeScale) -> NDArray[np.float64]:
    """Heat of each vertex, 0 to 1: of divergences, how late on the axis its first neighbour joins."""
    if filtration.heat == "geodesic":
        return filtration.space_.vertex_heat_
    positions = scale.positions(_first_joins(filtration, np.ones(len(filtration.edges_), bool), 1.0))
    return (
        (positions - positions.min(initial=1)) / max(np.ptp(positions), 1e-9) if len(positions) else positions
    )


def _parameters(model: ShapeConceptModel) -> list[tuple[str, object]]:
    """All but how many jobs there were, which changes no result."""
    return [(name, value) for name, value in model.get_params(deep=False).items() if name != "n_jobs"]


def _shown(value: object) -> str:
    return value if isinstance(value, str) else repr(value)


def _rounded(values: NDArray[np.float64] | float) -> Any:
    return np.round(values, 4).tolist()
