"""Quality of the concepts by the number of dictionary levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.compared_rows import smallest_median_largest
from shapeconcepts.evaluation.report.label_colours import add_key
from shapeconcepts.evaluation.report.style import (
    COLUMN_WIDTH,
    INK,
    OURS,
    PAPERS,
    publication_style,
    single_axes,
)

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import LevelsResult


def draw_levels(levels: LevelsResult) -> Figure:
    """Mean purity, objects explained and classification error for each number of levels.

    The mark is the median over repetitions, the bar goes from the smallest to the largest.

    Parameters
    ----------
    levels : LevelsResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide.
    """
    with publication_style():
        figure, axes = single_axes(COLUMN_WIDTH, 2.4)
        series = [
            ("mean purity", [[s.mean_purity for s in one] for one in levels.scores], INK, "o", "-"),
            ("objects explained", [[s.explained for s in one] for one in levels.scores], PAPERS, "s", "--"),
            ("mean error", levels.errors, OURS, "^", ":"),
        ]
        x = np.arange(len(levels.levels), dtype=float)
        keys: list[tuple[Artist, str]] = []
        for i, (name, values, colour, marker, dashes) in enumerate(series):
            low, middle, high = np.array([smallest_median_largest(one) for one in values]).reshape(-1, 3).T
            # Set apart a little, so that one bar does not hide another.
            handle = axes.errorbar(
                x + 0.06 * (i - 1),
                middle,
                yerr=[middle - low, high - middle],
                color=colour,
                marker=marker,
                markersize=4,
                linestyle=dashes,
                linewidth=1.1,
                elinewidth=0.8,
            )
            keys.append((handle.lines[0], name))
        axes.set_xticks(x, [str(level) for level in levels.levels])
        axes.set_xlabel("dictionary levels n")
        axes.set_ylim(-0.03, 1.03)
        axes.yaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f} %")
        axes.grid(axis="y")
        add_key(figure, keys)
    return figure
