"""Surface splatting (Zwicker et al. 2001): a closed surface drawn from points with normals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# A disc seen at a steeper angle would be thinner than the noise of its normal, and leave holes.
_STEEPEST_COSINE = 0.45
# In units of the point distance: far enough for surfaces to close and for outlines to be smooth.
_SPREAD = 0.75
_REACH = 1.7
_SURFACE_THICKNESS = 2.0
_FRAGMENTS_AT_ONCE = 500_000


class Splats(NamedTuple):
    """Smooth fields over the image; labels and outline follow from them at any resolution."""

    coverage: NDArray[np.float32]  # (height, width), 1 inside a closed surface, 0.5 on its outline
    normals: NDArray[np.float32]  # (3, height, width), not of unit length
    votes: dict[int, NDArray[np.float32]]  # per label (height, width): the largest has the pixel


class _Fragments(NamedTuple):
    """One entry for each pair of a point and a pixel under its disc."""

    sources: NDArray[np.int64]
    pixels: NDArray[np.int64]
    depth: NDArray[np.float64]
    weights: NDArray[np.float64]


def splat(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    labels: NDArray[np.integer],
    spacing: float,
    size: tuple[int, int],
) -> Splats:
    """Draw points as discs in an orthographic camera.

    Every point is a disc perpendicular to its normal with a Gaussian weight. The nearest disc at a pixel sets
    its depth; the discs of the same surface there blend their normals and vote for the label.

    Parameters
    ----------
    points : (m, 3) float64
        Column, row (downwards) and depth (growing towards the camera), all in pixels.
    normals : (m, 3) float64
        Unit normals in the same axes.
    labels : (m,) int
        Label of each point.
    spacing : float
        Distance of neighbouring points, pixels.
    size : (int, int)
        Height and width of the image, pixels.
    """
    n_pixels = size[0] * size[1]
    normals = _facing(normals)

    front = np.full(n_pixels, -np.inf)
    for part in _fragments(points, normals, spacing, size):
        np.maximum.at(front, part.pixels, part.depth)

    # The first index of the sums: 0 for the surface in front, 1 for what lies behind it.
    values = np.unique(labels)
    votes = np.zeros((2, len(values), n_pixels), dtype=np.float32)
    blend = np.zeros((2, 3, n_pixels), dtype=np.float32)
    for index, value in enumerate(values):
        members = labels == value
        member_normals = normals[members]
        for part in _fragments(points[members], member_normals, spacing, size):
            behind = part.depth < front[part.pixels] - _SURFACE_THICKNESS * spacing
            for layer, chosen in enumerate((~behind, behind)):
                pixels, weights = part.pixels[chosen], part.weights[chosen]
                facing = member_normals[part.sources[chosen]]
                votes[layer, index] += np.bincount(pixels, weights, n_pixels)
                for axis in range(3):
                    blend[layer, axis] += np.bincount(pixels, weights * facing[:, axis], n_pixels)

    votes /= 2 * np.pi * _SPREAD**2
    coverage = votes.sum(axis=(0, 1))
    # What is behind shines through where the surface in front fades out, so that its outline is smooth.
    transparency = (1 - 2 * votes[0].sum(axis=0)).clip(min=0)
    seen = votes[0] + transparency * votes[1]
    return Splats(
        coverage=coverage.reshape(size),
        normals=(blend[0] + transparency * blend[1]).reshape(3, *size),
        votes={int(value): vote.reshape(size) for value, vote in zip(values, seen, strict=True)},
    )


def _facing(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normals turned towards the camera, none steeper than `_STEEPEST_COSINE`."""
    normals = np.where(normals[:, 2:] < 0, -normals, normals)
    normals[:, 2] = np.maximum(normals[:, 2], _STEEPEST_COSINE)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _fragments(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    spacing: float,
    size: tuple[int, int],
) -> Iterator[_Fragments]:
    """Pixels under the disc of each point, a limited number at a time."""
    height, width = size
    radius = int(np.ceil(_REACH * spacing))
    steps = np.arange(-radius, radius + 1)
    down, across = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    at_once = max(1, _FRAGMENTS_AT_ONCE // len(across))
    for start in range(0, len(points), at_once):
        chunk = points[start : start + at_once]
        normal = normals[start : start + at_once, :, None]
        centre = np.rint(chunk[:, :2]).astype(np.int64)
        column = centre[:, :1] + across
        row = centre[:, 1:] + down
        x = column - chunk[:, :1]
        y = row - chunk[:, 1:2]
        z = -(normal[:, 0] * x + normal[:, 1] * y) / normal[:, 2]
        squared_radius = (x * x + y * y + z * z) / spacing**2
        kept = (squared_radius < _REACH**2) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
        yield _Fragments(
            sources=np.nonzero(kept)[0] + start,
            pixels=(row * width + column)[kept],
            depth=(chunk[:, 2:] + z)[kept],
            weights=np.exp(squared_radius[kept] / (-2 * _SPREAD**2)),
        )
