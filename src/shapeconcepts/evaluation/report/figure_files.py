"""Figures as files: PNG and SVG, the same bytes every time."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from os import PathLike
from pathlib import Path

from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.style import publication_style
from shapeconcepts.io.atomic_write import write_atomically

# Neither when nor with which version a figure was drawn, else it changes with every drawing.
_NO_METADATA = {
    "png": {"Software": None},
    "svg": {"Creator": None, "Date": None, "Format": None, "Type": None},
}


def figure_bytes(figure: Figure, format: str) -> bytes:
    """The figure as a ``png`` of 200 dots an inch, or as an ``svg`` whose text is drawn as outlines."""
    content = BytesIO()
    with publication_style():
        figure.savefig(content, format=format, metadata=_NO_METADATA[format])
    return content.getvalue()


def save_figures(figures: Mapping[str, Figure], folder: str | PathLike[str]) -> list[Path]:
    """Write every figure as NAME.png and NAME.svg.

    Parameters
    ----------
    figures : mapping of str to matplotlib.figure.Figure
        By name.
    folder : str or path
        Made where it does not exist.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, figure in figures.items():
        for format in _NO_METADATA:
            paths.append(folder / f"{name}.{format}")
            write_atomically(paths[-1], figure_bytes(figure, format))
    return paths
