"""Picture of a hierarchical dictionary (paper: figure 2b)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from os import PathLike

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pictures.diagram import Diagram
from pictures.word_colours import word_colours
from pictures.word_examples import Example, word_examples
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.report.canvas import WHITE, Colour, Point, blend
from shapeconcepts.report.highlighting import draw_highlighted
from shapeconcepts.report.lettering import NOTE_COLOUR, font_of
from shapeconcepts.segmentation.segmented_object import SegmentedObject

MOST_LEVELS = 5

_THUMB = 76
_PADDING = 8
_GAP = 14
_HEADER = 34
_DISC = 12
_NARROWEST_CARD = 128
_ROW_GAP = 40
_MARGIN = 20
_LABELS = 94
_ROOT = (220, 30)
_MOST_WORDS_TWO_ABREAST = 8


def draw_dictionary(
    dictionary: SegmentDictionary,
    objects: Sequence[SegmentedObject] | None = None,
    path: str | PathLike[str] | None = None,
    *,
    descriptor: str | Descriptor = "surflet+fpfh+curvature",
    n_levels: int = 3,
    n_examples: int = 4,
) -> Image.Image:
    """Draw a dictionary as a tree of words, each with the training segments that are most like it.

    Parameters
    ----------
    dictionary : SegmentDictionary
        Fitted.
    objects : sequence of SegmentedObject, optional
        The objects that it was learned from, in the same order. Without them the tree has no examples.
    path : path, optional
        Where to save the picture; the ending chooses the format (`.png`, `.jpg`, `.webp`).
    descriptor : str or Descriptor
        A name as of `get_descriptor`.
        What the segments were described by.
    n_levels : int
        Number of dictionary levels to draw, 1 to 5, from the first; not more than there are.
    n_examples : int
        Largest number of example segments at each word, from 1.

    Returns
    -------
    PIL.Image.Image
        RGB picture on white. The deepest level decides its width: 140 to 180 pixels a word.

    Raises
    ------
    ValueError
        If a number is out of range, or the objects are not those that the dictionary was learned from.
    """
    if not 1 <= n_levels <= MOST_LEVELS:
        raise ValueError(f"n_levels must be between 1 and {MOST_LEVELS}, got {n_levels!r}")
    if n_examples < 1:
        raise ValueError(f"n_examples must be at least 1, got {n_examples!r}")
    n_levels = min(n_levels, len(dictionary.words_))
    parents = dictionary.parents_[:n_levels]
    examples: list[list[list[Example]]] = [[[] for _ in of_level] for of_level in parents]
    if objects is not None:
        examples = word_examples(dictionary, objects, descriptor, n_levels, n_examples)
    tree = _tree(parents, examples)
    canvas = Diagram(tree.width, tree.tops[-1] + tree.heights[-1] + _MARGIN)

    root = (float(tree.centres[0].mean()), float(_MARGIN + _ROOT[1]))
    colours = word_colours(dictionary)[:n_levels]
    for level in range(n_levels):
        for word, parent in enumerate(parents[level]):
            start = root if level == 0 else tree.bottom(level - 1, parent)
            canvas.branch(start, tree.top(level, word), blend(colours[level][word], WHITE, 0.25), 2.5)
    _draw_root(canvas, root, len(dictionary.clusters_), None if objects is None else len(objects))
    for level in range(n_levels):
        _draw_level_label(canvas, tree.tops[level], level + 1, len(parents[level]))
        for word, colour in enumerate(colours[level]):
            x, y = tree.top(level, word)
            n_abreast = min(len(examples[level][word]), tree.capacities[level][word])
            width = _card_width(n_abreast)
            canvas.box((x - width / 2, y), width, tree.heights[level], WHITE, blend(colour, WHITE, 0.35))
            n_members = len(dictionary.members(level + 1, word))
            _draw_header(canvas, (x, y + _HEADER / 2), word, n_members, colour)
            if objects is not None:
                pictures = [
                    draw_highlighted(objects[index], {segment: colour}, size=_THUMB)
                    for index, segment in examples[level][word]
                ]
                _draw_examples(canvas, (x, y + _HEADER), pictures, n_abreast)
    return canvas.finish(path)


@dataclass(frozen=True)
class _Tree:
    """Where the cards of the words stand: one list for each level."""

    width: float
    tops: list[float]
    heights: list[float]
    centres: list[NDArray[np.float64]]
    capacities: list[list[int]]  # examples that fit side by side above the columns of a word

    def top(self, level: int, word: int) -> Point:
        return float(self.centres[level][word]), self.tops[level]

    def bottom(self, level: int, word: int) -> Point:
        return float(self.centres[level][word]), self.tops[level] + self.heights[level]


def _tree(parents: Sequence[NDArray[np.int32]], examples: list[list[list[Example]]]) -> _Tree:
    """Each word of the deepest level has a column; the others stand above the middle of their children."""
    n_columns = len(parents[-1])
    n_abreast = 2 if n_columns <= _MOST_WORDS_TWO_ABREAST else 1
    has_examples = any(of_word for of_level in examples for of_word in of_level)
    column = _card_width(n_abreast if has_examples else 0) + _GAP
    width = max(_LABELS + n_columns * column - _GAP + _MARGIN, _LABELS + _ROOT[0] + _MARGIN)
    left = _LABELS + (width - _LABELS - _MARGIN - n_columns * column + _GAP) / 2

    columns = np.arange(n_columns, dtype=np.float64)
    centres: list[NDArray[np.float64]] = [left + columns * column + (column - _GAP) / 2]
    capacities = [[n_abreast] * n_columns]
    for of_level in parents[:0:-1]:
        children = [np.flatnonzero(of_level == word) for word in range(int(of_level.max()) + 1)]
        centres.insert(0, np.array([centres[0][one].mean() for one in children]))
        capacities.insert(0, [sum(capacities[0][child] for child in one) for one in children])

    tops, heights = [float(_MARGIN + _ROOT[1] + _ROW_GAP)], []
    for level, fits in enumerate(capacities):
        n_rows = max(ceil(len(one) / fit) for one, fit in zip(examples[level], fits, strict=True))
        heights.append(float(_HEADER + n_rows * _THUMB + (_PADDING if n_rows else 0)))
        tops.append(tops[-1] + heights[-1] + _ROW_GAP)
    return _Tree(width, tops[:-1], heights, centres, capacities)


def _card_width(n_abreast: int) -> float:
    return max(_NARROWEST_CARD, n_abreast * _THUMB + 2 * _PADDING)


def _draw_root(canvas: Diagram, bottom: Point, n_segments: int, n_objects: int | None) -> None:
    text = "1 segment" if n_segments == 1 else f"{n_segments:,} segments"
    if n_objects is not None:
        text += " of 1 object" if n_objects == 1 else f" of {n_objects:,} objects"
    canvas.box((bottom[0] - _ROOT[0] / 2, bottom[1] - _ROOT[1]), *_ROOT, (0xF1, 0xF3, 0xF5))
    canvas.text((bottom[0], bottom[1] - _ROOT[1] / 2), text, 14, anchor="mm", width=_ROOT[0])


def _draw_level_label(canvas: Diagram, top: float, level: int, n_words: int) -> None:
    canvas.text((_MARGIN, top + 12), f"d{level}", 20)
    canvas.text((_MARGIN, top + 32), "1 word" if n_words == 1 else f"{n_words} words", 12, NOTE_COLOUR)


def _draw_header(canvas: Diagram, centre: Point, word: int, n_members: int, colour: Colour) -> None:
    """Disc with the number of the word, and how many segments lie behind it."""
    text = "1 segment" if n_members == 1 else f"{n_members:,} segments"
    left = centre[0] - (_DISC * 2 + 6 + font_of(13).getlength(text)) / 2
    canvas.word((left + _DISC, centre[1]), _DISC, word, colour)
    canvas.text((left + 2 * _DISC + 6, centre[1]), text, 13)


def _draw_examples(canvas: Diagram, top: Point, pictures: list[Image.Image], n_abreast: int) -> None:
    """Rows of pictures, each row centred."""
    for start in range(0, len(pictures), max(n_abreast, 1)):
        row = pictures[start : start + n_abreast]
        y = top[1] + start // n_abreast * _THUMB
        for position, picture in enumerate(row):
            canvas.picture(picture, (top[0] + (position - len(row) / 2) * _THUMB, y))
