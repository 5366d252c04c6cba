"""A sheet that can also hold trees and graphs: discs, ellipses and curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.report.canvas import SUPERSAMPLING, WHITE, Canvas, Colour, Point
from shapeconcepts.report.lettering import TITLE_COLOUR


class Diagram(Canvas):
    """A canvas with what trees and graphs are drawn of."""

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
            _box(centre, radius, radius), fill=fill, outline=outline, width=round(1.5 * SUPERSAMPLING)
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


def _box(centre: Point, half_width: float, half_height: float) -> list[float]:
    x, y = centre
    corners = (x - half_width, y - half_height, x + half_width, y + half_height)
    return [v * SUPERSAMPLING for v in corners]


def _bezier(controls: NDArray[np.float64]) -> list[Point]:
    """Points of a Bézier curve by de Casteljau's scheme."""
    t = np.linspace(0, 1, 33)[:, None, None]
    points = np.broadcast_to(controls, (33, *controls.shape))
    while points.shape[1] > 1:
        points = (1 - t) * points[:, :-1] + t * points[:, 1:]
    return [(float(x), float(y)) for x, y in points[:, 0]]
