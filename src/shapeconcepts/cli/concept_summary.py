"""What the commands say about the concepts of a model."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from shapeconcepts.cli.terminal import print_table

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel

UNKNOWN = "unknown"
_LABELS_SHOWN = 4
_CUTS_SHOWN = 3


def concept_summaries(model: ShapeConceptModel) -> list[dict[str, Any]]:
    """What JSON says of the concepts: plain values, in the order of their numbers."""
    summaries = []
    for number, concept in enumerate(model.concepts_):
        labels = Counter(
            label for label in (model.scan_labels_[i] for i in concept.members) if label is not None
        )
        summaries.append(
            {
                "number": number,
                "name": concept.name,
                "size": concept.size,
                "birth": concept.birth,
                "death": concept.death if concept.death <= 1 else None,
                "lifetime": concept.lifetime,
                "medoid": model.scan_names_[concept.medoid],
                "labels": dict(labels.most_common()),
                "n_unlabelled": concept.size - labels.total(),
                "members": [model.scan_names_[i] for i in concept.members],
            }
        )
    return summaries


def model_summary(model: ShapeConceptModel) -> dict[str, Any]:
    """What JSON says of a model."""
    return {
        "n_scans": len(model.scan_names_),
        "n_motifs": model.stimuli_.shape[1],
        "granularity": model.filtration_.granularity_,
        "concept_time": model.filtration_.concept_time_,
        "epsilon_max": model.filtration_.epsilon_max_,
        "parameters": _parameters(model),
        "concepts": concept_summaries(model),
        "in_no_concept": [
            name for name, label in zip(model.scan_names_, model.labels_, strict=True) if label < 0
        ],
    }


def _parameters(model: ShapeConceptModel) -> dict[str, str | float | None]:
    """Parameters of the stages that were fitted, called as the model's own `set_params` calls them."""
    descriptor = model.descriptor_
    found: dict[str, str | float | None] = {
        "descriptor": descriptor if isinstance(descriptor, str) else repr(descriptor)
    }
    for stage in ("segmenter", "ensemble", "filtration", "response"):
        for name, value in getattr(model, f"{stage}_").get_params().items():
            if not hasattr(value, "get_params") and name not in ("n_jobs", "dictionary"):
                found[f"{stage}__{name}"] = value
    return found


def print_concepts(model: ShapeConceptModel) -> None:
    """The concepts of a model as a table."""
    summaries = concept_summaries(model)
    if not summaries:
        return
    named = any(summary["name"] for summary in summaries)
    labelled = any(summary["labels"] for summary in summaries)
    titles = ["concept", *["name"] * named, "scans", *["labels"] * labelled, "typical scan"]
    rows = []
    for summary in summaries:
        rows.append(
            [
                str(summary["number"]),
                *[summary["name"]] * named,
                str(summary["size"]),
                *[_shares(summary["labels"], summary["size"])] * labelled,
                summary["medoid"],
            ]
        )
    print_table(titles, rows, folding="typical scan")


def in_words(model: ShapeConceptModel) -> str:
    """What was learned, as a sentence."""
    n_scans, n_concepts = len(model.scan_names_), len(model.concepts_)
    n_in = int((model.labels_ >= 0).sum())
    if n_concepts == 0:
        return f"{n_scans} scans, no concept"
    concepts = "1 concept" if n_concepts == 1 else f"{n_concepts} concepts"
    return f"{concepts} with {n_in} of {n_scans} scans ({n_in / n_scans:.0%})"


def other_cuts_in_words(model: ShapeConceptModel) -> str:
    """Numbers of concepts at coarser and finer granularities, as a sentence; empty where there are none."""
    granularity, tree = model.filtration_.granularity_, model.concept_tree_
    if granularity is None or tree is None:
        return ""
    # Just beyond each place where the cut changes.
    changes = [round(1.01 * change, 3) for change in tree.granularities.tolist()]
    of_number = {len(tree.cut(g)): g for g in reversed(changes) if g <= 1}
    cuts = sorted(of_number.items())
    coarser = [f"{n} at {g:g}" for n, g in cuts if 1 < n < len(model.concepts_)]
    finer = [f"{n} at {g:g}" for n, g in cuts if n > len(model.concepts_)]
    shown = coarser[-_CUTS_SHOWN:] + finer[:_CUTS_SHOWN]
    return f"Granularity {granularity:.3f}" + (f"; other cuts: {', '.join(shown)}" if shown else "")


def concept_title(model: ShapeConceptModel, number: int) -> str:
    """Name of a concept where it has one, else its number; "unknown" for -1."""
    if number < 0:
        return UNKNOWN
    return model.concepts_[number].name or str(number)


def _shares(counts: dict[str, int], size: int) -> str:
    shares = [f"{label} {count / size:.0%}" for label, count in counts.items()]
    shown = ", ".join(shares[:_LABELS_SHOWN]) + (" ..." if len(shares) > _LABELS_SHOWN else "")
    n_unlabelled = size - sum(counts.values())
    return f"{shown}, unlabelled {n_unlabelled / size:.0%}".removeprefix(", ") if n_unlabelled else shown
