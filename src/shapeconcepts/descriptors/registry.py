"""Descriptors by name."""

from __future__ import annotations

from collections.abc import Callable

from shapeconcepts.descriptors.curvature import Curvature
from shapeconcepts.descriptors.fpfh import FPFH
from shapeconcepts.descriptors.joint import Joint
from shapeconcepts.descriptors.point_distances import PointDistances
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.descriptors.surflet import Surflet

DESCRIPTORS: dict[str, Callable[[], Descriptor]] = {
    "surflet+fpfh+curvature": lambda: Joint((Surflet(), FPFH(), Curvature())),
    "surflet+fpfh+curvature+distance": lambda: Joint((Surflet(), FPFH(), Curvature(), PointDistances())),
    "surflet+fpfh": lambda: Joint((Surflet(), FPFH())),
    "surflet": Surflet,
    "fpfh": FPFH,
    "curvature": Curvature,
    "distance": PointDistances,
}
DEFAULT = next(iter(DESCRIPTORS))


def get_descriptor(descriptor: str | Descriptor) -> Descriptor:
    """A descriptor from its name, with default parameters, or the given descriptor itself.

    Parameters
    ----------
    descriptor : {"surflet+fpfh+curvature", "surflet+fpfh+curvature+distance", "surflet+fpfh", \
                  "surflet", "fpfh", "curvature", "distance"} or Descriptor
        By shape, the default; by shape and size, in metres; or by less.

    Raises
    ------
    ValueError
        If it is neither a known name nor an object with a `describe` method.
    """
    if isinstance(descriptor, str) and descriptor in DESCRIPTORS:
        return DESCRIPTORS[descriptor]()
    if isinstance(descriptor, Descriptor) and not isinstance(descriptor, type):
        return descriptor
    names = ", ".join(map(repr, DESCRIPTORS))
    raise ValueError(f"descriptor must be one of {names} or have a describe method, got {descriptor!r}")
