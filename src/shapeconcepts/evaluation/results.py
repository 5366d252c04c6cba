"""What the experiments give: plain values, from which tables, figures and JSON are made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from shapeconcepts.evaluation.metrics import GroupingScores

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FiltrationResult:
    """The filtration of the training objects.

    Attributes
    ----------
    diagram : (n, 2) float64
        Births and deaths of homology group 0; the last death is infinite.
    step_ends : (b,) float64
        End of each step of time.
    counts : (b,) int64
        Annexations in each step.
    epsilon_max : float or None
        The time of most annexations as the model reports it; None where there is no such time.
    concept_time : float or None
        Time at which the preset takes its concepts; None where it takes none.
    times : (k,) float64
        The times at which something changes, rising.
    n_concepts : (k,) int64
        Concepts of the preset's minimum size from each of these times on.
    """

    diagram: Floats
    step_ends: Floats
    counts: NDArray[np.int64]
    epsilon_max: float | None
    concept_time: float | None
    times: Floats
    n_concepts: NDArray[np.int64]


@dataclass(frozen=True)
class ConceptBar:
    """A concept in the ranked bar chart.

    Attributes
    ----------
    size : int
    purity : float
        Share of its most frequent label, in (0, 1] (paper: equation 4).
    rank_score : float
        Paper: equation 5, with epsilon 0.001.
    proportions : dict of str to float
        Share of each label in it, largest first.
    """

    size: int
    purity: float
    rank_score: float
    proportions: dict[str, float]


@dataclass(frozen=True, eq=False)
class SelectionResult:
    """Unsupervised concept selection with one preset.

    Attributes
    ----------
    preset : str
    scores : list of GroupingScores
        Of the training part of each repetition.
    errors : dict of str to list of float
        Share of each label's test objects that the SVM got wrong, in each repetition (table 1).
    bars : list of ConceptBar
        Concepts of the first repetition by rising rank score.
    filtration : FiltrationResult
        Of the first repetition.
    unplaced : int
        Training objects of the first repetition without any stimulus; they have no place in the space.
    """

    preset: str
    scores: list[GroupingScores]
    errors: dict[str, list[float]]
    bars: list[ConceptBar]
    filtration: FiltrationResult
    unplaced: int


@dataclass(frozen=True)
class LevelsResult:
    """Unsupervised concept selection by the number of dictionary levels.

    Attributes
    ----------
    levels : list of int
    scores : list of list of GroupingScores
        By level and repetition.
    errors : list of list of float
        Mean error over the labels, by level and repetition.
    """

    levels: list[int]
    scores: list[list[GroupingScores]]
    errors: list[list[float]]


@dataclass(frozen=True, eq=False)
class SupervisedResult:
    """Supervised concept selection: cross-validation over number and minimum size of concepts.

    Attributes
    ----------
    numbers : (a,) int64
    sizes : (b,) int64
    purity, error, coverage : (a, b) float64
        Means over the folds of all repetitions: mean purity of the concepts of the objects that a fold learns
        from, mean error over labels of the objects it leaves out, and share of the objects it learns from
        that are in concepts. NaN where the filtration of a fold never has that many concepts.
    chosen : (int, int)
        Number and minimum size that the rule chooses from the folds of all repetitions.
    chosen_purity, chosen_error, chosen_coverage : float
        What these surfaces hold there.
    purity_with_five : float or None
        Mean purity with five concepts of the smallest minimum size; None where there never are five.
    errors : dict of str to list of float
        Table 2: share of each label's test objects that the SVM got wrong, in each repetition.
    choices : list of (int, int)
        The choice of each repetition, from its training part alone.
    scores : list of GroupingScores
        Of the training part of each repetition, at its choice.
    """

    numbers: NDArray[np.int64]
    sizes: NDArray[np.int64]
    purity: Floats
    error: Floats
    coverage: Floats
    chosen: tuple[int, int]
    chosen_purity: float
    chosen_error: float
    chosen_coverage: float
    purity_with_five: float | None
    errors: dict[str, list[float]]
    choices: list[tuple[int, int]]
    scores: list[GroupingScores]


@dataclass(frozen=True, eq=False)
class MapResult:
    """The map of concept responses of several data sets.

    Attributes
    ----------
    positions : (n, 2) float64
        Place of each object.
    data_set, labels : (n,) str
    grid_x, grid_y : (g,) float64
        Centres of the cells.
    majority : (g, g) str
        Majority label among the k objects nearest to the centre of a cell, rows by y.
    share : (g, g) float64
        Share of that label among them, in (0, 1].
    k : int
    label_names : list of str
    region_of_labels : (r, c) float64
        Rows: regions, columns: labels. Distribution of the labels of the objects in a region; rows sum to 1,
        or to 0 where no object lies in the region.
    labels_to_regions : (c, r) float64
        Rows: labels, columns: regions. Distribution of a label's objects over the regions; rows sum to 1.
    nearest_region_right : dict of str to dict of str to float
        By data set and label: share of objects in a region of their own label.
    nearest_trained_right : dict of str to dict of str to float
        The same where only the objects that were trained on, none of the data set itself, decide on regions;
        only labels that were trained on.
    unplaced : dict of str to int
        By data set: objects without any stimulus, which are not on the map.
    """

    positions: Floats
    data_set: NDArray[np.str_]
    labels: NDArray[np.str_]
    grid_x: Floats
    grid_y: Floats
    majority: NDArray[np.str_]
    share: Floats
    k: int
    label_names: list[str]
    region_of_labels: Floats
    labels_to_regions: Floats
    nearest_region_right: dict[str, dict[str, float]]
    nearest_trained_right: dict[str, dict[str, float]]
    unplaced: dict[str, int]


@dataclass(frozen=True)
class BaselineRow:
    """A representation under a grouping, with the parameters chosen without labels in each repetition."""

    representation: str
    grouping: str
    parameters: list[dict[str, Any]]
    scores: list[GroupingScores]


@dataclass(frozen=True)
class ClassificationRow:
    """Errors of the SVM on a representation: share of each label's test objects, in each repetition."""

    representation: str
    errors: dict[str, list[float]]


