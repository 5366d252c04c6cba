"""The results as tables: beside the paper's figures, and beside the baselines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from shapeconcepts.evaluation.paper import PAPER
from shapeconcepts.evaluation.report.compared_rows import compared_rows
from shapeconcepts.evaluation.report.number_formats import (
    NOTHING,
    decimal,
    mean_error,
    mean_of,
    median_and_range,
    percent,
    whole,
)
from shapeconcepts.evaluation.report.tables import Cell, best_cells, table

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation, HiddenPartsResult, SupervisedResult

_SCORES = (
    ("concepts", "n_groups", whole, str(PAPER.n_concepts)),
    ("mean purity of a concept", "mean_purity", percent, percent(PAPER.mean_purity)),
    ("pure concepts", "pure_share", percent, percent(PAPER.pure_share)),
    ("objects in a concept", "coverage", percent, NOTHING),
    ("objects explained", "explained", percent, NOTHING),
    ("adjusted mutual information", "adjusted_mutual_information", decimal, NOTHING),
    ("B-cubed F1", "b_cubed_f1", decimal, NOTHING),
)

_MOST_COLUMNS = 12


def headline_table(evaluation: Evaluation) -> str:
    """What every preset reaches, beside what the paper reports of its own data."""
    selections = evaluation.selections

    def times(attribute: str) -> list[str]:
        return [decimal(getattr(one.filtration, attribute)) for one in selections]

    rows: list[list[Cell]] = [
        [
            name,
            *(median_and_range([getattr(s, score) for s in one.scores], written) for one in selections),
            papers,
        ]
        for name, score, written, papers in _SCORES
    ]
    rows += [
        [
            "error of the SVM on concept responses",
            *(percent(mean_of(mean_error(one.errors))) for one in selections),
            percent(PAPER.unsupervised_mean_error),
        ],
        ["time of most annexations ε_max", *times("epsilon_max"), decimal(PAPER.epsilon_max)],
        ["time at which concepts are taken", *times("concept_time"), decimal(PAPER.epsilon_max)],
    ]
    others = [NOTHING] * (len(selections) - 1)
    rows += [[name, ours, *others, papers] for name, ours, papers in _supervised_rows(evaluation.supervised)]
    return table(["", *(f"ours, {one.preset}" for one in selections), "the paper, on its own data"], rows)


def _supervised_rows(result: SupervisedResult | None) -> list[tuple[str, str, str]]:
    """Name, ours, the paper's."""
    if result is None:
        return []
    number, size = result.chosen
    return [
        (
            "chosen with labels: number and minimum size of concepts",
            f"{number}, {size}",
            f"{PAPER.supervised_number}, {PAPER.supervised_size}",
        ),
        ("– mean purity of a concept", percent(result.chosen_purity), percent(PAPER.supervised_purity)),
        ("– objects in a concept", percent(result.chosen_coverage), NOTHING),
        ("– cross-validation error", percent(result.chosen_error), percent(PAPER.supervised_error)),
        (
            "– error on the test objects",
            percent(mean_of(mean_error(result.errors))),
            percent(PAPER.supervised_mean_error),
        ),
        ("mean purity of five concepts", percent(result.purity_with_five), percent(PAPER.purity_with_five)),
    ]


def hidden_table(result: HiddenPartsResult) -> str:
    """Share of errors with nothing and with a part hidden, and with something foreign."""
    rows: list[list[Cell]] = [
        [
            row.recognised_by,
            median_and_range(row.nothing_hidden, percent),
            median_and_range(row.part_hidden, percent),
            median_and_range(row.foreign, percent),
        ]
        for row in result.rows
    ]
    return table(["recognised by", "nothing hidden", "a part hidden", "a fifth foreign"], rows)


def error_table(
    rows: Sequence[tuple[str, dict[str, list[float]]]],
    papers: dict[str, float] | None = None,
    ours: Sequence[int] = (),
) -> str:
    """Mean classification errors by label, in percent; the smallest for each label is bold.

    A column for each label, or a row where there are many.

    Parameters
    ----------
    rows : sequence of (str, dict)
        Name, and the errors of each label in each repetition.
    papers : dict of str to float, or None
        The paper's row of other data, which does not compete.
    ours : sequence of int
        Rows to be set off.
    """
    labels = list(dict.fromkeys(label for _, errors in rows for label in errors))
    means = [
        [*(mean_of(errors.get(label, [])) for label in labels), mean_of(mean_error(errors))]
        for _, errors in rows
    ]
    names = [name for name, _ in rows]
    texts = [list(map(percent, values)) for values in means]
    if papers and any(label in papers for label in labels):
        # A mean over other labels than ours would not say anything.
        whole_row = set(labels) == set(papers)
        mean = mean_of(list(papers.values())) if whole_row else None
        names.append("the paper, on its own data")
        texts.append([*(percent(papers.get(one)) for one in labels), percent(mean)])
    best = best_cells(means, smallest=True) if len(rows) > 1 else []
    columns = [*labels, "mean"]
    if len(columns) > _MOST_COLUMNS:
        lines = [list(line) for line in zip(columns, *texts, strict=True)]
        return table(["mean error", *names], lines, best=[(j - 1, i + 1) for i, j in best])
    lines = [[name, *values] for name, values in zip(names, texts, strict=True)]
    return table(["mean error", *columns], lines, ours=ours, best=best)


def baseline_table(evaluation: Evaluation) -> str:
    """Ours and the baselines, the best of each column in bold; those with most information come first."""
    rows = compared_rows(evaluation.baselines, evaluation.selections)
    texts: list[list[Cell]] = []
    values = []
    for row in rows:
        texts.append(
            [
                row.name,
                *(median_and_range(row.values(score), written) for _, score, written, _ in _SCORES),
                _shown_parameters(row.parameters),
            ]
        )
        values.append([row.median(score) for _, score, _, _ in _SCORES[1:]])
    best = [(i, j + 1) for i, j in best_cells(values)]
    return table(
        ["", "groups", *(name for name, *_ in _SCORES[1:]), "parameters"],
        texts,
        ours=[i for i, row in enumerate(rows) if row.is_ours],
        best=best,
    )


def _shown_parameters(parameters: Sequence[dict[str, Any]]) -> str:
    """The values chosen, in the order of the repetitions; once where all are equal."""
    shown = []
    for name in dict.fromkeys(key for one in parameters for key in one):
        values = [_short(one[name]) for one in parameters if name in one]
        shown.append(f"{name}\u00a0=\u00a0{values[0] if len(set(values)) == 1 else ', '.join(values)}")
    return "; ".join(shown)


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
