"""What stands around the objects of a simulated scene: tables, floor and wall."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.simulation.footprint import footprint, until_contact
from shapeconcepts.simulation.shapes.box import rounded_box
from shapeconcepts.simulation.shapes.mesh import Mesh, join, loft, moved, rotated, sheet

TABLE, SECOND_TABLE, WALL, FLOOR = 1, 2, 3, 4

# Cells are so small that those which reach behind the camera can be left out whole.
_CELLS_ALONG = 20
_CELL = 0.25
_LEG = 0.025
_ROOM = 3.5


class Table(NamedTuple):
    """A table in the world.

    Attributes
    ----------
    mesh : Mesh
    outline : (k, 2) float64
        Convex, counter-clockwise, of the flat part of its top.
    height : float
        z of its top, metres.
    """

    mesh: Mesh
    outline: NDArray[np.float64]
    height: float


def draw_table(rng: np.random.Generator, floor: float, is_large: bool) -> Table:
    """A round or rectangular table about the origin, its top at the height 0, the floor's below that.

    A large one is rectangular and 1.6 to 2.4 m wide and deep.
    """
    thickness = rng.uniform(0.018, 0.05)
    if is_large:
        parts = _rectangular(rng.uniform(0.8, 1.2, 2), thickness, floor)
    elif rng.random() < 0.3:
        parts = _round(rng, thickness, floor)
    else:
        parts = _rectangular(rng.uniform((0.35, 0.28), (0.9, 0.5)), thickness, floor)
    mesh = rotated(join(parts), 2, np.radians(rng.uniform(-35.0, 35.0) + rng.choice([0.0, 90.0])))
    top = mesh.vertices[mesh.vertices[:, 2] > -1e-9]
    return Table(mesh, footprint(top), 0.0)


def _rectangular(half_size: NDArray[np.float64], thickness: float, floor: float) -> list[Mesh]:
    half = np.array([*half_size, thickness / 2.0])
    top = moved(rounded_box(half, radius=0.003, n=_CELLS_ALONG), (0.0, 0.0, -half[2]))
    length = -floor - thickness
    leg = rounded_box(np.array([_LEG, _LEG, length / 2.0]), radius=0.003)
    x, y = half[:2] - 0.05
    middle = floor + length / 2.0
    return [top, *(moved(leg, (a * x, b * y, middle)) for a in (-1.0, 1.0) for b in (-1.0, 1.0))]


def _round(rng: np.random.Generator, thickness: float, floor: float) -> list[Mesh]:
    radius = rng.uniform(0.32, 0.65)
    rings = radius * np.linspace(0.0, 1.0, _CELLS_ALONG)
    top = loft(
        np.r_[rings, rings[::-1]],
        np.r_[rings, rings[::-1]],
        np.r_[np.full(_CELLS_ALONG, -thickness), np.zeros(_CELLS_ALONG)],
        n_around=96,
    )
    column = loft(np.full(8, 0.05), np.full(8, 0.05), np.linspace(floor, -thickness, 8), n_around=32)
    return [top, column]


def beside(rng: np.random.Generator, table: Table, other: Table, height: float) -> Table:
    """A table moved to the left, to the right or behind another one, its top at another height."""
    turn = np.radians(rng.choice([0.0, 90.0, 180.0]) + rng.uniform(-25.0, 25.0))
    direction = np.array([np.cos(turn), np.sin(turn)])
    shift = until_contact(table.outline, other.outline, direction) + rng.uniform(0.01, 0.3) * direction
    return Table(moved(table.mesh, (*shift, height)), table.outline + shift, height)


def on_table(table: Table, place: NDArray[np.float64]) -> Table:
    """A table moved so that a place (2,) on it comes to the origin."""
    return Table(moved(table.mesh, (*-place, 0.0)), table.outline - place, table.height)


def floor_at(height: float) -> Mesh:
    """The floor of a room at a height."""
    n = int(2 * _ROOM / _CELL) + 1
    x, y = np.meshgrid(np.linspace(-_ROOM, _ROOM, n), np.linspace(-_ROOM / 2, 1.5 * _ROOM, n), indexing="ij")
    return sheet(np.stack([x, y, np.full_like(x, height)], axis=-1), 0)


def wall_behind(rng: np.random.Generator, things: NDArray[np.float64], floor: float) -> Mesh:
    """A wall of 2.5 m from the floor up that stands 0 to 1.2 m behind all of some points (n, 3)."""
    turn = np.radians(rng.uniform(-30.0, 30.0))
    behind, along = np.array([-np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), np.sin(turn)])
    distance = (things[:, :2] @ behind).max() + rng.uniform(0.002, 1.2)
    n = int(2 * _ROOM / _CELL) + 1
    a, z = np.meshgrid(np.linspace(-_ROOM, _ROOM, n), np.linspace(floor, floor + 2.5, 11), indexing="ij")
    place = distance * behind + a[..., None] * along
    return sheet(np.concatenate([place, z[..., None]], axis=-1), 0)
