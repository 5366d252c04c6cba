"""In which unit and with which axis upwards the coordinates of a file are."""

from __future__ import annotations

from numbers import Real
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Up = Literal["x", "y", "z", "-x", "-y", "-z"]

METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
# Which axis becomes x, y and z, so that the given one becomes z.
_TURNS = {
    "z": ("x", "y", "z"),
    "y": ("x", "-z", "y"),
    "x": ("y", "z", "x"),
    "-z": ("x", "-y", "-z"),
    "-y": ("x", "z", "-y"),
    "-x": ("-y", "z", "-x"),
}


def metres_per_unit(units: str | float) -> float | None:
    """How long a unit is; None where the coordinates have to tell it.

    Parameters
    ----------
    units : {"auto", "m", "cm", "mm", "in", "ft"} or float
        Or metres per unit.

    Raises
    ------
    ValueError
        If it is neither a known name nor a positive number.
    """
    if units == "auto":
        return None
    if isinstance(units, str) and units in METRES_PER_UNIT:
        return METRES_PER_UNIT[units]
    if isinstance(units, Real) and not isinstance(units, bool) and 0.0 < float(units) < np.inf:
        return float(units)
    raise ValueError(
        f"units must be one of auto, {', '.join(METRES_PER_UNIT)} or metres per unit, > 0, got {units!r}"
    )


def in_metres(coordinates: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Coordinates times metres per unit.

    A thousandth is no binary number, a thousand is: of whole millimetres, a division makes the numbers that a
    file in metres holds.
    """
    per_metre = 1.0 / scale
    return coordinates / per_metre if per_metre.is_integer() else coordinates * scale


def check_up(up: str | None) -> None:
    """Raise ValueError for what is no axis."""
    if up is not None and up not in _TURNS:
        raise ValueError(f"up must be one of {', '.join(_TURNS)}, got {up!r}")


def turned_upright(vertices: NDArray[np.float64], up: Up) -> NDArray[np.float64]:
    """Vertices (v, 3), turned so that the given axis becomes z."""
    columns = ["xyz".index(axis[-1]) for axis in _TURNS[up]]
    signs = [-1.0 if axis.startswith("-") else 1.0 for axis in _TURNS[up]]
    return vertices[:, columns] * signs
