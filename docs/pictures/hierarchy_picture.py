"""Picture of a motif hierarchy with the propagation of one object (paper: figure 3a)."""

from __future__ import annotations

from math import cos, pi, sin
from os import PathLike

import numpy as np
from PIL import Image

from pictures.diagram import Diagram
from pictures.hierarchy_excerpt import HierarchyExcerpt, Pair, excerpt_of
from pictures.hierarchy_layout import vertex_places
from pictures.word_colours import word_colours
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.motifs.ensemble import MotifHierarchyEnsemble
from shapeconcepts.motifs.hierarchy import MotifHierarchies
from shapeconcepts.report.canvas import WHITE, Colour, Point, blend
from shapeconcepts.report.highlighting import draw_highlighted
from shapeconcepts.report.lettering import NOTE_COLOUR
from shapeconcepts.segmentation.segmented_object import SegmentedObject

_MARGIN = 24
_TITLE = 56
_PLATE = (470.0, 84.0)
_ROW = 196
_LABELS = 122
_PANEL = 300
_LOWEST = 740
_RADIUS = 16.0
_WIDTH = 2.2
_WIDTH_AMONG_MANY = 0.8
_MANY = 100
_MOST_DOTS = 16
_PALE = 0.62

_PLATE_COLOUR: Colour = (0xF5, 0xF6, 0xF8)
_PALE_LINE: Colour = (0xDD, 0xE0, 0xE5)
_STEP: Colour = (0xC2, 0x25, 0x4C)
_LINK: Colour = (0x2F, 0x38, 0x46)


def draw_hierarchy(
    ensemble: MotifHierarchyEnsemble,
    segmented: SegmentedObject,
    dictionary_level: int,
    path: str | PathLike[str] | None = None,
    *,
    descriptor: str | Descriptor = "surflet+fpfh+curvature",
    n_vertices: int = 18,
) -> Image.Image:
    """Draw one hierarchy of an ensemble, and the way of an object through it.

    Motif levels are stacked from bottom to top. A disc is a motif vertex, its slices are the words of the
    motif in the colours of `draw_dictionary`, the dots around it its prototypes (at most 16). What the object
    activates is drawn strongly, with the stimulus; the rest of the hierarchy is pale. Lines within a level
    are links, lines between levels lead from two motifs to their union.

    Parameters
    ----------
    ensemble : MotifHierarchyEnsemble
        Fitted.
    segmented : SegmentedObject
        Any object, from training or not.
    dictionary_level : int
        Which of the hierarchies, from 1.
    path : path, optional
        Where to save the picture; the ending chooses the format (`.png`, `.jpg`, `.webp`).
    descriptor : str or Descriptor
        A name as of `get_descriptor`.
        What the training objects were described by.
    n_vertices : int
        Largest number of vertices drawn at each motif level, 1 to 30: the activated ones, the strongest
        first, then those seen in most training objects. How many there are is written beside.

    Returns
    -------
    PIL.Image.Image
        RGB picture on white, 1434 pixels wide.

    Raises
    ------
    ValueError
        If there is no such dictionary level, `n_vertices` is out of range, or the descriptor gives other
        histograms than those that were learned from.
    """
    n_levels = ensemble.hierarchies_.n_levels
    if not 1 <= dictionary_level <= n_levels:
        raise ValueError(f"dictionary_level must be between 1 and {n_levels}, got {dictionary_level!r}")
    if not 1 <= n_vertices <= 30:
        raise ValueError(f"n_vertices must be between 1 and 30, got {n_vertices!r}")
    excerpt = excerpt_of(ensemble, segmented, dictionary_level, n_vertices, descriptor=descriptor)
    colours = word_colours(ensemble.dictionary_)[dictionary_level - 1]
    motifs = {vertex: ensemble.hierarchies_.motif(vertex) for row in excerpt.rows for vertex in row}
    n_prototypes = np.diff(ensemble.hierarchies_.prototypes_of.starts)

    n_rows = len(excerpt.rows)
    height = max(_TITLE + n_rows * _ROW + _MARGIN, _LOWEST)
    canvas = Diagram(_LABELS + 2 * _PLATE[0] + _PANEL + 3 * _MARGIN, height)
    lowest = (height + _TITLE - _MARGIN + (n_rows - 1) * _ROW) / 2
    centres = [(_MARGIN + _LABELS + _PLATE[0], lowest - row * _ROW) for row in range(n_rows)]
    place = vertex_places(excerpt, centres)
    middle_of = {
        vertex: centre[1] for row, centre in zip(excerpt.rows, centres, strict=True) for vertex in row
    }

    def draw_link(link: Pair, colour: Colour, width: float) -> None:
        _draw_link(canvas, place[link[0]], place[link[1]], middle_of[link[0]], colour, width)

    _draw_title(canvas, ensemble.hierarchies_, dictionary_level)
    for level, centre in enumerate(centres):
        canvas.ellipse(centre, *_PLATE, fill=_PLATE_COLOUR)
        _draw_level_label(canvas, excerpt, level, (_MARGIN, centre[1]))
    for lower, upper in sorted(excerpt.steps - excerpt.own_steps):
        canvas.line([place[lower], place[upper]], _PALE_LINE, 1.0)
    for link in sorted(excerpt.links - excerpt.own_links):
        draw_link(link, _PALE_LINE, 1.0)
    width = _WIDTH_AMONG_MANY if len(excerpt.own_steps | excerpt.own_links) > _MANY else _WIDTH
    for lower, upper in sorted(excerpt.own_steps):
        canvas.line([place[lower], place[upper]], _STEP, width)
    for link in sorted(excerpt.own_links):
        draw_link(link, _LINK, width)
    # Pale ones first, and what is in front of a plate after what is behind.
    for vertex in sorted(place, key=lambda v: (v in excerpt.activated, place[v][1])):
        is_own = vertex in excerpt.activated
        slices = [colours[word] if is_own else blend(colours[word], WHITE, _PALE) for word in motifs[vertex]]
        _draw_vertex(canvas, place[vertex], slices, int(n_prototypes[vertex]), is_own)
        if vertex in excerpt.stimulus_of:
            x, y = place[vertex]
            canvas.box((x + 18, y + 13), 30, 16, WHITE)
            canvas.text((x + 33, y + 21), f"{excerpt.stimulus_of[vertex]:.2f}", 12, anchor="mm")
    _draw_panel(canvas, segmented, excerpt, colours, _MARGIN * 2 + _LABELS + 2 * _PLATE[0])
    return canvas.finish(path)


