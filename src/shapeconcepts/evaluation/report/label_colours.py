"""One colour for each label, the same in every figure, and the key to them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from shapeconcepts.printable import printable
from shapeconcepts.report.palette import LABEL_COLOURS

Place = Literal["outside lower center", "outside upper center"]
_ROW_HEIGHT = 0.155  # inches
_LETTER_WIDTH = 0.062
_KEY_WIDTH = 0.36
LONGEST_NAME = 24


def label_colours(labels: Iterable[str]) -> dict[str, tuple[float, float, float]]:
    """Colour of each label, red, green and blue from 0 to 1.

    Labels take the colours in alphabetical order, as in the report of a model. Where there are more labels
    than colours, the next labels take the same colours halfway to white.
    """
    colours = {}
    for i, label in enumerate(sorted(set(labels))):
        round_, colour = divmod(i, len(LABEL_COLOURS))
        strength = 0.5**round_
        red, green, blue = (1 - strength * (1 - int(c) / 255) for c in LABEL_COLOURS[colour])
        colours[label] = (red, green, blue)
    return colours


def shortened(name: str, longest: int = LONGEST_NAME) -> str:
    """The name on one line, fit to be drawn, its middle left out where it is too long."""
    name = printable(" ".join(name.split())) or "(no name)"
    if len(name) <= longest:
        return name
    head = longest // 2
    return name[:head].rstrip() + "…" + name[head + 1 - longest :].lstrip()


def add_key(
    figure: Figure,
    entries: Sequence[tuple[Artist, str]],
    place: Place = "outside lower center",
) -> None:
    """Put a key over or under the axes of a figure, which grows by as much as that takes."""
    if not entries:
        return
    names = [shortened(name) for _, name in entries]
    width, height = figure.get_size_inches()
    n_columns = int((width - 0.1) / (_KEY_WIDTH + _LETTER_WIDTH * max(map(len, names))))
    n_columns = min(max(n_columns, 1), len(names))
    n_rows = -(-len(names) // n_columns)
    figure.set_size_inches(width, height + _ROW_HEIGHT * n_rows)
    key = figure.legend(
        handles=[handle for handle, _ in entries],
        labels=[str(i) for i in range(len(names))],
        loc=place,
        ncols=n_columns,
        borderpad=0.1,
        labelspacing=0.25,
    )
    # Set afterwards: matplotlib leaves out of a legend whatever begins with an underscore.
    for text, name in zip(key.get_texts(), names, strict=True):
        text.set_text(name)


def label_keys(
    labels: Iterable[str], colours: Mapping[str, tuple[float, float, float]]
) -> list[tuple[Artist, str]]:
    """Entries of a key: a patch of each label's colour, labels in alphabetical order."""
    return [(Patch(facecolor=colours[label]), label) for label in sorted(set(labels))]
