"""Annexations over filtration time, and the concepts that there are at each time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from shapeconcepts.evaluation.report.stopping_times import STOP_LINES, mark_stopping_times
from shapeconcepts.evaluation.report.style import (
    COLUMN_WIDTH,
    INK,
    QUIET,
    publication_style,
    say,
)

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import FiltrationResult


def draw_annexation_curve(filtration: FiltrationResult) -> Figure:
    """Annexations in each step of the filtration (the paper's figure of annexations), over the concepts left.

    Parameters
    ----------
    filtration : FiltrationResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide.
    """
    with publication_style():
        figure = Figure(figsize=(COLUMN_WIDTH, 2.9))
        annexations, concepts = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        if not len(filtration.step_ends):
            say(annexations, "nothing was annexed")
            say(concepts, "")
            return figure
        edges = np.concatenate([[0.0], filtration.step_ends])
        annexations.stairs(filtration.counts, edges, fill=True, color=QUIET)
        annexations.set_ylabel("annexations")
        mark_stopping_times(annexations, filtration)

        changes = np.concatenate([[0.0], filtration.times, [1.0]])
        concepts.stairs(np.concatenate([[0], filtration.n_concepts]), changes, baseline=None, color=INK)
        stops = (filtration.epsilon_max, filtration.concept_time)
        for time, (colour, dashes, order) in zip(stops, STOP_LINES, strict=True):
            if time is not None:
                concepts.axvline(time, color=colour, linewidth=1, linestyle=dashes, zorder=order)
        concepts.set_ylabel("concepts")
        concepts.set_xlabel("filtration time")
        concepts.set_xlim(0, 1)
        for axes in (annexations, concepts):
            axes.set_ylim(bottom=0)
            axes.yaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
        figure.align_ylabels()
    return figure
