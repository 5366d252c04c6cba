"""Ours beside every baseline."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.compared_rows import compared_rows, smallest_median_largest
from shapeconcepts.evaluation.report.label_colours import shortened
from shapeconcepts.evaluation.report.measures import MEASURES
from shapeconcepts.evaluation.report.number_formats import percent
from shapeconcepts.evaluation.report.style import INK, OURS, PAGE_WIDTH, publication_style, say

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import BaselineRow, SelectionResult

# More do not fit on a page.
MOST_BASELINES = 24


def draw_baseline_comparison(
    baselines: Sequence[BaselineRow], selections: Sequence[SelectionResult]
) -> Figure:
    """Information, B-cubed F1 and objects explained of ours and of the 24 baselines with most information.

    A dot is the median over repetitions, its line goes from the smallest to the largest. Ours are in
    colour and bold.

    Parameters
    ----------
    baselines : sequence of BaselineRow
    selections : sequence of SelectionResult
        Ours.

    Returns
    -------
    matplotlib.figure.Figure
        A page wide; the way with most information is at the top.
    """
    shown = {row.name for row in compared_rows(baselines, [])[:MOST_BASELINES]}
    rows = [row for row in compared_rows(baselines, selections) if row.is_ours or row.name in shown]
    with publication_style():
        figure = Figure(figsize=(PAGE_WIDTH, 0.65 + 0.21 * max(len(rows), 2)))
        panels = figure.subplots(1, len(MEASURES), sharey=True)
        if not rows:
            for axes, text in zip(panels, ("nothing to compare", "", ""), strict=True):
                say(axes, text)
            return figure
        for axes, measure in zip(panels, MEASURES, strict=True):
            is_share = measure.written is percent
            for at, row in enumerate(rows):
                low, middle, high = smallest_median_largest(row.values(measure.score))
                colour = OURS if row.is_ours else INK
                axes.plot([low, high], [at, at], color=colour, linewidth=1.4, solid_capstyle="round")
                axes.plot(
                    middle, at, "D" if row.is_ours else "o", color=colour, markersize=4.5, clip_on=False
                )
            axes.set_title(f"{measure.name}{' (%)' if is_share else ''}", loc="left")
            axes.grid(axis="both")
            axes.tick_params(axis="y", length=0)
            axes.spines["left"].set_visible(False)
            axes.set_xlim(min(0.0, axes.get_xlim()[0]), 1)
            axes.xaxis.set_major_formatter(_percent_of if is_share else _number)
        panels[0].set_ylim(len(rows) - 0.5, -0.5)
        panels[0].set_yticks(range(len(rows)), [shortened(row.name, 46) for row in rows])
        for row, text in zip(rows, panels[0].get_yticklabels(), strict=True):
            if row.is_ours:
                text.set(color=OURS, fontweight="bold")
    return figure


def _number(value: float, _: object) -> str:
    return f"{value:g}"


def _percent_of(share: float, _: object) -> str:
    return f"{100 * share:.0f}"
