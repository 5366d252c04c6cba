"""Says what a scan looks like in words: "box-like, 3 faces, 12 × 8 × 5 cm"."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.report.html.object_size import object_sides
from shapeconcepts.segmentation import SegmentedObject

# Smaller segments are edges and handles, by which nobody would name a thing.
_LEAST_SHARE = 0.04
# Part of a segment's points that are at its border.
_BORDER = 0.15
# Variance of the normals along the direction in which they vary most, up to which a surface is flat: noise of
# the sensor makes about a third of it, and an arc of 60 degrees one and a half times as much.
_FLAT = 0.055
# Of a cylinder's normals the variance along the axis, in parts of that across it.
_STRAIGHT = 0.3
# Part of the surface that decides what the whole is like.
_MOST = 0.6
# Cosine of the angle between faces that are perpendicular, at most.
_PERPENDICULAR = 0.3
# Side of a thing that is thin, in parts of the next longer one.
_THIN = 0.25
# Of a ball the second side in parts of the longest, and the third, which is half hidden, in parts of that.
_EVEN, _HALF_SEEN = 0.75, 0.35


def geometric_name(segmented: SegmentedObject) -> str:
    """Shape, surfaces and size of a scan in words.

    Parameters
    ----------
    segmented : SegmentedObject

    Returns
    -------
    str
        Such as "box-like, 3 faces, 12 × 8 × 5 cm": sides are those of what the sensor saw.
    """
    surfaces = _surfaces(segmented)
    kinds = Counter(one.kind for one in surfaces)
    sides = object_sides(segmented)
    parts = [_shape(surfaces, sides), *(_counted(kinds[kind], kind) for kind in _WORDS if kinds[kind])]
    return ", ".join([*parts, _size(sides)])


class _Surface(NamedTuple):
    """A segment: flat, bent like a cylinder or round; its share of the points; where it looks."""

    kind: str
    share: float
    normal: NDArray[np.float64]


_WORDS = {"flat": "face", "bent": "curved side", "round": "round surface"}


def _surfaces(segmented: SegmentedObject) -> list[_Surface]:
    """Segments that are not small."""
    labels = segmented.segment_labels
    counts = np.bincount(labels[labels >= 0], minlength=segmented.n_segments)
    shares = counts / max(counts.sum(), 1)
    return [
        _surface(segmented.normals[labels == number], float(shares[number]))
        for number in np.flatnonzero(shares >= _LEAST_SHARE)
    ]


def _surface(normals: NDArray[np.float64], share: float) -> _Surface:
    mean = normals.mean(axis=0)
    mean = mean / max(float(np.linalg.norm(mean)), 1e-12)
    # At its borders a surface has normals of both sides.
    along = normals @ mean
    inner = normals[along >= np.quantile(along, _BORDER)]
    _, second, first = np.linalg.eigvalsh(np.cov(inner.T)) if len(inner) > 1 else np.zeros(3)
    if first <= _FLAT:
        return _Surface("flat", share, mean)
    return _Surface("bent" if second <= _STRAIGHT * first else "round", share, mean)


def _shape(surfaces: Sequence[_Surface], sides: tuple[float, float, float]) -> str:
    share = {kind: sum(one.share for one in surfaces if one.kind == kind) for kind in _WORDS}
    longest, middle, shortest = sides
    if share["flat"] >= _MOST:
        if shortest <= _THIN * middle:
            return "plate-like"
        return (
            "box-like" if _are_perpendicular([one for one in surfaces if one.kind == "flat"]) else "angular"
        )
    if share["bent"] >= share["round"] and share["bent"] + share["flat"] >= _MOST:
        return "cylinder-like"
    is_even = middle >= _EVEN * longest and shortest >= _HALF_SEEN * middle
    return "ball-like" if share["round"] >= _MOST and is_even else "rounded"


def _are_perpendicular(faces: Sequence[_Surface]) -> bool:
    """Whether each two of the faces are, or are opposite each other."""
    normals = np.array([one.normal for one in faces])
    cosines = np.abs(normals @ normals.T)
    return bool(((cosines <= _PERPENDICULAR) | (cosines >= 1 - _PERPENDICULAR)).all())


def _counted(n: int, kind: str) -> str:
    return f"{n} {_WORDS[kind]}" + ("" if n == 1 else "s")


def _size(sides: tuple[float, float, float]) -> str:
    if sides[0] >= 1:
        return " × ".join(f"{side:.1f}" for side in sides) + " m"
    digits = 0 if sides[0] >= 0.1 else 1
    return " × ".join(f"{100 * side:.{digits}f}" for side in sides) + " cm"
