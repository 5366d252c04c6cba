"""Puts an evaluation into one HTML file."""

from __future__ import annotations

import html
from importlib.resources import files
from os import PathLike
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from shapeconcepts.evaluation.report.compared_rows import compared_rows
from shapeconcepts.evaluation.report.drawing import draw_all
from shapeconcepts.evaluation.report.number_formats import (
    NOTHING,
    decimal,
    mean_error,
    mean_of,
    percent,
    whole,
)
from shapeconcepts.evaluation.report.sections import sections
from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.printable import markup_bytes

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation


def write_evaluation(path: str | PathLike[str], evaluation: Evaluation) -> None:
    """Write a page with every result of an evaluation, the paper's figures and the baselines beside ours.

    The page is one file that needs no network and no scripts, and can be printed.

    Parameters
    ----------
    path : str or path
        The HTML file; its folder must exist. It appears complete or not at all.
    evaluation : Evaluation

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    write_atomically(Path(path), markup_bytes(_document(evaluation)))


def _document(evaluation: Evaluation) -> str:
    looks = files("shapeconcepts.report.html") / "templates" / "page.css"
    templates = files("shapeconcepts.evaluation.report") / "templates"
    parts = sections(evaluation, draw_all(evaluation))
    return Template((templates / "evaluation.html").read_text("utf-8")).substitute(
        title=html.escape(f"Evaluation on {evaluation.data_name}"),
        style=looks.read_text("utf-8") + (templates / "evaluation.css").read_text("utf-8"),
        lead=html.escape(_lead(evaluation)),
        facts="".join(
            f'<div class="fact"><strong>{html.escape(figure)}</strong><span>{html.escape(name)}</span></div>'
            for figure, name in _facts(evaluation)
        ),
        links="".join(f'<a href="#{part.name}">{html.escape(part.title)}</a>' for part in parts),
        sections="\n".join(part.markup() for part in parts),
    )


def _lead(evaluation: Evaluation) -> str:
    n_labels, n_splits = len(evaluation.labels), evaluation.repetitions
    return (
        f"{evaluation.n_objects} object{'s' * (evaluation.n_objects != 1)} of {n_labels} "
        f"label{'s' * (n_labels != 1)}, "
        f"{n_splits} random split{'s' * (n_splits != 1)} into training and test objects. The experiments of "
        "the paper, its figures redrawn from this data, and off-the-shelf baselines on the same splits."
    )


def _facts(evaluation: Evaluation) -> list[tuple[str, str]]:
    """What the first preset reaches: medians over the splits, and the mean error."""
    if not evaluation.selections:
        return []
    ours = evaluation.selections[0]

    (row,) = compared_rows([], [ours])
    facts = [
        (whole(row.median("n_groups")), "concepts"),
        (decimal(row.median("adjusted_mutual_information")), "mutual information"),
        (decimal(row.median("b_cubed_f1")), "B-cubed F1"),
        (percent(row.median("explained")), "objects explained"),
        (percent(mean_of(mean_error(ours.errors))), "error of the SVM"),
    ]
    return [(figure, name) for figure, name in facts if figure != NOTHING]
