"""Where the vertices of a motif hierarchy stand in its picture."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from pictures.hierarchy_excerpt import HierarchyExcerpt, Pair
from shapeconcepts.report.canvas import Point

RING = (430.0, 54.0)
_SPACING = 84.0
_MOST_INNER_SHARE = 0.6
_INNER_HEIGHT_SHARE = 0.85


def vertex_places(excerpt: HierarchyExcerpt, centres: list[Point]) -> dict[int, Point]:
    """Activated vertices in the middle of each motif level, the others at its sides.

    So nothing stands where the object's own lines rise. On each level the order follows the neighbours one
    level below and above, which keeps the lines from crossing more than they must.

    Parameters
    ----------
    excerpt : HierarchyExcerpt
    centres : list of (x, y)
        Middle of each motif level's plate.
    """
    own_rows = [[vertex for vertex in row if vertex in excerpt.activated] for row in excerpt.rows]
    other_rows = [row[len(own) :] for row, own in zip(excerpt.rows, own_rows, strict=True)]
    gap = max(_inner_half_width(len(own)) for own in own_rows) + _SPACING / 2
    place: dict[int, Point] = {}
    for own, others, centre in zip(own_rows, other_rows, centres, strict=True):
        place.update(zip(sorted(own), sorted(_inner_slots(len(own), centre)), strict=True))
        place.update(zip(sorted(others), sorted(_outer_slots(len(others), centre, gap)), strict=True))

    levels = range(len(centres))
    for own_neighbours, neighbours, order in (
        (_targets(excerpt.own_steps, up=False), _targets(excerpt.steps, up=False), levels),
        (_targets(excerpt.own_steps, up=True), _targets(excerpt.steps, up=True), levels[::-1]),
        (_targets(excerpt.own_steps, up=False), _targets(excerpt.steps, up=False), levels),
    ):
        for level in order:
            _sort_by_neighbours(own_rows[level], own_neighbours, place)
            _sort_by_neighbours(other_rows[level], neighbours, place)
    return place


def _targets(steps: set[Pair], *, up: bool) -> dict[int, list[int]]:
    targets: dict[int, list[int]] = {}
    for lower, upper in sorted(steps):
        source, target = (lower, upper) if up else (upper, lower)
        targets.setdefault(source, []).append(target)
    return targets


def _sort_by_neighbours(
    vertices: list[int], neighbours: dict[int, list[int]], place: dict[int, Point]
) -> None:
    """Exchange the places of vertices, so that each is as near below its neighbours as it can."""

    def wanted(vertex: int) -> tuple[float, float]:
        x_of_neighbours = [place[other][0] for other in neighbours.get(vertex, [vertex])]
        return float(np.mean(x_of_neighbours)), place[vertex][0]

    slots = sorted(place[vertex] for vertex in vertices)
    place.update(zip(sorted(vertices, key=wanted), slots, strict=True))


def _inner_half_width(n_slots: int) -> float:
    return 0.0 if n_slots < 2 else min(0.27 * n_slots * _SPACING, _MOST_INNER_SHARE * RING[0])


def _inner_slots(n_slots: int, centre: Point) -> list[Point]:
    """One in the centre, two side by side, more on a ring that grows with their number."""
    half_width = _inner_half_width(n_slots)
    if n_slots == 1:
        return [centre]
    if n_slots == 2:
        return [(centre[0] - half_width, centre[1]), (centre[0] + half_width, centre[1])]
    return _on_ellipse(n_slots, centre, (half_width, _INNER_HEIGHT_SHARE * RING[1]), (0.0, 2 * pi))


def _outer_slots(n_slots: int, centre: Point, gap: float) -> list[Point]:
    """Half on the right and half on the left of an ellipse, farther than `gap` from its middle."""
    start = float(np.arcsin(gap / RING[0]))
    n_left = n_slots // 2
    right = _on_ellipse(n_slots - n_left, centre, RING, (start, pi - start))
    left = _on_ellipse(n_left, centre, RING, (pi + start, 2 * pi - start))
    return right + left


def _on_ellipse(
    n_slots: int, centre: Point, axes: tuple[float, float], arc: tuple[float, float]
) -> list[Point]:
    """Points at equal distances along an arc, whose angles count from the front."""
    angles = np.linspace(*arc, 721)
    x, y = axes[0] * np.sin(angles), axes[1] * np.cos(angles)
    along = np.concatenate([[0.0], np.hypot(np.diff(x), np.diff(y)).cumsum()])
    # A whole ring has a point in front; an arc none at its ends.
    shift = 0.0 if arc[1] - arc[0] == 2 * pi else 0.5
    at = np.interp((np.arange(n_slots) + shift) / max(n_slots, 1) * along[-1], along, angles)
    return [(centre[0] + axes[0] * sin(angle), centre[1] + axes[1] * cos(angle)) for angle in at]
