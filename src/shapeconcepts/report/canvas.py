"""A sheet to draw lines, boxes, text and pictures on, with smooth edges."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from os import PathLike

import numpy as np
from PIL import Image, ImageDraw

from shapeconcepts.report.lettering import TITLE_COLOUR, font_of, shorten

SUPERSAMPLING = 3

Colour = tuple[int, int, int]
Point = tuple[float, float]

WHITE: Colour = (255, 255, 255)


class Canvas:
    """Shapes are drawn larger and reduced at the end; text and pictures come above them, pixel by pixel.

    Parameters
    ----------
    width, height : float
        Pixels, rounded up.
    """

    def __init__(self, width: float, height: float) -> None:
        self.size = ceil(width), ceil(height)
        self._shapes = Image.new("RGB", (self.size[0] * SUPERSAMPLING, self.size[1] * SUPERSAMPLING), "white")
        self._draw = ImageDraw.Draw(self._shapes)
        self._pictures: list[tuple[Image.Image, Point]] = []
        self._texts: list[tuple[Point, str, float, Colour, str]] = []

    def line(self, points: Sequence[Point], colour: Colour, width: float = 1.0) -> None:
        """Line through points."""
        scaled = [(x * SUPERSAMPLING, y * SUPERSAMPLING) for x, y in points]
        self._draw.line(scaled, fill=colour, width=max(1, round(width * SUPERSAMPLING)), joint="curve")

    def box(
        self, left_top: Point, width: float, height: float, fill: Colour, outline: Colour | None = None
    ) -> None:
        """Rectangle with round corners."""
        x, y = left_top
        self._draw.rounded_rectangle(
            [v * SUPERSAMPLING for v in (x, y, x + width, y + height)],
            radius=min(8.0, height / 2, width / 2) * SUPERSAMPLING,
            fill=fill,
            outline=outline,
            width=round(1.2 * SUPERSAMPLING),
        )

    def text(
        self,
        at: Point,
        text: str,
        size: float,
        colour: Colour = TITLE_COLOUR,
        *,
        anchor: str = "lm",
        width: float | None = None,
    ) -> float:
        """One line of text, shortened to `width`; returns how wide it is.

        `anchor` is Pillow's: "lm" starts at the point, "mm" is centred on it, "rm" ends there.
        """
        font = font_of(size)
        text = shorten(text, font, self.size[0] if width is None else width)
        self._texts.append((at, text, size, colour, anchor))
        return font.getlength(text)

    def picture(self, picture: Image.Image, left_top: Point) -> None:
        """Paste a picture; its white stays transparent."""
        self._pictures.append((picture, left_top))

    def finish(self, path: str | PathLike[str] | None = None) -> Image.Image:
        """The sheet as an RGB picture, saved where a path is given."""
        sheet = self._shapes.resize(self.size, Image.Resampling.BOX)
        for picture, (x, y) in self._pictures:
            is_drawn = (np.asarray(picture.convert("RGB")) < 255).any(axis=2)
            sheet.paste(picture, (round(x), round(y)), Image.fromarray(is_drawn))
        draw = ImageDraw.Draw(sheet)
        for at, text, size, colour, anchor in self._texts:
            draw.text(at, text, fill=colour, font=font_of(size), anchor=anchor)
        if path is not None:
            sheet.save(path)
        return sheet


def blend(colour: Colour, other: Colour, share: float) -> Colour:
    """Mixture of two colours; `share` 0 is the first, 1 the other."""
    mixed = (1 - share) * np.array(colour) + share * np.array(other)
    return int(mixed[0] + 0.5), int(mixed[1] + 0.5), int(mixed[2] + 0.5)
