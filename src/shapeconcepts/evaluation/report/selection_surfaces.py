"""Purity and error of the concepts over their number and minimum size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

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

_MOST_TICKS = 9


def draw_purity_surface(supervised: SupervisedResult) -> Figure:
    """Mean purity of the concepts for each number and minimum size (left half of the paper's figure).

    Bright is pure. Empty where the filtration has no such concepts.

    Parameters
    ----------
    supervised : SupervisedResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide.
    """
    return _draw_surface(supervised, supervised.purity, supervised.chosen_purity, "mean purity", "cividis")


def draw_error_surface(supervised: SupervisedResult) -> Figure:
    """Classification error for each number and minimum size of concepts (right half of the paper's figure).

    Bright is a small error. Parameters and return value are those of `draw_purity_surface`.
    """
    return _draw_surface(supervised, supervised.error, supervised.chosen_error, "mean error", "cividis_r")


def _draw_surface(
    supervised: SupervisedResult, values: Any, chosen_value: float, name: str, colour_map: str
) -> Figure:
    with publication_style():
        figure, axes = single_axes(COLUMN_WIDTH, 2.5)
        shares = np.asarray(values, dtype=float)
        if not np.isfinite(shares).any():
            say(axes, "no number of concepts was reached")
            return figure
        n_numbers, n_sizes = shares.shape
        axes.patch.set(facecolor="white", edgecolor="#d8d5cd", hatch="/////")
        picture = axes.pcolormesh(
            np.arange(n_numbers + 1) - 0.5,
            np.arange(n_sizes + 1) - 0.5,
            np.ma.masked_invalid(100 * shares.T),
            cmap=colour_map,
            # Viewers that smooth edges would show white lines between cells that only touch.
            edgecolors="face",
            linewidth=0.4,
        )
        _set_ticks(axes.set_xticks, supervised.numbers)
        _set_ticks(axes.set_yticks, supervised.sizes)
        axes.set_xlabel("number of concepts")
        axes.set_ylabel("minimum concept size")
        for spine in axes.spines.values():
            spine.set_visible(True)
        bar = figure.colorbar(picture, ax=axes, aspect=25, pad=0.02)
        bar.outline.set_visible(False)
        bar.set_label(f"{name} (%)")
        number, size = supervised.chosen
        at = np.flatnonzero(supervised.numbers == number), np.flatnonzero(supervised.sizes == size)
        if len(at[0]) and len(at[1]):
            corner = (float(at[0][0]) - 0.5, float(at[1][0]) - 0.5)
            for colour, width in (("white", 3.2), (OURS, 1.6)):
                axes.add_patch(
                    Rectangle(
                        corner, 1, 1, fill=False, edgecolor=colour, linewidth=width, clip_on=False, zorder=5
                    )
                )
        axes.set_title(
            f"chosen: {number} concepts of at least {size} objects, {100 * chosen_value:.1f} %",
            color=OURS,
            fontsize=7,
            loc="left",
        )
        axes.tick_params(color=QUIET)
    return figure


def _set_ticks(set_ticks: Any, values: Any) -> None:
    """Name every value where there is room for it, else every second, third ..."""
    step = -(-len(values) // _MOST_TICKS)
    at = np.arange(0, len(values), step)
    set_ticks(at, [str(int(values[i])) for i in at])
