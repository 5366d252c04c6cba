"""Recognition of new objects of which a part is hidden, or beside which something foreign is left."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.concepts.recognition import concept_shares
from shapeconcepts.descriptors import DescribedObject
from shapeconcepts.evaluation.experiments.concept_responses import fit
from shapeconcepts.evaluation.foreign_points import with_foreign_points
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, Progress, run
from shapeconcepts.evaluation.results import HiddenPartsResult, HiddenPartsRow
from shapeconcepts.evaluation.splits import Split
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.topology import jensen_shannon_divergences

N_NEAREST = 5
ROWS = (
    "concepts, found without labels",
    "motifs of training objects, by label",
    "whole-object histograms, five nearest",
    "whole-object histograms and their imagined occlusions, five nearest",
)


def hidden_parts(
    objects: LabelledObjects,
    preset: str,
    splits: Sequence[Split],
    n_jobs: int | None = None,
    progress: Progress | None = None,
) -> HiddenPartsResult | None:
    """Learn from the training part, recognise test objects: as they are, a part hidden, something foreign.

    A part is hidden as `imagine_occlusion` does it, of test objects whose occlusions nothing was learned
    from. What is foreign is a fifth of all points, see `with_foreign_points`, of an object of another label
    or of a table.

    Parameters
    ----------
    objects : LabelledObjects
    preset : str
    splits : sequence of (training, test)
        Indices, one pair a repetition.
    n_jobs : int or None
    progress : Progress, optional

    Returns
    -------
    HiddenPartsResult or None
        None where the preset imagines nothing, or no test object could be hidden in part.
    """
    described = objects.described[preset]
    if any(not any(described[i].occlusions for i in test) for _, test in splits):
        return None
    tested = np.unique(np.concatenate([test for _, test in splits])).tolist()
    descriptor = ShapeConceptModel.preset(preset).descriptor
    disturbed = run(
        with_foreign_points,
        [(objects.segmented[i], objects.segmented[_other(objects, i)], i, descriptor) for i in tested],
        n_jobs,
        progress,
        "Adding foreign points",
    )
    foreign = dict(zip(tested, disturbed, strict=True))
    tasks = [(described, objects.labels, split, preset, foreign) for split in splits]
    errors = np.array(run(_errors, tasks, n_jobs, progress, "Hidden parts"))
    return HiddenPartsResult(
        [
            HiddenPartsRow(name, *(errors[:, row, column].tolist() for column in range(3)))
            for row, name in enumerate(ROWS)
        ]
    )


def recognition_errors(
    known: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    preset: str,
    new: Sequence[tuple[Sequence[DescribedObject], NDArray[np.str_]]],
) -> NDArray[np.float64]:
    """Share of errors of each of `ROWS` on new objects.

    Parameters
    ----------
    known : sequence of DescribedObject
        With imagined occlusions.
    labels : (n,) str
    preset : str
    new : sequence of (objects, labels)
        Several sets of objects to recognise.

    Returns
    -------
    (4, k) float64
        A column for each set; NaN for an empty one.
    """
    model = fit(known, preset)
    of_concept = np.array([*(_majority(labels[concept.members]) for concept in model.concepts_), ""])
    names, numbers = np.unique(labels, return_inverse=True)
    whole = _histograms(known)
    rest = [
        (one.described, label)
        for all_of, label in zip(known, labels, strict=True)
        for one in all_of.occlusions
    ]
    both = np.concatenate([whole, _histograms([one for one, _ in rest])])
    labels_of_both = np.concatenate([labels, [label for _, label in rest]])
    columns = []
    for some, truth in new:
        if not some:
            columns.append([np.nan] * len(ROWS))
            continue
        rows = _histograms(some)
        told = (
            of_concept[model.predict(some)],
            names[concept_shares(model.ensemble_.reminders(some), numbers, len(names)).argmax(axis=1)],
            _nearest_labels(rows, whole, labels),
            _nearest_labels(rows, both, labels_of_both),
        )
        columns.append([(one != truth).mean() for one in told])
    return np.array(columns).T


def _errors(
    described: Sequence[DescribedObject],
    labels: NDArray[np.str_],
    split: Split,
    preset: str,
    foreign: dict[int, DescribedObject | None],
) -> NDArray[np.float64]:
    """Share of errors of each row, with nothing and a part hidden, and something foreign, (4, 3)."""
    training, test = split
    hidden = [(one.described, i) for i in test for one in described[i].occlusions]
    as_they_are = [described[i] for i in test], labels[test]
    in_part = [one for one, _ in hidden], labels[[i for _, i in hidden]]
    usable = [i for i in test if foreign[i]]
    disturbed = [one for i in usable if (one := foreign[i])], labels[usable]
    known = [described[i] for i in training]
    return recognition_errors(known, labels[training], preset, [as_they_are, in_part, disturbed])


def _other(objects: LabelledObjects, number: int) -> int:
    """An object of another label."""
    different = np.flatnonzero(objects.labels != objects.labels[number])
    return int(different[number % len(different)])


def _histograms(objects: Sequence[DescribedObject]) -> NDArray[np.float64]:
    return np.array([one.description.whole() for one in objects])


def _nearest_labels(
    rows: NDArray[np.float64], known: NDArray[np.float64], labels: NDArray[np.str_]
) -> NDArray[np.str_]:
    """Majority label of the nearest histograms; of equals, that of the nearest of them."""
    nearest = np.argsort(jensen_shannon_divergences(rows, known), axis=1, kind="stable")[:, :N_NEAREST]
    return np.array([_majority(row) for row in labels[nearest]])


def _majority(labels: NDArray[np.str_]) -> str:
    """The most frequent label; of equals, the one that comes first."""
    names, first, counts = np.unique(labels, return_index=True, return_counts=True)
    return str(names[np.lexsort((first, -counts))[0]])
