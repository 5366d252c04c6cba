"""How concepts came to be what they are: their sizes after each update of the model."""

from __future__ import annotations

from typing import Any

from shapeconcepts.model import ShapeConceptModel

# More columns are not read by anybody; the last ones tell most.
MOST_UPDATES = 12


def history_contents(model: ShapeConceptModel) -> dict[str, Any]:
    """Scans after each update, and of each identity its sizes and what happened to it, the newest last.

    The first column is what there was before the first update that is shown. An identity that has ended is
    shown as long as it was there.
    """
    updates = model.history_[-MOST_UPDATES:]
    if not updates:
        return {"scans": [], "concepts": []}
    present = {concept.key: concept.size for concept in model.concepts_}
    told = [{change.key: change for change in update.changes} for update in updates]
    keys = sorted({*present, *(key for changes in told for key in changes)})
    names = {concept.key: concept.name for concept in model.concepts_}
    concepts = []
    for key in keys:
        sizes = [present.get(key, 0)]
        for changes in reversed(told):
            sizes.append(changes[key].n_before if key in changes else sizes[-1])
        events = [
            {"kind": changes[key].kind, "others": list(changes[key].others)} if key in changes else None
            for changes in told
        ]
        concepts.append(
            {"key": key, "name": names.get(key, ""), "sizes": sizes[::-1], "events": [None, *events]}
        )
    return {"scans": [updates[0].n_before, *(update.n_after for update in updates)], "concepts": concepts}
