"""The barcode of homology group 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from shapeconcepts.evaluation.report.stopping_times import mark_stopping_times
from shapeconcepts.evaluation.report.style import COLUMN_WIDTH, INK, publication_style, single_axes

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import FiltrationResult

_BARS_HEIGHT = 130  # points, of all bars together


def draw_barcode(filtration: FiltrationResult) -> Figure:
    """A bar for each homology class, from its birth to its death (the paper's figure of the barcode).

    Parameters
    ----------
    filtration : FiltrationResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide.
    """
    with publication_style():
        figure, axes = single_axes(COLUMN_WIDTH, 2.4)
        births, deaths = np.asarray(filtration.diagram, dtype=float).reshape(-1, 2).T
        order = np.lexsort((births, deaths))
        births, deaths = births[order], deaths[order]
        n_bars = len(births)
        rows = np.arange(1, n_bars + 1, dtype=float)
        # All bars are one line with gaps: a file of thousands of bars stays small.
        gaps = np.full(n_bars, np.nan)
        x = np.stack([births, np.minimum(deaths, 1.0), gaps], axis=1).ravel()
        y = np.stack([rows, rows, gaps], axis=1).ravel()
        pitch = _BARS_HEIGHT / max(n_bars, 1)
        # Gaps too narrow to be printed would only give stripes.
        bar_width = min(0.7 * pitch, 4.0) if pitch > 1 else 2 * pitch
        axes.plot(x, y, color=INK, linewidth=bar_width, solid_capstyle="butt")
        forever = rows[np.isinf(deaths)]
        axes.plot(np.ones(len(forever)), forever, ">", color=INK, markersize=4, clip_on=False)
        axes.set_xlim(0, 1)
        axes.set_ylim(0.4 - 0.02 * n_bars, 0.6 + 1.02 * n_bars)
        axes.set_xlabel("filtration time")
        axes.set_ylabel("homology class")
        axes.yaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
        mark_stopping_times(axes, filtration)
    return figure
