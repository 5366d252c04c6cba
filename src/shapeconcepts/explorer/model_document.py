"""What the page knows of a model until its file changes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from shapeconcepts.report.palette import hexadecimal_segment_colours
from shapeconcepts.version import __version__

if TYPE_CHECKING:
    from shapeconcepts.concepts import ConceptTree
    from shapeconcepts.sources.reader import ReadOptions

_LAYOUTS = (
    ("folders", "a folder for each concept, with the files of its scans"),
    ("csv", "a table with a row for each scan"),
    ("parquet", "the same table, for pandas and others"),
    ("semantic-kitti", "what SemanticKITTI's tools read"),
    ("labelcloud", "what labelCloud reads"),
    ("fiftyone", "what FiftyOne reads"),
)


def model_document(
    names: Sequence[str],
    labels: Sequence[str | None],
    skipped: Iterable[int],
    tree: ConceptTree | None,
    title: str,
    has_scans: bool,
    reading: ReadOptions,
) -> dict[str, Any]:
    """Scans, with those that were skipped, and the tree of concepts, ready for JSON."""
    label_names = sorted({label for label in labels if label is not None})
    number = {label: i for i, label in enumerate(label_names)}
    return {
        "version": __version__,
        "title": title,
        "scans": {
            "names": [name or f"scan {row}" for row, name in enumerate(names)],
            "labels": [-1 if label is None else number[label] for label in labels],
            "skipped": sorted(skipped),
        },
        "labelNames": label_names,
        "hasScans": has_scans,
        "reading": {option: str(value) for option, value in reading.items() if value not in (None, "auto")},
        "tree": [] if tree is None else _groups(tree),
        "treeGroupOfScan": [] if tree is None else tree.group_of_object.tolist(),
        "granularities": [] if tree is None else np.round(tree.granularities, 6).tolist(),
        "layouts": _LAYOUTS,
        "segmentColours": hexadecimal_segment_colours(),
    }


def _groups(tree: ConceptTree) -> list[dict[str, Any]]:
    """Groups, children before parents, and from which granularity to which each of them is one."""
    in_group = tree.group_of_object[tree.group_of_object >= 0]
    sizes = np.bincount(in_group, minlength=len(tree.parents))
    for group, parent in enumerate(tree.parents.tolist()):
        if parent >= 0:
            sizes[parent] += sizes[group]
    # The smallest groups are whole at any finer granularity.
    ends = np.where(np.isnan(tree.p_values), 1.0, 1.0 - tree.births)
    starts = np.maximum(1.0 - tree.deaths, 0.0)
    return [
        {"parent": parent, "from": round(start, 6), "to": round(end, 6), "size": size}
        for parent, start, end, size in zip(
            tree.parents.tolist(), starts.tolist(), ends.tolist(), sizes.tolist(), strict=True
        )
    ]
