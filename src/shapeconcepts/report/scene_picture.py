"""A picture of a scene, with the objects that were found in it outlined and numbered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from shapeconcepts.extraction import ExtractedObject
from shapeconcepts.extraction.pixel_grid import scene_pixels
from shapeconcepts.report.lettering import font_of
from shapeconcepts.report.palette import colours_of
from shapeconcepts.scene import Scene

_NOTHING = 24
_LIGHT, _DARK = 215.0, 60.0
# How much of its colour an object's surface has.
_TINT = 0.45
_NUMBER_SIZE = 16.0
_MARGIN = 3


def draw_scene(scene: Scene, objects: Sequence[ExtractedObject]) -> Image.Image:
    """Draw a scene as its sensor saw it, shaded by the slope of its surfaces.

    Objects have a colour, an outline and their number; dark is where nothing was measured.

    Parameters
    ----------
    scene : Scene
    objects : sequence of ExtractedObject
        As `extract_objects` gives them.

    Raises
    ------
    ScanError
        If nothing was measured in the scene.
    """
    grid, pixels, _ = scene_pixels(scene)
    shade = _shade(grid.distances)
    image = np.repeat(shade[:, :, None], 3, axis=2)
    numbers = np.full(shade.shape, -1, np.int64)
    for number, found in enumerate(objects):
        numbers.ravel()[pixels[found.indices]] = number
    colours = colours_of(np.arange(len(objects))).astype(np.float64)
    own = numbers >= 0
    image[own] = (1.0 - _TINT) * image[own] + _TINT * colours[numbers[own]]
    is_border = own & _is_border(numbers)
    image[is_border] = colours[numbers[is_border]]
    picture = Image.fromarray(np.clip(image, 0, 255).astype(np.uint8))
    draw, font = ImageDraw.Draw(picture), font_of(_NUMBER_SIZE)
    for number, found in enumerate(objects):
        left, top, right, bottom = found.box
        middle = (left + right) / 2.0, (top + bottom) / 2.0
        box = draw.textbbox(middle, str(number), font=font, anchor="mm")
        draw.rectangle(
            (box[0] - _MARGIN, box[1] - _MARGIN, box[2] + _MARGIN, box[3] + _MARGIN),
            fill=tuple(colours[number].astype(int)),
        )
        draw.text(middle, str(number), fill="white", font=font, anchor="mm")
    return picture


def _shade(distances: NDArray[np.float32]) -> NDArray[np.float64]:
    """Brightness of each pixel, lit from the upper left."""
    filled = np.nan_to_num(distances.astype(np.float64))
    step = max(float(np.nanmedian(distances)) * 0.004, 1e-9)
    down, right = np.gradient(filled) if min(filled.shape) > 1 else (0.0 * filled, 0.0 * filled)
    lit = np.tanh((0.5 * down - 0.7 * right) / step)
    shade = (_LIGHT + _DARK) / 2.0 + lit * (_LIGHT - _DARK) / 2.0
    shade[np.isnan(distances)] = _NOTHING
    return shade


def _is_border(numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Pixels beside one of another number."""
    border = np.zeros(numbers.shape, bool)
    across, along = numbers[:, 1:] != numbers[:, :-1], numbers[1:] != numbers[:-1]
    border[:, 1:] |= across
    border[:, :-1] |= across
    border[1:] |= along
    border[:-1] |= along
    return border
