"""Picture of the motifs that an object fired and of the training objects that they remind of."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

from PIL import Image

from shapeconcepts.motifs.explanation import Explanation, FiredMotif, SimilarPrototype
from shapeconcepts.report.canvas import WHITE, Canvas, Colour, blend
from shapeconcepts.report.highlighting import draw_highlighted
from shapeconcepts.report.lettering import NOTE_COLOUR
from shapeconcepts.segmentation.segmented_object import SegmentedObject

_MARGIN = 24
_TITLE = 84
_THUMB = 128
_ROW = 168
_TEXT = 250
_GAP = 16
_RULE: Colour = (0xE3, 0xE6, 0xEA)
_OWN: Colour = (0xE0, 0x86, 0x34)
_SEEN: Colour = (0x35, 0x68, 0xDB)


def draw_explanation(
    explanation: Explanation,
    segmented: SegmentedObject,
    training_objects: Sequence[SegmentedObject] | None = None,
    path: str | PathLike[str] | None = None,
    *,
    n_motifs: int = 6,
    n_prototypes: int = 5,
) -> Image.Image:
    """Draw the strongest motifs of an object, each beside the prototypes that it resembles most.

    A row shows the object with a constellation in orange, its motif and its stimulus, and training objects
    with the constellation behind the prototype in blue. A constellation that fires in several hierarchies
    has one row, at the dictionary level where its stimulus is largest; the other levels are named there. Of
    the stimuli of single prototypes the largest is shown, and the motif shared with its prototype.

    Parameters
    ----------
    explanation : Explanation
        From `MotifHierarchyEnsemble.explain`.
    segmented : SegmentedObject
        The object that was explained.
    training_objects : sequence of SegmentedObject, optional
        The objects that the ensemble has seen, in that order. Where one is missing, its name stands alone.
    path : path, optional
        Where to save the picture; the ending chooses the format (`.png`, `.jpg`, `.webp`).
    n_motifs : int
        Largest number of rows, from 1.
    n_prototypes : int
        Largest number of prototypes in a row, 0 to 5.

    Returns
    -------
    PIL.Image.Image
        RGB picture on white.

    Raises
    ------
    ValueError
        If a number is out of range, `segmented` is not the explained object, or the training objects come in
        another order than the ensemble saw them.
    """
    if n_motifs < 1:
        raise ValueError(f"n_motifs must be at least 1, got {n_motifs!r}")
    if not 0 <= n_prototypes <= 5:
        raise ValueError(f"n_prototypes must be between 0 and 5, got {n_prototypes!r}")
    groups = _by_constellation(explanation)
    rows = groups[:n_motifs]
    needed = max((max(motif.segments) + 1 for motif in explanation.motifs), default=0)
    if segmented.n_segments < needed:
        raise ValueError(
            f"segmented must be the explained object, with at least {needed} segments, "
            f"got {segmented.n_segments}"
        )

    first_prototype = _MARGIN + _THUMB + _GAP + _TEXT + _GAP
    width = first_prototype + max(n_prototypes, 3) * (_THUMB + _GAP) + _MARGIN
    canvas = Canvas(width, _TITLE + max(len(rows), 1) * _ROW + _MARGIN)
    title = canvas.text((_MARGIN, 32), segmented.name or "object", 22, width=0.5 * width)
    if not rows:
        canvas.picture(draw_highlighted(segmented, {}, size=_THUMB), (_MARGIN, _TITLE))
        x, y = _MARGIN + _THUMB + _GAP, _TITLE + _THUMB / 2
        nothing = "Nothing like it was seen" if _is_by_prototypes(explanation) else "No motif fired"
        canvas.text((x, y - 12), nothing, 18)
        canvas.text((x, y + 14), _reason(explanation), 14, NOTE_COLOUR)
        return canvas.finish(path)
    canvas.text((_MARGIN + title + 20, 34), _summary(explanation, len(groups), len(rows)), 14, NOTE_COLOUR)

    canvas.text((_MARGIN + _THUMB / 2, _TITLE - 14), "this object", 13, _OWN, anchor="mm")
    if n_prototypes:
        canvas.text((first_prototype, _TITLE - 14), "closest prototypes, with their divergence", 13, _SEEN)
    for row, group in enumerate(rows):
        top = float(_TITLE + row * _ROW)
        canvas.line([(_MARGIN, top), (width - _MARGIN, top)], _RULE)
        colour_of = dict.fromkeys(group[0].segments, _OWN)
        canvas.picture(draw_highlighted(segmented, colour_of, size=_THUMB), (_MARGIN, top + 18))
        _describe_motif(canvas, (_MARGIN + _THUMB + _GAP, top + 30), group, explanation)
        for position, prototype in enumerate(group[0].closest[:n_prototypes]):
            left = first_prototype + position * (_THUMB + _GAP)
            _draw_prototype(canvas, (left, top + 8), prototype, training_objects)
    return canvas.finish(path)


def _is_by_prototypes(explanation: Explanation) -> bool:
    return explanation.columns == "prototypes"


def _by_constellation(explanation: Explanation) -> list[list[FiredMotif]]:
    """Motifs of the same segments together, the strongest first."""
    groups: dict[tuple[int, ...], list[FiredMotif]] = {}
    for motif in explanation.motifs:
        groups.setdefault(motif.segments, []).append(motif)
    return list(groups.values())


def _summary(explanation: Explanation, n_fired: int, n_shown: int) -> str:
    total = explanation.n_constellations
    shown = f"; the {n_shown} strongest" if n_shown < n_fired else ""
    if _is_by_prototypes(explanation):
        if total == 1:
            return "its only constellation reminds of training objects"
        return f"{n_fired} of its {total:,} constellations remind of training objects{shown}"
    constellations = "its only constellation" if total == 1 else f"{n_fired} of its {total:,} constellations"
    count = len(explanation.motifs)
    return f"{count:,} motif{'s' if count != 1 else ''} fired, by {constellations}{shown}"


def _reason(explanation: Explanation) -> str:
    if _is_by_prototypes(explanation):
        return "None of its constellations is near enough to one of the training objects."
    if min(explanation.n_unknown) == explanation.n_constellations:
        return "None of its constellations has a motif that was seen in enough training objects."
    return "It has motifs that were seen in training, but their prototypes look quite different."


def _describe_motif(
    canvas: Canvas, at: tuple[float, float], group: list[FiredMotif], explanation: Explanation
) -> None:
    """Stimulus as a number and a bar, name, and what stands behind it."""
    motif = group[0]
    x, y = at
    canvas.text((x, y), f"{motif.stimulus:.2f}" if motif.stimulus >= 0.01 else f"{motif.stimulus:.0e}", 22)
    bar = _TEXT - 66
    canvas.box((x + 60, y - 6), bar, 12, blend(_OWN, WHITE, 0.82))
    canvas.box((x + 60, y - 6), max(bar * motif.stimulus, 3.0), 12, _OWN)
    canvas.text((x, y + 28), motif.name if motif.words else "no words in common", 15, width=_TEXT)
    lines = _notes_on_prototypes(motif) if _is_by_prototypes(explanation) else _notes_on_motif(group)
    for number, line in enumerate(lines):
        canvas.text((x, y + 52 + 19 * number), line, 13, NOTE_COLOUR, width=_TEXT)


def _notes_on_motif(group: list[FiredMotif]) -> list[str]:
    motif = group[0]
    lines = [
        f"dictionary level {motif.dictionary_level}, motif level {motif.motif_level}",
        "1 prototype" if motif.n_prototypes == 1 else f"{motif.n_prototypes:,} prototypes",
    ]
    others = sorted(other.dictionary_level for other in group[1:])
    if others:
        levels = "level" if len(others) == 1 else "levels"
        lines.append(f"also at dictionary {levels} {', '.join(map(str, others))}")
    return lines


def _notes_on_prototypes(motif: FiredMotif) -> list[str]:
    shared = [f"shared at dictionary level {motif.dictionary_level}"] if motif.words else []
    reminded = "1 prototype" if motif.n_prototypes == 1 else f"{motif.n_prototypes:,} prototypes"
    return [*shared, f"motif level {motif.motif_level}", f"reminds of {reminded}"]


def _draw_prototype(
    canvas: Canvas,
    left_top: tuple[float, float],
    prototype: SimilarPrototype,
    training_objects: Sequence[SegmentedObject] | None,
) -> None:
    x, y = left_top
    seen = None
    if training_objects is not None and prototype.object_index < len(training_objects):
        seen = training_objects[prototype.object_index]
        if seen.name != prototype.object_name or seen.n_segments <= max(prototype.segments):
            raise ValueError(
                f"training_objects[{prototype.object_index}] must be {prototype.object_name!r}, as the "
                f"ensemble has seen it, got {seen.name!r}"
            )
        colour_of = dict.fromkeys(prototype.segments, _SEEN)
        canvas.picture(draw_highlighted(seen, colour_of, size=_THUMB - 14), (x + 7, y))
    else:
        canvas.box((x + 7, y + 7), _THUMB - 14, _THUMB - 28, (0xF5, 0xF6, 0xF8))
        canvas.text((x + _THUMB / 2, y + 57), "no scan", 12, NOTE_COLOUR, anchor="mm")
    name = prototype.object_name or f"object {prototype.object_index}"
    canvas.text((x + _THUMB / 2, y + _THUMB - 4), name, 13, anchor="mm", width=_THUMB)
    like_it = f", {prototype.count - 1:,} like it" if prototype.count > 1 else ""
    note = f"{prototype.divergence:.3f}{like_it}"
    canvas.text((x + _THUMB / 2, y + _THUMB + 14), note, 12, NOTE_COLOUR, anchor="mm", width=_THUMB)
