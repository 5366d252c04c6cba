"""Says what a scan looks like in words: "box-like, 3 faces, 12 × 8 × 5 cm"."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

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
    kinds = Counter(kind for kind, _, _ in surfaces)
    sides = object_sides(segmented)
    parts = [_shape(surfaces, sides), *(_counted(kinds[kind], kind) for kind in _WORDS if kinds[kind])]
    return ", ".join([*parts, _size(sides)])


_Surface = tuple[str, float, NDArray[np.float64]]
_WORDS = {"flat": "face", "bent": "curved side", "round": "round surface"}


def _surfaces(segmented: SegmentedObject) -> list[_Surface]:
    """Kind, share of the points and mean normal of each segment that is not small."""
    labels = segmented.segment_labels
    counts = np.bincount(labels[labels >= 0], minlength=segmented.n_segments)
    shares = counts / max(counts.sum(), 1)
    return [
        (
            *_kind_and_share(segmented.normals[labels == one], shares[one]),
            segmented.normals[labels == one].mean(0),
        )
        for one in np.flatnonzero(shares >= _LEAST_SHARE)
    ]


def _kind_and_share(normals: NDArray[np.float64], share: float) -> tuple[str, float]:
    # At its borders a surface has normals of both sides.
    along = normals @ normals.mean(axis=0)
    normals = normals[along >= np.quantile(along, _BORDER)]
    variances = np.linalg.eigvalsh(np.cov(normals.T)) if len(normals) > 1 else np.zeros(3)
    _, second, first = variances
    if first <= _FLAT:
        return "flat", float(share)
    return ("bent" if second <= _STRAIGHT * first else "round"), float(share)


def _shape(surfaces: Sequence[_Surface], sides: tuple[float, float, float]) -> str:
    share = Counter[str]()
    for kind, part, _ in surfaces:
        share[kind] += part
    longest, middle, shortest = sides
    if share["flat"] >= _MOST:
        if shortest <= _THIN * middle:
            return "plate-like"
        return "box-like" if _are_perpendicular([one for one in surfaces if one[0] == "flat"]) else "angular"
    if share["bent"] >= share["round"] and share["bent"] + share["flat"] >= _MOST:
        return "cylinder-like"
    # Of a ball, half is seen.
    is_even = middle >= _EVEN * longest and shortest >= _HALF_SEEN * middle
    return "ball-like" if share["round"] >= _MOST and is_even else "rounded"


def _are_perpendicular(faces: Sequence[_Surface]) -> bool:
    """Whether each two of the faces are, or are opposite each other."""
    normals = np.array([normal / max(np.linalg.norm(normal), 1e-12) for _, _, normal in faces])
    cosines = np.abs(normals @ normals.T)
    return bool(((cosines <= _PERPENDICULAR) | (cosines >= 1 - _PERPENDICULAR)).all())


def _counted(n: int, kind: str) -> str:
    return f"{n} {_WORDS[kind]}" + ("" if n == 1 else "s")


def _size(sides: tuple[float, float, float]) -> str:
    if sides[0] >= 1:
        return " × ".join(f"{side:.1f}" for side in sides) + " m"
    digits = 0 if sides[0] >= 0.1 else 1
    return " × ".join(f"{100 * side:.{digits}f}" for side in sides) + " cm"
