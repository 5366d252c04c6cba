"""How labels and regions of the map of concept responses go together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.label_colours import shortened
from shapeconcepts.evaluation.report.style import COLUMN_WIDTH, INK, PAGE_WIDTH, publication_style, say

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import MapResult

_LONGEST = 14


def draw_labels_within_regions(map_: MapResult) -> Figure:
    """Distribution of the labels of the objects in each region, in percent (left of the two in the paper).

    Parameters
    ----------
    map_ : MapResult

    Returns
    -------
    matplotlib.figure.Figure
        A column wide; a page where there are more than eight labels.
    """
    return _draw_matrix(map_.region_of_labels, map_.label_names, "region", "label of the objects in it")


def draw_labels_to_regions(map_: MapResult) -> Figure:
    """Distribution of each label's objects over the regions, in percent (right of the two in the paper).

    Parameters and return value are those of `draw_labels_within_regions`.
    """
    return _draw_matrix(
        map_.labels_to_regions, map_.label_names, "label of the objects", "region that they lie in"
    )


def _draw_matrix(values: Any, names: list[str], down: str, across: str) -> Figure:
    shares = np.asarray(values, dtype=float)
    with publication_style():
        n_rows, n_columns = shares.shape if shares.size else (0, 0)
        width = COLUMN_WIDTH if n_columns <= 8 else PAGE_WIDTH
        figure = Figure(figsize=(width, min(max(0.6 + 0.3 * n_rows, 2.2), PAGE_WIDTH)))
        axes = figure.subplots()
        if not shares.size:
            say(axes, "no regions")
            return figure
        axes.imshow(shares, cmap="Blues", vmin=0, vmax=1, aspect="auto")
        letters = 7 if max(n_rows, n_columns) <= 20 else 5
        for row in range(n_rows):
            for column in range(n_columns):
                share = shares[row, column]
                if not share > 0:
                    continue
                axes.text(
                    column,
                    row,
                    "<1" if share < 0.005 else f"{100 * share:.0f}",
                    ha="center",
                    va="center",
                    fontsize=letters,
                    color="white" if share > 0.68 else INK,
                )
        short = [shortened(name, _LONGEST) for name in names]
        axes.set_xticks(
            np.arange(n_columns), short[:n_columns], rotation=45, ha="right", rotation_mode="anchor"
        )
        axes.set_yticks(np.arange(n_rows), short[:n_rows])
        axes.set_xlabel(across)
        axes.set_ylabel(down)
        axes.tick_params(length=0)
        axes.set_xticks(np.arange(n_columns + 1) - 0.5, minor=True)
        axes.set_yticks(np.arange(n_rows + 1) - 0.5, minor=True)
        axes.grid(which="minor", color="white", linewidth=1)
        axes.tick_params(which="minor", length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
    return figure
