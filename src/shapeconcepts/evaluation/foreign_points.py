"""Scans in which something foreign is left: a part of another object, or a strip of the table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors import DescribedObject, Descriptor, describe
from shapeconcepts.scan import Scan, ScanError, scan_errors
from shapeconcepts.segmentation import SegmentedObject, Segmenter

Points = NDArray[np.float64]

FOREIGN_SHARE = 0.2
# Degrees between the line of sight and a table.
_TILTS = (30, 60)
# Share of the points that is the side at which two objects touch.
_TOUCHING = 0.05
_RIM = 0.02


def with_foreign_points(
    segmented: SegmentedObject, other: SegmentedObject, number: int, descriptor: str | Descriptor
) -> DescribedObject | None:
    """An object segmented and described anew with something foreign, a fifth of all points.

    Parameters
    ----------
    segmented : SegmentedObject
    other : SegmentedObject
        A part of which touches the object, where `number` is odd; else it is a strip of a table.
    number : int
        Another one, another side.
    descriptor : str or Descriptor

    Returns
    -------
    DescribedObject or None
        None where the joined points cannot be segmented.
    """
    rng = np.random.default_rng(number)
    points = segmented.points
    if segmented.viewpoint is None:
        # Normals point to the sensor.
        sight = -segmented.normals.mean(axis=0)
    else:
        sight = points.mean(axis=0) - segmented.viewpoint
    try:
        with scan_errors(segmented.name, "given foreign points"):
            foreign = (
                touching_part(points, sight, other.points, FOREIGN_SHARE, rng)
                if number % 2
                else table_strip(points, sight, FOREIGN_SHARE, rng)
            )
            joined = np.concatenate([points, foreign])
            scan = Scan(joined, segmented.viewpoint, segmented.name, segmented.label)
            return describe(Segmenter(voxel_size=segmented.voxel_size).segment(scan), descriptor)
    except ScanError:
        return None


def touching_part(
    points: Points, sight: Points, other: Points, share: float, rng: np.random.Generator
) -> Points:
    """Points of another object, moved until they touch from a random side, and cut to a share of all.

    Parameters
    ----------
    points, other : (n, 3), (m, 3) float64
    sight : (3,) float64
        From the sensor to the points, of any length but 0.
    share : float
    rng : Generator

    Returns
    -------
    (k, 3) float64
    """
    side = _random_side(sight, rng)
    n = min(_number(share, points), len(other))
    reach = other @ side
    kept = other[np.argsort(reach)[:n]]
    ours, theirs = points @ side, kept @ side
    near_us = points[ours >= np.quantile(ours, 1 - _TOUCHING)].mean(axis=0)
    near_them = kept[theirs <= np.quantile(theirs, _TOUCHING)].mean(axis=0)
    return kept + (near_us - near_them)


def table_strip(points: Points, sight: Points, share: float, rng: np.random.Generator) -> Points:
    """A strip of a plane below the lower rim of an object in the image, a share of all points.

    Parameters and result are those of `touching_part`.
    """
    centre = points.mean(axis=0)
    down = _random_side(sight, rng)
    along = np.cross(_unit(sight), down)
    tilt = np.radians(rng.uniform(*_TILTS))
    towards = np.sin(tilt) * down - np.cos(tilt) * _unit(sight)
    place = (points - centre) @ np.array([along, down]).T
    start = points[place[:, 1] >= np.quantile(place[:, 1], 1 - _RIM)].mean(axis=0)
    n = _number(share, points)
    width, area = np.ptp(place[:, 0]), np.ptp(place[:, 0]) * np.ptp(place[:, 1])
    depth = area * share / (1 - share) / max(width, 1e-9)
    across = (rng.random(n) - 0.5) * width
    return start + across[:, None] * along + (rng.random(n) * depth)[:, None] * towards


def _number(share: float, points: Points) -> int:
    """How many foreign points are a share of all, at least one."""
    return max(round(share / (1 - share) * len(points)), 1)


def _random_side(sight: Points, rng: np.random.Generator) -> Points:
    """A direction across the line of sight."""
    return _unit(rng.normal(size=2) @ np.linalg.svd(_unit(sight)[None])[2][1:])


def _unit(vector: Points) -> Points:
    return vector / np.linalg.norm(vector)