def _draw_link(
    canvas: Diagram, start: Point, end: Point, middle: float, colour: Colour, width: float
) -> None:
    """Link on the plate whose middle is at the height `middle`."""
    if start == end:
        canvas.disc((start[0] + 0.9 * _RADIUS, start[1] - 0.9 * _RADIUS), 0.55 * _RADIUS, None, colour)
        return
    # A straight line along the front of a ring would run behind the vertices between its ends.
    bend = 1.4 * min(1.0, abs(start[0] - end[0]) / 200)
    y = (start[1] + end[1]) / 2
    canvas.curve(start, ((start[0] + end[0]) / 2, y + bend * (middle - y)), end, colour, width)


def _draw_vertex(canvas: Diagram, at: Point, slices: list[Colour], n_prototypes: int, is_own: bool) -> None:
    dot = (0x5A, 0x63, 0x70) if is_own else (0xC9, 0xCE, 0xD5)
    for k in range(min(n_prototypes, _MOST_DOTS)):
        angle = 2 * pi * k / min(n_prototypes, _MOST_DOTS) - pi / 2
        canvas.disc((at[0] + (_RADIUS + 5) * cos(angle), at[1] + (_RADIUS + 5) * sin(angle)), 2.0, dot)
    canvas.disc(at, _RADIUS + 1.5, _LINK if is_own else WHITE)
    canvas.disc(at, _RADIUS, WHITE)
    canvas.pie(at, _RADIUS - 0.5, slices)


