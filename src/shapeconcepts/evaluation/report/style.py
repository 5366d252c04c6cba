"""How figures for a publication look, whatever the user's matplotlib is set to."""

from __future__ import annotations

from contextlib import AbstractContextManager

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLUMN_WIDTH = 3.5  # inches: one column of a paper
PAGE_WIDTH = 7.0  # inches: both columns

INK = "#1d2433"
QUIET = "#5b6070"
LINE = "#e5e1d8"
OURS = "#c2410c"
PAPERS = "#0072b2"

_STYLE = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so a figure looks alike on every machine
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "text.color": INK,
    "text.parse_math": False,  # names of labels are text, even with a dollar in them
    "axes.labelcolor": INK,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "grid.color": LINE,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "legend.columnspacing": 1.2,
    "hatch.linewidth": 0.6,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 200,
    "svg.hashsalt": "shapeconcepts",  # the same figure gives the same file
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}


def publication_style() -> AbstractContextManager[None]:
    """Matplotlib's defaults with the style of these figures, until the block ends.

    The user's own settings play no part, and are as before afterwards.
    """
    return matplotlib.style.context(_STYLE, after_reset=True)


def single_axes(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure of that many inches with one pair of axes."""
    figure = Figure(figsize=(width, height))
    return figure, figure.subplots()


def say(axes: Axes, text: str) -> None:
    """Write in empty axes why they are empty."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=QUIET)
