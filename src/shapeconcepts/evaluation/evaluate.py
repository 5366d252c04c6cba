"""All experiments of the paper, and the baselines, on one data set."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from time import perf_counter

from shapeconcepts.evaluation.experiments.baseline_comparison import baseline_comparison
from shapeconcepts.evaluation.experiments.generalisation import generalisation
from shapeconcepts.evaluation.experiments.hidden_parts import hidden_parts
from shapeconcepts.evaluation.experiments.levels import number_of_levels
from shapeconcepts.evaluation.experiments.supervised import supervised_selection
from shapeconcepts.evaluation.experiments.unsupervised import unsupervised_selection
from shapeconcepts.evaluation.labelled_objects import Progress, check_labels, labelled_objects
from shapeconcepts.evaluation.libraries import GROUPING_LIBRARIES, check_libraries
from shapeconcepts.evaluation.results import Evaluation
from shapeconcepts.evaluation.splits import stratified_splits
from shapeconcepts.model import PRESETS
from shapeconcepts.parameters import check_integer
from shapeconcepts.segmentation import SegmentedObject
from shapeconcepts.version import __version__

TEST_SHARE = 0.25
_LIBRARIES = ("numpy", "scipy", "scikit-learn", "numba")


def evaluate(
    segmented: Sequence[SegmentedObject],
    *,
    name: str = "objects",
    instances: Sequence[str | None] | None = None,
    also: Mapping[str, Sequence[SegmentedObject]] | None = None,
    presets: Sequence[str] = PRESETS,
    repetitions: int = 5,
    random_state: int = 0,
    skipped: Sequence[tuple[str, str]] = (),
    command: str = "",
    n_jobs: int | None = None,
    progress: Progress | None = None,
) -> Evaluation:
    """Run the paper's experiments (section Experimental Evaluation), and baselines on the same splits.

    Everything is learned from 75 % of the objects of each label, in several repetitions, and scored on the
    rest. The same objects give the same figures, with any `n_jobs`.

    Parameters
    ----------
    segmented : sequence of SegmentedObject
        With labels. `ShapeConceptModel().segment` makes them of scans.
    name : str
        Of the data set.
    instances : sequence of (str or None), optional
        Which physical object each scan shows. Where all are known, scans of one are never on both sides of a
        split.
    also : dict of str to sequence of SegmentedObject, optional
        Other data sets, for the generalisation: nothing is learned from them.
    presets : sequence of str
        Of `ShapeConceptModel`. The first one goes through all experiments, the others through the
        unsupervised selection.
    repetitions : int
    random_state : int
        Seed of splits, folds, t-SNE and baselines.
    skipped : sequence of (str, str)
        Scans that could not be segmented, with the reason, to be reported.
    command : str
        What makes these figures again, to be reported.
    n_jobs : int or None
        As in joblib.
    progress : Progress, optional
        Called for each longer step as ``progress(items, total, description)``; it passes the items on.

    Returns
    -------
    Evaluation

    Raises
    ------
    ValueError
        If an object has no label, a label has fewer than four objects, there are not two labels, or a
        parameter is out of range.
    ModuleNotFoundError
        If a library of ``pip install 'shapeconcepts[evaluation]'`` is not installed.
    """
    check_libraries(*GROUPING_LIBRARIES)
    check_integer("repetitions", repetitions, 1)
    seconds: dict[str, float] = {}

    @contextmanager
    def timed(step: str) -> Iterator[None]:
        start = perf_counter()
        yield
        seconds[step] = perf_counter() - start

    with timed("description"):
        objects = labelled_objects(segmented, name, presets, n_jobs, progress, instances)
        check_labels(objects)
        others = [
            labelled_objects(scans, other, presets[:1], n_jobs, progress)
            for other, scans in (also or {}).items()
        ]
    splits = stratified_splits(
        objects.labels, repetitions, TEST_SHARE, random_state, instances=objects.instances
    )
    with timed("unsupervised selection"):
        selected = [unsupervised_selection(objects, preset, splits, n_jobs, progress) for preset in presets]
    with timed("number of levels"):
        levels = number_of_levels(objects, presets[0], splits, n_jobs, progress)
    with timed("supervised selection"):
        supervised = supervised_selection(
            objects, presets[0], splits, n_jobs, progress, random_state=random_state
        )
    with timed("generalisation"):
        concept_map = generalisation(objects, others, presets[0], splits[0], random_state)
    with timed("hidden parts"):
        hidden = hidden_parts(objects, presets[0], splits, n_jobs, progress)
    with timed("baselines"):
        baselines, classifications = baseline_comparison(
            objects, presets[0], splits, n_jobs, progress, random_state
        )
    return Evaluation(
        data_name=name,
        n_objects=len(objects.labels),
        labels=dict(sorted(Counter(objects.labels.tolist()).items())),
        skipped=list(skipped),
        repetitions=repetitions,
        selections=[selection for selection, _ in selected],
        levels=levels,
        supervised=supervised,
        map=concept_map,
        baselines=baselines,
        classifications=[*(row for _, row in selected), *classifications],
        seconds=seconds,
        versions=_versions(),
        command=command,
        hidden=hidden,
    )


def _versions() -> dict[str, str]:
    libraries = {library: version(library) for library in _LIBRARIES}
    return {"shapeconcepts": __version__, "python": platform.python_version(), **libraries}
