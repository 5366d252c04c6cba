"""Planes that objects stand on: table tops, floors, boards of a shelf."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from shapeconcepts.extraction.planar_regions import PlanarRegion

HORIZONTAL = np.cos(np.radians(10.0))
# Square metres.
_LEAST_AREA = 0.03
# Metres above a plane up to which something stands on it; what reaches higher is no object.
HIGHEST = 0.6
# Share of the area of a plane up to which a smaller one above it is the top of an object.
_TOP = 0.4
_ABOVE = 0.7
# A plane so many metres above another and of so many square metres is a table, and the other its floor.
_TABLE_HEIGHT = 0.3
_TABLE_AREA = 0.12
_SAME_HEIGHT = 0.05
# Metres by which an outline is larger than the cells' means.
MARGIN = 0.02


class SupportingPlane(NamedTuple):
    """A plane that objects stand on, and its outline.

    Attributes
    ----------
    point, normal : (3,) float64
        A point on it, and the unit normal upwards.
    axes : (2, 3) float64
        Unit vectors along it.
    outline : (k, 3) float64
        Sides of its convex outline: the first two numbers times a point along `axes` from `point`, plus the
        third, are the metres by which it is outside.
    area : float
        Square metres within the outline.
    """

    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    axes: NDArray[np.float64]
    outline: NDArray[np.float64]
    area: float


class _Candidate(NamedTuple):
    plane: SupportingPlane
    cells: NDArray[np.float64]

    def height_above(self, other: _Candidate) -> float:
        return float(np.median((self.cells - other.plane.point) @ other.plane.normal))

    def is_top_above(self, other: _Candidate) -> bool:
        """Whether this is the top of something that stands on another plane."""
        is_smaller = self.plane.area < _TOP * other.plane.area
        if not is_smaller or not 0.0 < self.height_above(other) < HIGHEST:
            return False
        return bool(is_inside(other.plane, self.cells).mean() > _ABOVE)


def supporting_planes(regions: list[PlanarRegion], up: NDArray[np.float64]) -> list[SupportingPlane]:
    """Planes that objects stand on, the highest first; none is an answer.

    Of horizontal regions that face up, those are left out that are small, a floor below tables, and those
    that are the top of something on a larger one.

    Parameters
    ----------
    regions : list of PlanarRegion
    up : (3,) float64
    """
    candidates = [
        _Candidate(plane, region.cells)
        for region in regions
        if region.normal @ up > HORIZONTAL
        and region.area >= _LEAST_AREA
        and (plane := level_plane(region)) is not None
    ]
    floors = [
        one
        for one in candidates
        if any(
            other.plane.area > _TABLE_AREA and other.height_above(one) > _TABLE_HEIGHT for other in candidates
        )
    ]
    # Small parts of a floor have nothing above them.
    standing = [
        one
        for one in candidates
        if not any(one is floor or one.height_above(floor) < _SAME_HEIGHT for floor in floors)
    ]
    kept = [one for one in standing if not any(one.is_top_above(other) for other in standing)]
    kept.sort(key=lambda one: -float(one.plane.point @ up))
    return [one.plane for one in kept]


def is_inside(plane: SupportingPlane, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether points (n, 3) are above or below the outline of a plane, (n,) bool."""
    return signed_sides(plane, points) <= MARGIN


def signed_sides(plane: SupportingPlane, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Metres by which points (n, 3) are outside of the outline of a plane, (n,); negative within."""
    along = (points - plane.point) @ plane.axes.T
    # Sides before points: the maximum runs along memory.
    outside = plane.outline[:, :2] @ along.T
    outside += plane.outline[:, 2:]
    return np.asarray(outside.max(axis=0, initial=-np.inf))


def level_plane(region: PlanarRegion) -> SupportingPlane | None:
    """A region with its outline; None where its cells are on one line."""
    helper = np.eye(3)[np.argmin(np.abs(region.normal))]
    first = np.cross(region.normal, helper)
    first /= np.linalg.norm(first)
    axes = np.stack([first, np.cross(region.normal, first)])
    try:
        hull = ConvexHull((region.cells - region.point) @ axes.T)
    except QhullError:
        return None
    return SupportingPlane(region.point, region.normal, axes, hull.equations, float(hull.volume))
