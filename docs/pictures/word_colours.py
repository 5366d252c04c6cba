"""Colours of visual words: alike words have alike hues."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.report.canvas import Colour

_FIRST_HUE = -15.0  # degrees; makes the two words of level 1 orange and blue
_CHROMA = 0.14
_LIGHT, _MIDDLE, _DARK = 0.76, 0.66, 0.57


def word_colours(dictionary: SegmentDictionary) -> list[list[Colour]]:
    """Colour of each word of each level.

    The tree of words is laid around the circle of hues (OKLCH): a word has the middle of its part, its
    children the two halves. The first of two children is light, the second dark, so that neighbours on the
    circle are told apart without hue, too.

    Parameters
    ----------
    dictionary : SegmentDictionary
        Fitted.

    Returns
    -------
    list of list of (red, green, blue)
        From 0 to 255.
    """
    starts, widths = np.zeros(1), np.ones(1)
    colours = []
    for parents in dictionary.parents_:
        n_children = np.bincount(parents, minlength=len(starts))
        # Children of a word follow each other: the distance to the first of them is their rank.
        rank = np.arange(len(parents)) - np.searchsorted(parents, parents)
        widths = widths[parents] / n_children[parents]
        starts = starts[parents] + rank * widths
        lightness = np.where(n_children[parents] == 1, _MIDDLE, np.where(rank == 0, _LIGHT, _DARK))
        colours.append(_oklch_to_rgb(lightness, np.radians(_FIRST_HUE + 360 * (starts + widths / 2))))
    return colours


def _oklch_to_rgb(lightness: NDArray[np.float64], hue: NDArray[np.float64]) -> list[Colour]:
    """sRGB of colours of chroma `_CHROMA` (Ottosson 2020)."""
    lab = np.stack([lightness, _CHROMA * np.cos(hue), _CHROMA * np.sin(hue)], axis=1)
    to_cones = np.array(
        [
            [1, 0.3963377774, 0.2158037573],
            [1, -0.1055613458, -0.0638541728],
            [1, -0.0894841775, -1.2914855480],
        ]
    )
    to_linear = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    linear = np.clip((lab @ to_cones.T) ** 3 @ to_linear.T, 0, 1)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return [(int(r), int(g), int(b)) for r, g, b in np.round(255 * coded)]
