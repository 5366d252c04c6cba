"""Puts things on tables as people leave them: apart, side by side or stacked, never into one another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.footprint import footprint, gap, is_within, until_contact
from shapeconcepts.simulation.furniture import Table
from shapeconcepts.simulation.shapes import SHAPES
from shapeconcepts.simulation.shapes.flat_things import (
    make_book,
    make_card,
    make_fork,
    make_knife,
    make_ruler,
)
from shapeconcepts.simulation.shapes.mesh import Mesh, moved, rotated
from shapeconcepts.simulation.shapes.tableware import make_bottle, make_bowl, make_mug

THINGS: dict[str, Callable[[np.random.Generator], Mesh]] = {
    **SHAPES,
    "bowl": make_bowl,
    "mug": make_mug,
    "bottle": make_bottle,
    "book": make_book,
    "card": make_card,
    "ruler": make_ruler,
    "knife": make_knife,
    "fork": make_fork,
}
"""Draws a mesh of everything that stands or lies on tables, by category."""

_WITH_FLAT_TOP = ("box", "book", "card")
_APART = 0.02
_FROM_EDGE = 0.01
_HIGHEST = 0.45
# Of the things that touch another one, where one is there to stack them on.
_STACKED = 0.6
# What is stacked may be so much longer than what it stands on.
_OVERHANG = 1.5
# A plate that leans would need something to lean on.
_STEEPEST_PLATE = 0.5
_TRIES = 40
_ON_LAST_TABLE = 0.25


class Thing(NamedTuple):
    """An object in its place.

    Attributes
    ----------
    category : str
    mesh : Mesh
        In the world.
    outline : (k, 2) float64
        Its convex outline from above.
    table : Table
        On which it lies, or the things below it.
    """

    category: str
    mesh: Mesh
    outline: NDArray[np.float64]
    table: Table

    @property
    def bottom(self) -> float:
        """z of its lowest point, metres."""
        return float(self.mesh.vertices[:, 2].min())

    @property
    def top(self) -> float:
        """z of its highest point, metres."""
        return float(self.mesh.vertices[:, 2].max())

    @property
    def height(self) -> float:
        """From its lowest to its highest point, metres."""
        return self.top - self.bottom


def arrange(
    rng: np.random.Generator,
    tables: Sequence[Table],
    n_things: int,
    contact: float,
    spread: float | None,
    is_place: Callable[[Thing], bool],
) -> list[Thing]:
    """Things on tables.

    Parameters
    ----------
    rng : numpy.random.Generator
    tables : sequence of Table
        The first holds most of the things; the others about one in four.
    n_things : int
        How many there are, if there is place for so many.
    contact : float
        Share of the things that are put beside or onto another one, so that they touch.
    spread : float, optional
        Standard deviation of the places on the first table around the origin, metres. None for all over it.
    is_place : callable
        Whether a thing may lie where it is.
    """
    things: list[Thing] = []
    for _ in range(3 * n_things):
        if len(things) == n_things:
            break
        thing = _drawn(rng, tables[-1] if rng.random() < _ON_LAST_TABLE else tables[0])
        touches = len(things) > 0 and rng.random() < contact
        stands = [other for other in things if other.category in _WITH_FLAT_TOP] if touches else []
        is_stacked = len(stands) > 0 and rng.random() < _STACKED
        for _ in range(_TRIES):
            others, place = things, None
            if is_stacked:
                below = stands[rng.integers(len(stands))]
                others = [other for other in things if other is not below]
                place = _onto(rng, thing, below)
            elif touches:
                place = _next_to(rng, thing, things[rng.integers(len(things))])
            else:
                place = _anywhere(rng, thing, spread if thing.table is tables[0] else None)
            apart = 0.0 if touches else _APART
            if place is not None and _fits(place, others, apart) and is_place(place):
                things.append(place)
                break
    return things


def _drawn(rng: np.random.Generator, table: Table) -> Thing:
    """A thing that rests at the height 0, turned about the vertical, its middle over the origin."""
    category = str(rng.choice(list(THINGS)))
    mesh = THINGS[category](rng)
    while category == "plate" and np.ptp(mesh.vertices[:, 2]) > _STEEPEST_PLATE * np.ptp(mesh.vertices[:, 0]):
        mesh = THINGS[category](rng)
    mesh = rotated(mesh, 2, rng.uniform(0.0, 2.0 * np.pi))
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    mesh = moved(mesh, (*-(low + high)[:2] / 2.0, -low[2]))
    return Thing(category, mesh, footprint(mesh.vertices), table)


def _put(thing: Thing, place: NDArray[np.float64], height: float, table: Table) -> Thing:
    return Thing(thing.category, moved(thing.mesh, (*place, height)), thing.outline + place, table)


def _anywhere(rng: np.random.Generator, thing: Thing, spread: float | None) -> Thing:
    table = thing.table
    if spread is None:
        place = rng.uniform(table.outline.min(axis=0), table.outline.max(axis=0))
    else:
        place = rng.normal(0.0, spread, 2)
    return _put(thing, place, table.height, table)


def _next_to(rng: np.random.Generator, thing: Thing, neighbour: Thing) -> Thing:
    turn = rng.uniform(0.0, 2.0 * np.pi)
    place = until_contact(thing.outline, neighbour.outline, np.array([np.cos(turn), np.sin(turn)]))
    return _put(thing, place, neighbour.table.height, neighbour.table)


def _onto(rng: np.random.Generator, thing: Thing, below: Thing) -> Thing | None:
    """A thing on top of another one, its middle above it; None where it is too large for that."""
    size, room = np.ptp(thing.outline, axis=0), np.ptp(below.outline, axis=0)
    place = below.outline.mean(axis=0) + rng.uniform(-0.2, 0.2, 2) * room
    if size.max() > _OVERHANG * room.max() or not is_within(place[None], below.outline, _FROM_EDGE):
        return None
    return _put(thing, place, below.top, below.table)


def _fits(thing: Thing, others: Sequence[Thing], apart: float) -> bool:
    """Whether a thing is above its table, all of it, and keeps a distance in metres from others."""
    return (
        is_within(thing.outline, thing.table.outline, _FROM_EDGE)
        and thing.top - thing.table.height < _HIGHEST
        and all(gap(thing.outline, other.outline) >= apart for other in others)
    )
