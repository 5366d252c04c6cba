"""Things that lie flat on tables: books, cards and phones, rulers, knives and forks."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from shapeconcepts.simulation.shapes.box import rounded_box
from shapeconcepts.simulation.shapes.mesh import Mesh, join, loft, moved, rotated, sheet

_PRONG_WIDTH = 0.004


def make_book(rng: np.random.Generator) -> Mesh:
    """A closed book of 11 to 24 cm by 17 to 32 cm, 1.2 to 5 cm thick."""
    width = rng.uniform(0.11, 0.24)
    return _slab(width, width * rng.uniform(1.25, 1.55), rng.uniform(0.012, 0.05))


def make_card(rng: np.random.Generator) -> Mesh:
    """A phone, a pack of cards or a flat case: 6 to 9 cm by 9 to 17 cm, 6 to 10 mm thick."""
    width = rng.uniform(0.06, 0.09)
    return _slab(width, width * rng.uniform(1.4, 2.1), rng.uniform(0.006, 0.01))


def make_ruler(rng: np.random.Generator) -> Mesh:
    """A ruler or a thin board: 3 to 5 cm by 16 to 34 cm, 5 to 8 mm thick."""
    return _slab(rng.uniform(0.03, 0.05), rng.uniform(0.16, 0.34), rng.uniform(0.005, 0.008))


def make_knife(rng: np.random.Generator) -> Mesh:
    """A table knife 18 to 25 cm long, its handle 6 to 9 mm thick."""
    length = rng.uniform(0.18, 0.25)
    at = np.linspace(0.0, 1.0, 40)
    handle = rng.uniform(0.009, 0.012)
    blade = handle * rng.uniform(1.0, 1.3)
    width = np.interp(at, [0.0, 0.05, 0.42, 0.48, 0.9, 1.0], [0.6, 1.0, 0.8, 0.7, 1.0, 0.2])
    thickness = rng.uniform(0.006, 0.009) / 2.0 * np.interp(at, [0.0, 0.4, 0.5, 1.0], [1.0, 1.0, 0.6, 0.5])
    sizes = np.where(at < 0.45, handle, blade) * width
    closed = np.r_[0.0, np.ones(40), 0.0]
    mesh = loft(
        closed * np.r_[sizes[0], sizes, sizes[-1]],
        closed * np.r_[thickness[0], thickness, thickness[-1]],
        length * np.r_[0.0, at, 1.0],
        exponent=3.0,
        n_around=32,
    )
    return rotated(mesh, 0, np.pi / 2.0)


def make_fork(rng: np.random.Generator) -> Mesh:
    """A fork 17 to 22 cm long with four prongs, its neck raised, 8 to 10 mm high."""
    length, half_width = rng.uniform(0.17, 0.22), rng.uniform(0.012, 0.015)
    thickness = rng.uniform(0.004, 0.005)
    rise = rng.uniform(0.004, 0.005)
    parts = [_strip([(0.0, 0.008), (0.1, 0.01), (0.55, 0.005), (0.68, half_width), (0.8, half_width)])]
    for centre in np.linspace(_PRONG_WIDTH / 2.0 - half_width, half_width - _PRONG_WIDTH / 2.0, 4):
        prong = _strip([(0.8, _PRONG_WIDTH / 2.0), (1.0, _PRONG_WIDTH / 3.0)])
        parts.append(moved(prong, (centre, 0.0, 0.0)))
    flat = join(parts)
    x, along, layer = flat.vertices.T
    # It rests on the end of the handle and on the head.
    bend = PchipInterpolator([0.0, 0.55, 0.84, 1.0], [0.0, rise, 0.0, 0.6 * rise])(along)
    return flat._replace(vertices=np.column_stack([x, length * along, thickness * layer + bend]))


def _slab(width: float, length: float, thickness: float) -> Mesh:
    half = np.array([width, length, thickness]) / 2.0
    return rounded_box(half, radius=min(0.0015, thickness / 4.0))


def _strip(outline: list[tuple[float, float]]) -> Mesh:
    """A closed strip along y, 1 high, from places along it and half widths there."""
    corners = np.array(outline)
    at = np.linspace(corners[0, 0], corners[-1, 0], 16)
    half = np.interp(at, *corners.T)
    rim = np.stack([np.column_stack([side * half, at, np.full(16, z)]) for side, z in _AROUND], axis=1)
    ends = [np.stack([rim[k, [0, 1]], rim[k, [3, 2]]]) for k in (0, -1)]
    return join([sheet(rim, 0), *(sheet(end, 0) for end in ends)])


# Left and right, below and above, around a strip and back to the start.
_AROUND = ((-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0))
