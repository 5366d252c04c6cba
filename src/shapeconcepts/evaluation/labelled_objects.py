"""Labelled objects, segmented once and described once for each preset."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject, describe
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.parallel import map_in_order
from shapeconcepts.segmentation import SegmentedObject

Result = TypeVar("Result")

# Three quarters for training must leave two for the folds of the cross-validation, and one for the test.
FEWEST_PER_LABEL = 4


class Progress(Protocol):
    """Passes items on, and may show how many of them there have been."""

    def __call__(self, items: Iterable[Any], total: int, description: str) -> Iterable[Any]: ...


@dataclass(frozen=True, eq=False)
class LabelledObjects:
    """A data set.

    Attributes
    ----------
    name : str
    segmented : list of SegmentedObject
    labels : (n,) str
    described : dict of str to list of DescribedObject
        By preset.
    instances : (n,) str or None
        Which physical object each scan shows, where the data set tells.
    """

    name: str
    segmented: list[SegmentedObject]
    labels: NDArray[np.str_]
    described: dict[str, list[DescribedObject]]
    instances: NDArray[np.str_] | None = None


def labelled_objects(
    segmented: Sequence[SegmentedObject],
    name: str,
    presets: Sequence[str],
    n_jobs: int | None = None,
    progress: Progress | None = None,
    instances: Sequence[str | None] | None = None,
) -> LabelledObjects:
    """Describe a data set as each preset does.

    Parameters
    ----------
    segmented : sequence of SegmentedObject
    name : str
        Of the data set.
    presets : sequence of str
    n_jobs : int or None
    progress : Progress, optional
    instances : sequence of (str or None), optional
        Which physical object each scan shows. Where that is not known of all of them, it is as if of none.

    Raises
    ------
    ValueError
        If an object has no label.
    """
    labels = [one.label for one in segmented]
    missing = [one.name or f"number {i}" for i, one in enumerate(segmented) if not one.label]
    if missing:
        raise ValueError(
            f"{name}: every object needs a label to be evaluated, but {len(missing)} of {len(labels)} have "
            f"none, such as {missing[0]}"
        )
    described: dict[str, list[DescribedObject]] = {}
    for preset in presets:
        model = ShapeConceptModel.preset(preset)
        n_occlusions = model.get_params()["ensemble__n_occlusions"]
        tasks = [(one, model.descriptor, n_occlusions) for one in segmented]
        described[preset] = run(describe, tasks, n_jobs, progress, f"Describing {name}")
    known_instances = None
    if instances is not None and all(instances):
        # The same number may name another object under another label.
        pairs = zip(labels, instances, strict=True)
        known_instances = np.array([f"{label}/{instance}" for label, instance in pairs])
    return LabelledObjects(name, list(segmented), np.array(labels, dtype=np.str_), described, known_instances)


def check_labels(objects: LabelledObjects) -> None:
    """Complain where there are too few objects for the experiments.

    Raises
    ------
    ValueError
        If there are not two labels, or one has fewer than four objects.
    """
    counts = Counter(objects.labels.tolist())
    if len(counts) < 2:
        found = f"only {next(iter(counts))!r}" if counts else "none"
        raise ValueError(f"{objects.name}: at least two labels are needed to be told apart, got {found}")
    few = [f"{label!r} has {n}" for label, n in sorted(counts.items()) if n < FEWEST_PER_LABEL]
    if few:
        raise ValueError(
            f"{objects.name}: each label needs at least {FEWEST_PER_LABEL} scans that can be used, "
            f"but {', '.join(few)}"
        )


def run(
    work: Callable[..., Result],
    tasks: Sequence[tuple[Any, ...]],
    n_jobs: int | None,
    progress: Progress | None,
    description: str,
) -> list[Result]:
    """Results of work on tasks, in their order."""
    results = map_in_order(partial(_work_on, work), tasks, n_jobs, own_process=True)
    return list(results if progress is None else progress(results, len(tasks), description))


def _work_on(work: Callable[..., Result], task: tuple[Any, ...]) -> Result:
    return work(*task)
