"""Colours of segments and labels, told apart by colour-blind readers too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Found by maximising the smallest CIELAB distance between any two, over normal vision and simulated
# protanopia and deuteranopia (Machado et al. 2009); the smallest distance is 28.
SEGMENT_COLOURS: NDArray[np.uint8] = np.array(
    [
        (0x35, 0x68, 0xDB),
        (0xE0, 0x86, 0x34),
        (0x30, 0x9F, 0x97),
        (0xB3, 0x29, 0x4F),
        (0xF7, 0xD4, 0x22),
        (0x6B, 0x5A, 0x9A),
        (0x5D, 0xAD, 0xFA),
        (0x7E, 0xE9, 0xC4),
        (0x9C, 0x2F, 0x0A),
        (0x8A, 0xDE, 0xFA),
        (0x27, 0xF5, 0x88),
        (0x19, 0x34, 0xF1),
    ],
    dtype=np.uint8,
)

# Okabe and Ito's, and what lies farthest from those in CIELAB under normal and simulated red- and green-blind
# vision. Pages (html_page/templates/colours.js) have the same.
LABEL_COLOURS: NDArray[np.uint8] = np.array(
    [
        (0x00, 0x72, 0xB2),
        (0xE6, 0x9F, 0x00),
        (0x00, 0x9E, 0x73),
        (0xCC, 0x79, 0xA7),
        (0x56, 0xB4, 0xE9),
        (0xD5, 0x5E, 0x00),
        (0x55, 0x44, 0x00),
        (0xBB, 0xCC, 0x66),
        (0xEE, 0x11, 0x55),
        (0x11, 0x22, 0x99),
        (0xFF, 0xBB, 0x99),
        (0x99, 0x00, 0x88),
        (0x66, 0x22, 0x22),
        (0x88, 0xCC, 0xB0),
        (0x77, 0x00, 0xCC),
        (0x7F, 0x87, 0x94),
        (0x66, 0x00, 0x44),
        (0xAA, 0x66, 0xFF),
        (0x99, 0xDD, 0xEE),
        (0x00, 0x00, 0xFF),
        (0xDD, 0xDD, 0x55),
        (0x88, 0x44, 0x66),
        (0x00, 0x77, 0x33),
        (0xFF, 0x22, 0x44),
    ],
    dtype=np.uint8,
)

NO_SEGMENT_COLOUR: NDArray[np.uint8] = np.array((0xD5, 0xD7, 0xDB), dtype=np.uint8)


def colours_of(
    labels: NDArray[np.integer], colours: NDArray[np.uint8] = SEGMENT_COLOURS
) -> NDArray[np.uint8]:
    """Colour of each label.

    Parameters
    ----------
    labels : (n,) int
        Labels from 0; the colours repeat after the last. A negative label is "none", light grey.
    colours : (k, 3) uint8
        Colours of the labels from 0; by default the twelve of segments.

    Returns
    -------
    (n, 3) uint8
        Red, green and blue.
    """
    labels = np.asarray(labels)
    return np.where(
        labels[..., None] < 0,
        NO_SEGMENT_COLOUR,
        colours[np.maximum(labels, 0) % len(colours)],
    )


def hexadecimal_segment_colours() -> list[str]:
    """Colours of segments as a page takes them, and last that of what is in none."""
    colours = [*SEGMENT_COLOURS.tolist(), np.asarray(NO_SEGMENT_COLOUR).tolist()]
    return ["#" + "".join(f"{channel:02x}" for channel in colour) for colour in colours]
