"""The map of concept responses of several data sets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from shapeconcepts.evaluation.report.label_colours import add_key, label_keys
from shapeconcepts.evaluation.report.style import INK, PAGE_WIDTH, publication_style, say, single_axes

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import MapResult

MARKERS = ("o", "^", "s", "D", "v", "P", "X", "*")


def draw_concept_map(map_: MapResult, colours: Mapping[str, tuple[float, float, float]]) -> Figure:
    """Objects in two dimensions, over cells coloured by the label that dominates around them.

    A cell is as opaque as the share of that label among the nearest objects (the paper's figure of the space
    of concept responses). The marker says which data set an object is from.

    Parameters
    ----------
    map_ : MapResult
    colours : mapping of str to (red, green, blue)
        Of each label, from 0 to 1.

    Returns
    -------
    matplotlib.figure.Figure
        A page wide.
    """
    with publication_style():
        figure, axes = single_axes(PAGE_WIDTH, 5.0)
        if not len(map_.positions):
            say(axes, "no objects")
            return figure
        cells = np.ones((*map_.majority.shape, 4))
        for label in np.unique(map_.majority):
            if label in colours:
                cells[map_.majority == label, :3] = colours[label]
        # On a white page, weaker still than the objects on it.
        cells[..., 3] = 0.6 * np.clip(np.nan_to_num(map_.share), 0, 1)
        axes.imshow(
            cells,
            origin="lower",
            extent=(*_ends(map_.grid_x), *_ends(map_.grid_y)),
            interpolation="none",
            aspect="auto",
        )
        data_sets = sorted(set(map_.data_set.tolist()))
        names = sorted(set(map_.labels.tolist()))
        for i, data_set in enumerate(data_sets):
            chosen = map_.data_set == data_set
            axes.scatter(
                map_.positions[chosen, 0],
                map_.positions[chosen, 1],
                c=[colours[label] for label in map_.labels[chosen]],
                marker=MARKERS[i % len(MARKERS)],
                s=15,
                linewidths=0.5,
                edgecolors=INK,
                clip_on=False,
            )
        axes.set_xticks([])
        axes.set_yticks([])
        for spine in axes.spines.values():
            spine.set_visible(True)
        dots: list[tuple[Artist, str]] = [
            (
                Line2D(
                    [], [], linestyle="none", marker=MARKERS[i % len(MARKERS)], color="white",
                    markeredgecolor=INK, markersize=5,
                ),
                data_set,
            )
            for i, data_set in enumerate(data_sets)
        ]  # fmt: skip
        add_key(figure, dots, "outside upper center")
        add_key(figure, label_keys(names, colours))
    return figure


def _ends(centres: np.ndarray) -> tuple[float, float]:
    """Outer borders of cells with these centres."""
    half = (centres[-1] - centres[0]) / (2 * (len(centres) - 1)) if len(centres) > 1 else 0.5
    return float(centres[0] - half), float(centres[-1] + half)
