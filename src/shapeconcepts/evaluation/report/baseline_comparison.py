"""Ours beside every baseline."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.compared_rows import compared_rows, smallest_median_largest
from shapeconcepts.evaluation.report.label_colours import shortened
from shapeconcepts.evaluation.report.style import INK, OURS, PAGE_WIDTH, publication_style, say

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import BaselineRow, SelectionResult


def draw_baseline_comparison(
    baselines: Sequence[BaselineRow], selections: Sequence[SelectionResult]
) -> Figure:
    """Objects explained and adjusted mutual information of every way to group.

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
        A page wide; the way that explains most is at the top.
    """
    rows = compared_rows(baselines, selections)
    with publication_style():
        figure = Figure(figsize=(PAGE_WIDTH, 0.65 + 0.21 * max(len(rows), 2)))
        explained, information = figure.subplots(1, 2, sharey=True)
        if not rows:
            say(explained, "nothing to compare")
            say(information, "")
            return figure
        for axes, score, title in (
            (explained, "explained", "objects explained (%)"),
            (information, "adjusted_mutual_information", "adjusted mutual information"),
        ):
            for at, row in enumerate(rows):
                low, middle, high = smallest_median_largest(row.values(score))
                colour = OURS if row.is_ours else INK
                axes.plot([low, high], [at, at], color=colour, linewidth=1.4, solid_capstyle="round")
                axes.plot(
                    middle, at, "D" if row.is_ours else "o", color=colour, markersize=4.5, clip_on=False
                )
            axes.set_title(title, loc="left")
            axes.grid(axis="both")
            axes.tick_params(axis="y", length=0)
            axes.spines["left"].set_visible(False)
            axes.set_xlim(min(0.0, axes.get_xlim()[0]), 1)
        explained.set_ylim(len(rows) - 0.5, -0.5)
        explained.set_yticks(range(len(rows)), [shortened(row.name, 46) for row in rows])
        for row, text in zip(rows, explained.get_yticklabels(), strict=True):
            if row.is_ours:
                text.set(color=OURS, fontweight="bold")
        information.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        explained.xaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f}")
    return figure
