"""A sheet to draw lines, discs, text and pictures on, with smooth edges."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from os import PathLike

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from shapeconcepts.report.lettering import TITLE_COLOUR, font_of, shorten

_SUPERSAMPLING = 3

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
        self._shapes = Image.new(
            "RGB", (self.size[0] * _SUPERSAMPLING, self.size[1] * _SUPERSAMPLING), "white"
        )
        self._draw = ImageDraw.Draw(self._shapes)
        self._pictures: list[tuple[Image.Image, Point]] = []
        self._texts: list[tuple[Point, str, float, Colour, str]] = []

    def line(self, points: Sequence[Point], colour: Colour, width: float = 1.0) -> None:
        """Line through points."""
        scaled = [(x * _SUPERSAMPLING, y * _SUPERSAMPLING) for x, y in points]
        self._draw.line(scaled, fill=colour, width=max(1, round(width * _SUPERSAMPLING)), joint="curve")

    def curve(self, start: Point, control: Point, end: Point, colour: Colour, width: float = 1.0) -> None:
        """Quadratic Bézier curve."""
        self.line(_bezier(np.array([start, control, end])), colour, width)

    def branch(self, start: Point, end: Point, colour: Colour, width: float = 1.0) -> None:
        """Curve that leaves and arrives vertically, as in a tree."""
        middle = (start[1] + end[1]) / 2
        controls = np.array([start, (start[0], middle), (end[0], middle), end])
        self.line(_bezier(controls), colour, width)

    def disc(self, centre: Point, radius: float, fill: Colour | None, outline: Colour | None = None) -> None:
        """Disc, or a ring where there is no fill."""
        self._draw.ellipse(
            _box(centre, radius, radius), fill=fill, outline=outline, width=round(1.5 * _SUPERSAMPLING)
        )

    def ellipse(self, centre: Point, half_width: float, half_height: float, fill: Colour) -> None:
        """Filled ellipse."""
        self._draw.ellipse(_box(centre, half_width, half_height), fill=fill)

    def pie(self, centre: Point, radius: float, slices: Sequence[Colour]) -> None:
        """Disc of equal slices, clockwise from the top, with white lines between them."""
        if len(slices) == 1:
            self.disc(centre, radius, slices[0])
            return
        angles = np.linspace(-90, 270, len(slices) + 1)
        for colour, start, end in zip(slices, angles, angles[1:], strict=False):
            self._draw.pieslice(_box(centre, radius, radius), start, end, fill=colour)
        for angle in np.radians(angles[:-1]):
            rim = (centre[0] + radius * float(np.cos(angle)), centre[1] + radius * float(np.sin(angle)))
            self.line([centre, rim], WHITE, 1.0)

    def word(self, centre: Point, radius: float, word: int, colour: Colour) -> None:
        """Disc of a visual word with its number."""
        self.disc(centre, radius, colour)
        is_light = colour[0] * 0.3 + colour[1] * 0.59 + colour[2] * 0.11 > 150
        self.text(centre, f"w{word}", 0.95 * radius, TITLE_COLOUR if is_light else WHITE, anchor="mm")

    def box(
        self, left_top: Point, width: float, height: float, fill: Colour, outline: Colour | None = None
    ) -> None:
        """Rectangle with round corners."""
        x, y = left_top
        self._draw.rounded_rectangle(
            [v * _SUPERSAMPLING for v in (x, y, x + width, y + height)],
            radius=min(8.0, height / 2, width / 2) * _SUPERSAMPLING,
            fill=fill,
            outline=outline,
            width=round(1.2 * _SUPERSAMPLING),
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


def _box(centre: Point, half_width: float, half_height: float) -> list[float]:
    x, y = centre
    corners = (x - half_width, y - half_height, x + half_width, y + half_height)
    return [v * _SUPERSAMPLING for v in corners]


def _bezier(controls: NDArray[np.float64]) -> list[Point]:
    """Points of a Bézier curve by de Casteljau's scheme."""
    t = np.linspace(0, 1, 33)[:, None, None]
    points = np.broadcast_to(controls, (33, *controls.shape))
    while points.shape[1] > 1:
        points = (1 - t) * points[:, :-1] + t * points[:, 1:]
    return [(float(x), float(y)) for x, y in points[:, 0]]
