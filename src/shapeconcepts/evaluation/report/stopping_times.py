"""Marks of the times at which a filtration may be stopped."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes

from shapeconcepts.evaluation.report.style import OURS, PAPERS

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import FiltrationResult

# Colour, dashes and order of the paper's time and of ours: where both are the same, both are seen.
STOP_LINES = ((PAPERS, "--", 4), (OURS, "-", 3))
_NEAR = 0.45  # so little apart, names in the middle over their lines might meet


def mark_stopping_times(axes: Axes, filtration: FiltrationResult) -> None:
    """Lines at the paper's stopping time and at ours, with their names above the axes."""
    papers, ours = filtration.epsilon_max, filtration.concept_time
    sides = ("center", "center")
    if papers is not None and ours is not None and abs(papers - ours) < _NEAR:
        # The left line has its name to the left and the right one to the right, so that they do not meet.
        sides = ("right", "left") if papers <= ours else ("left", "right")
    for name, time, (colour, dashes, order), side in zip(
        (r"$\epsilon_{max}$", "ours"), (papers, ours), STOP_LINES, sides, strict=True
    ):
        if time is None:
            continue
        axes.axvline(time, color=colour, linewidth=1, linestyle=dashes, zorder=order)
        axes.annotate(
            f"{name} = {time:.2f}",
            (time, 1),
            xycoords=axes.get_xaxis_transform(),
            xytext=({"right": -1, "left": 1, "center": 0}[side], 3),
            textcoords="offset points",
            ha=side,
            va="bottom",
            color=colour,
            fontsize=7,
            parse_math=True,
            annotation_clip=False,
        )
