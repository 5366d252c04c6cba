"""The seven categories of the paper as parametric meshes, one file per category."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shapeconcepts.simulation.shapes import amphora, ball, box, can, plate, sack, teddy
from shapeconcepts.simulation.shapes.mesh import Mesh

SHAPES: dict[str, Callable[[np.random.Generator], Mesh]] = {
    "sack": sack.make_sack,
    "can": can.make_can,
    "box": box.make_box,
    "teddy": teddy.make_teddy,
    "ball": ball.make_ball,
    "amphora": amphora.make_amphora,
    "plate": plate.make_plate,
}
"""Draws a mesh of each category."""

PART_NAMES: dict[str, tuple[str, ...]] = {
    "sack": sack.PARTS,
    "can": can.PARTS,
    "box": box.PARTS,
    "teddy": teddy.PARTS,
    "ball": ball.PARTS,
    "amphora": amphora.PARTS,
    "plate": plate.PARTS,
}
"""Name of each value of `Scan.point_labels`, by category."""

__all__ = ["PART_NAMES", "SHAPES", "Mesh"]
