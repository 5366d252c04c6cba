"""Whether purer concepts classify better."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.stats import spearmanr

from shapeconcepts.evaluation.report.style import (
    COLUMN_WIDTH,
    OURS,
    QUIET,
    publication_style,
    say,
    single_axes,
)

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import SupervisedResult


def draw_purity_against_error(supervised: SupervisedResult) -> Figure:
    """Mean purity and classification error of every number and minimum size of concepts.

    The number in the corner is Spearman's rank correlation.

    Parameters
    ----------
    supervised : SupervisedResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide.
    """
    with publication_style():
        figure, axes = single_axes(COLUMN_WIDTH, 2.6)
        purity, error = np.asarray(supervised.purity), np.asarray(supervised.error)
        numbers = np.broadcast_to(np.asarray(supervised.numbers)[:, None], purity.shape)
        known = np.isfinite(purity) & np.isfinite(error)
        if not known.any():
            say(axes, "no number of concepts was reached")
            return figure
        dots = axes.scatter(
            100 * purity[known], 100 * error[known], c=numbers[known], cmap="viridis", s=14, linewidths=0
        )
        if np.isfinite(supervised.chosen_purity) and np.isfinite(supervised.chosen_error):
            axes.plot(
                100 * supervised.chosen_purity,
                100 * supervised.chosen_error,
                "o",
                markersize=8,
                markerfacecolor="none",
                markeredgecolor=OURS,
                markeredgewidth=1.4,
            )
            axes.set_title("○ chosen", color=OURS, fontsize=7, loc="left")
        axes.set_title(_correlation(purity[known], error[known]), color=QUIET, fontsize=7, loc="right")
        axes.set_xlabel("mean purity (%)")
        axes.set_ylabel("mean error (%)")
        axes.grid()
        axes.margins(0.06)
        whole = MaxNLocator("auto", integer=True, min_n_ticks=1)
        bar = figure.colorbar(dots, ax=axes, aspect=25, pad=0.02, ticks=whole)
        bar.outline.set_visible(False)
        bar.set_label("number of concepts")
    return figure


def _correlation(purity: np.ndarray, error: np.ndarray) -> str:
    if len(purity) < 3 or np.ptp(purity) == 0 or np.ptp(error) == 0:
        return ""
    return f"rank correlation {spearmanr(purity, error).statistic:.2f}".replace("-", "−")
