"""The concepts, ranked, each as a bar of the labels in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from shapeconcepts.evaluation.report.label_colours import add_key, label_keys
from shapeconcepts.evaluation.report.style import PAGE_WIDTH, QUIET, publication_style, say

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import ConceptBar

_MOST_NUMBERED = 60


def draw_ranked_concepts(
    bars: Sequence[ConceptBar], colours: Mapping[str, tuple[float, float, float]]
) -> Figure:
    """Proportions of the labels in each concept, over the concepts' sizes (the paper's ranked concepts).

    Parameters
    ----------
    bars : sequence of ConceptBar
        Drawn from left to right in this order.
    colours : mapping of str to (red, green, blue)
        Of each label, from 0 to 1.

    Returns
    -------
    matplotlib.figure.Figure
        A page wide.
    """
    with publication_style():
        figure = Figure(figsize=(PAGE_WIDTH, 2.6))
        shares, sizes = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
        if not bars:
            say(shares, "no concepts")
            say(sizes, "")
            return figure
        x = np.arange(1, len(bars) + 1)
        bottom = np.zeros(len(bars))
        present = sorted({label for bar in bars for label in bar.proportions})
        # The majority label stands at the bottom of every bar, the others follow by their share.
        by_share = [sorted(bar.proportions.items(), key=lambda pair: (-pair[1], pair[0])) for bar in bars]
        for rank in range(max(map(len, by_share))):
            held = [i for i, pairs in enumerate(by_share) if rank < len(pairs)]
            heights = np.array([by_share[i][rank][1] for i in held])
            shares.bar(
                x[held],
                heights,
                bottom=bottom[held],
                width=0.86,
                color=[colours[by_share[i][rank][0]] for i in held],
                edgecolor="white",
                linewidth=0.3,
            )
            bottom[held] += heights
        shares.set_ylabel("proportion of labels")
        shares.set_ylim(0, 1)
        shares.yaxis.set_major_formatter(lambda share, _: f"{100 * share:.0f} %")

        counts = [bar.size for bar in bars]
        sizes.bar(x, counts, width=0.86, color=QUIET)
        sizes.set_ylabel("objects")
        sizes.set_xlabel("concepts by rising rank score")
        sizes.set_xlim(0.4, len(bars) + 0.6)
        if len(bars) <= _MOST_NUMBERED:
            figure_of = 6.5 if len(bars) <= 40 else 5.0
            for at, count in zip(x, counts, strict=True):
                sizes.annotate(
                    str(count),
                    (at, count),
                    (0, 1),
                    textcoords="offset points",
                    ha="center",
                    fontsize=figure_of,
                )
            sizes.set_ylim(0, 1.45 * max(counts))
            sizes.set_yticks([])
            sizes.spines["left"].set_visible(False)
        sizes.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
        figure.align_ylabels()
        add_key(figure, label_keys(present, colours))
    return figure
