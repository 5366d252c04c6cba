"""Large surfaces behind and beside what objects stand on, such as walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.extraction.pixel_grid import PixelGrid
from shapeconcepts.extraction.planar_regions import PlanarRegion
from shapeconcepts.extraction.supporting_planes import HIGHEST, HORIZONTAL, SupportingPlane, is_inside

# Square metres.
_LEAST_AREA = 0.2
# Share of a plane from which on it is above what objects stand on, and so can be that of one.
_OF_AN_OBJECT = 0.6
_TIMES_NOISE, _MARGIN = 3.0, 0.01


def is_background(
    grid: PixelGrid,
    regions: list[PlanarRegion],
    planes: list[SupportingPlane],
    noises: NDArray[np.float32],
) -> NDArray[np.bool_]:
    """Points of large planes that are no objects' and objects do not stand on, (h, w) bool.

    Parameters
    ----------
    grid : PixelGrid
    regions : list of PlanarRegion
    planes : list of SupportingPlane
    noises : (h, w) float32
        Of the depth, metres.
    """
    behind = np.zeros(noises.shape, bool)
    for region in regions:
        if region.area < _LEAST_AREA or region.normal @ grid.up > HORIZONTAL:
            continue
        over = np.zeros(len(region.cells), bool)
        for plane in planes:
            over |= is_inside(plane, region.cells) & ((region.cells - plane.point) @ plane.normal < HIGHEST)
        if over.mean() < _OF_AN_OBJECT:
            behind |= np.abs((grid.points - region.point) @ region.normal) < _TIMES_NOISE * noises + _MARGIN
    return behind
