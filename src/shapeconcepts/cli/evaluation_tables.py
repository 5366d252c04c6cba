"""The evaluation as tables in a terminal: scores are medians over the repetitions, errors are means."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from shapeconcepts.cli.terminal import print_table, tell

if TYPE_CHECKING:
    from shapeconcepts.evaluation.metrics import GroupingScores
    from shapeconcepts.evaluation.results import (
        BaselineRow,
        Evaluation,
        HiddenPartsResult,
        LevelsResult,
        MapResult,
        SupervisedResult,
    )

_NOTHING = "-"
_MOST_BASELINES = 24
_SCORE_TITLES = ("groups", "purity", "pure", "coverage", "explained", "AMI", "B³ F1")


def print_evaluation(evaluation: Evaluation) -> None:
    """Print all experiments."""
    labels = ", ".join(f"{label} {count}" for label, count in evaluation.labels.items())
    tell(
        f"{evaluation.data_name}: {evaluation.n_objects} objects ({labels}); "
        f"75 % to learn from, {evaluation.repetitions} repetitions"
    )
    _print_groupings(evaluation)
    _print_errors(evaluation)
    if evaluation.hidden is not None:
        _print_hidden(evaluation.hidden)
    if evaluation.supervised is not None:
        _print_supervised(evaluation.supervised)
    if evaluation.levels is not None:
        _print_levels(evaluation.levels)
    if evaluation.map is not None:
        _print_map(evaluation.map)


def _print_groupings(evaluation: Evaluation) -> None:
    from shapeconcepts.evaluation.paper import PAPER
    from shapeconcepts.evaluation.report.verdict import verdict

    _title("Groups found without labels")
    rows = [
        [f"shapeconcepts, {selection.preset}", *_scores(selection.scores)]
        for selection in evaluation.selections
    ]
    rows.append(
        [
            "the paper, on its own data",
            str(PAPER.n_concepts),
            _percent(PAPER.mean_purity),
            _percent(PAPER.pure_share),
            *[_NOTHING] * (len(_SCORE_TITLES) - 3),
        ]
    )
    best_first = sorted(evaluation.baselines, key=_information, reverse=True)[:_MOST_BASELINES]
    rows += [[f"{row.representation}, {row.grouping}", *_scores(row.scores)] for row in best_first]
    print_table(["groups by", *_SCORE_TITLES], rows)
    tell(
        "explained: share of all objects in a group whose majority label is theirs. AMI: adjusted mutual "
        f"information. The {len(best_first)} of {len(evaluation.baselines)} baselines with the largest AMI; "
        "--report and --json have all. Medians over the repetitions."
    )
    tell(verdict(evaluation))


def _print_errors(evaluation: Evaluation) -> None:
    from shapeconcepts.evaluation.paper import PAPER

    _title("Classification error (%) on the test part, by label")
    labels = list(evaluation.labels)
    rows = [
        _error_row(f"concepts, {selection.preset}", selection.errors, labels)
        for selection in evaluation.selections
    ]
    if evaluation.supervised is not None:
        rows.append(_error_row("concepts chosen with labels", evaluation.supervised.errors, labels))
    rows.append(_error_row("the paper, table 1", _single(PAPER.unsupervised_errors), labels))
    rows.append(_error_row("the paper, table 2", _single(PAPER.supervised_errors), labels))
    rows += [_error_row(row.representation, row.errors, labels) for row in evaluation.classifications]
    print_table(["support vector machine on", "mean", *labels], rows)


def _print_hidden(result: HiddenPartsResult) -> None:
    _title("Share of errors where a part of the test objects is hidden, or something is foreign")
    rows = [
        [
            row.recognised_by,
            *(_percent(float(np.median(x))) for x in (row.nothing_hidden, row.part_hidden, row.foreign)),
        ]
        for row in result.rows
    ]
    print_table(["recognised by", "nothing hidden", "a part hidden", "a fifth foreign"], rows)


def _print_supervised(result: SupervisedResult) -> None:
    from shapeconcepts.evaluation.paper import PAPER

    _title("Number and minimum size of concepts chosen by cross-validation")
    with_five = _NOTHING if result.purity_with_five is None else _percent(result.purity_with_five)
    rows = [
        [
            "ours",
            str(result.chosen[0]),
            str(result.chosen[1]),
            _percent(result.chosen_purity),
            _percent(result.chosen_error),
            _percent(result.chosen_coverage),
            with_five,
        ],
        [
            "the paper, on its own data",
            str(PAPER.supervised_number),
            str(PAPER.supervised_size),
            _percent(PAPER.supervised_purity),
            _percent(PAPER.supervised_error),
            _NOTHING,
            _percent(PAPER.purity_with_five),
        ],
    ]
    print_table(["", "concepts", "min size", "purity", "error", "coverage", "purity of five"], rows)


def _print_levels(result: LevelsResult) -> None:
    _title("Number of dictionary levels")
    rows = []
    for level, scores, errors in zip(result.levels, result.scores, result.errors, strict=True):
        rows.append([str(level), *_scores(scores), _percent(float(np.mean(errors)))])
    print_table(["levels", *_SCORE_TITLES, "error"], rows)


def _print_map(result: MapResult) -> None:
    _title("Generalisation: share of objects in a region of their own label")
    rows = []
    for data_set, by_label in result.nearest_region_right.items():
        trained = result.nearest_trained_right.get(data_set, {})
        for label, share in by_label.items():
            n_objects = int(((result.data_set == data_set) & (result.labels == label)).sum())
            by_trained = _percent(trained[label]) if label in trained else _NOTHING
            rows.append([data_set, label, str(n_objects), _percent(share), by_trained])
    print_table(["data set", "label", "objects", "all decide", "trained decide"], rows)
    tell(
        "Regions by the majority of the nearest 5 % of all objects on the map, as in the paper; and of those "
        "that were trained on alone, so that no object votes for its own kind."
    )
    unplaced = ", ".join(f"{name} {count}" for name, count in result.unplaced.items())
    if unplaced:
        tell(f"Objects that remind of nothing learned, and are not on the map: {unplaced}")


def _scores(scores: Sequence[GroupingScores]) -> list[str]:
    def median(name: str) -> float:
        values = np.array([getattr(one, name) for one in scores], float)
        return float(np.nanmedian(values)) if not np.isnan(values).all() else np.nan

    shares = ("mean_purity", "pure_share", "coverage", "explained")
    return [
        f"{median('n_groups'):.0f}",
        *[_percent(median(name)) for name in shares],
        *[f"{median(name):.2f}" for name in ("adjusted_mutual_information", "b_cubed_f1")],
    ]


def _information(row: BaselineRow) -> float:
    return float(np.median([one.adjusted_mutual_information for one in row.scores]))


def _error_row(name: str, errors: dict[str, list[float]], labels: Sequence[str]) -> list[str]:
    means = {label: float(np.mean(values)) for label, values in errors.items() if values}
    shown = [f"{100 * means[label]:.1f}" if label in means else _NOTHING for label in labels]
    return [name, f"{100 * np.mean(list(means.values())):.1f}" if means else _NOTHING, *shown]


def _single(errors: dict[str, float]) -> dict[str, list[float]]:
    return {label: [error] for label, error in errors.items()}


def _percent(share: float) -> str:
    return _NOTHING if np.isnan(share) else f"{100 * share:.1f} %"


def _title(text: str) -> None:
    tell("")
    tell(text)