@dataclass(frozen=True)
class HiddenPartsRow:
    """A way to recognise new objects: share of errors, in each repetition.

    Attributes
    ----------
    recognised_by : str
    nothing_hidden, part_hidden, foreign : list of float
        Of the test objects as they are, of what imagined occlusions leave of them, and with foreign points.
    """

    recognised_by: str
    nothing_hidden: list[float]
    part_hidden: list[float]
    foreign: list[float]


@dataclass(frozen=True)
class HiddenPartsResult:
    """Recognition of objects of which a third to two thirds are hidden, or of which a fifth is foreign."""

    rows: list[HiddenPartsRow]


@dataclass(frozen=True, eq=False)
class Evaluation:
    """All experiments on one data set.

    Attributes
    ----------
    data_name : str
    n_objects : int
    labels : dict of str to int
        Objects of each label.
    skipped : list of (str, str)
        Scans that could not be used, with the reason.
    repetitions : int
    selections : list of SelectionResult
        One for each preset, "default" first.
    levels : LevelsResult or None
        None where it was not asked for.
    supervised : SupervisedResult or None
    map : MapResult or None
    baselines : list of BaselineRow
    classifications : list of ClassificationRow
    seconds : dict of str to float
        Time of each experiment.
    versions : dict of str to str
        Of the libraries that the figures depend on.
    command : str
        What makes these figures again.
    hidden : HiddenPartsResult or None
        None where the first preset imagines nothing.
    """

    data_name: str
    n_objects: int
    labels: dict[str, int]
    skipped: list[tuple[str, str]]
    repetitions: int
    selections: list[SelectionResult]
    levels: LevelsResult | None
    supervised: SupervisedResult | None
    map: MapResult | None
    baselines: list[BaselineRow]
    classifications: list[ClassificationRow]
    seconds: dict[str, float]
    versions: dict[str, str]
    command: str
    hidden: HiddenPartsResult | None = None