def _draw_title(canvas: Diagram, known: MotifHierarchies, dictionary_level: int) -> None:
    count = int((known.dictionary_levels == dictionary_level).sum())
    vertices = "1 motif vertex" if count == 1 else f"{count:,} motif vertices"
    prototypes = "1 prototype" if len(known.prototypes) == 1 else f"{len(known.prototypes):,} prototypes"
    objects = "1 training object" if known.n_objects == 1 else f"{known.n_objects:,} training objects"
    title = f"Motif hierarchy of dictionary level {dictionary_level}"
    width = canvas.text((_MARGIN, 32), title, 22)
    canvas.text((_MARGIN + width + 20, 34), f"{vertices} with {prototypes} of {objects}", 14, NOTE_COLOUR)


def _draw_level_label(canvas: Diagram, excerpt: HierarchyExcerpt, level: int, at: Point) -> None:
    row, total = excerpt.rows[level], excerpt.n_vertices[level]
    n_own = excerpt.n_activated[level]
    canvas.text((at[0], at[1] - 18), f"motif level {level + 1}", 16)
    canvas.text((at[0], at[1] + 2), f"{n_own:,} activated", 13, _STEP if n_own else NOTE_COLOUR)
    if len(row) < total:
        canvas.text((at[0], at[1] + 20), f"{len(row)} of {total:,} shown", 13, NOTE_COLOUR)
    else:
        canvas.text((at[0], at[1] + 20), "1 vertex" if total == 1 else f"{total} vertices", 13, NOTE_COLOUR)


def _draw_panel(
    canvas: Diagram, segmented: SegmentedObject, excerpt: HierarchyExcerpt, colours: list[Colour], left: float
) -> None:
    """The object in the colours of its words, what is not in the picture, and what the marks mean."""
    colour_of = {segment: colours[word] for segment, word in enumerate(excerpt.segment_words.tolist())}
    y = float(_TITLE)
    canvas.picture(draw_highlighted(segmented, colour_of, size=_PANEL - 20), (left + 10, y))
    y += _PANEL
    middle = left + _PANEL / 2
    canvas.text((middle, y), segmented.name or "object", 17, anchor="mm", width=_PANEL)
    y += 30
    words = sorted(set(excerpt.segment_words.tolist()))
    for position, word in enumerate(words):
        row, column = divmod(position, 8)
        n_in_row = min(8, len(words) - 8 * row)
        canvas.word((middle + (column - (n_in_row - 1) / 2) * 34, y + 34 * row), 13, word, colours[word])
    y += 34 * ((len(words) + 7) // 8) + 6
    n_known = excerpt.n_constellations - excerpt.n_unknown
    constellations = "constellation has" if excerpt.n_constellations == 1 else "constellations have"
    lines = [f"{n_known:,} of its {excerpt.n_constellations:,} {constellations} a known motif"]
    n_silent = len(excerpt.activated - excerpt.stimulus_of.keys())
    if n_silent:
        motifs = "activated motif has" if n_silent == 1 else "activated motifs have"
        lines += [
            f"{n_silent:,} {motifs} no stimulus: seen in too",
            "few objects, or too unlike its prototypes",
        ]
    if excerpt.n_above:
        vertices = "vertex is" if excerpt.n_above == 1 else "vertices are"
        lines.append(f"{excerpt.n_above} {vertices} at higher motif levels")
    for line in lines:
        canvas.text((middle, y), line, 12, NOTE_COLOUR, anchor="mm", width=_PANEL)
        y += 18
    _draw_legend(canvas, (left + 34, max(y + 24, canvas.size[1] - 210.0)), colours[:2])


def _draw_legend(canvas: Diagram, at: Point, slices: list[Colour]) -> None:
    x, y = at
    text = x + 40
    _draw_vertex(canvas, (x, y), slices, 6, True)
    canvas.text((text, y - 8), "activated motif: slices are words,", 13)
    canvas.text((text, y + 8), "dots prototypes, number stimulus", 13)
    _draw_vertex(canvas, (x, y + 52), [blend(colour, WHITE, _PALE) for colour in slices], 6, False)
    canvas.text((text, y + 52), "motif of other objects", 13)
    canvas.line([(x - 22, y + 90), (x + 22, y + 90)], _STEP, _WIDTH)
    canvas.text((text, y + 90), "propagation: two motifs make one", 13)
    canvas.line([(x - 22, y + 116), (x + 22, y + 116)], _LINK, _WIDTH)
    canvas.text((text, y + 116), "link: neighbours, or a shared segment", 13)
