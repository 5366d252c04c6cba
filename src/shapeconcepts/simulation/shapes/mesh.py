"""Triangle meshes with a surface part for every face, and the solids that all shapes are built from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Mesh(NamedTuple):
    """Triangles in metres, z upwards.

    Attributes
    ----------
    vertices : (v, 3) float64
    faces : (f, 3) int64
    face_labels : (f,) int64
        Surface part of each face.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    face_labels: NDArray[np.int64]


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one; surfaces inside another mesh stay, since no sensor sees them."""
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]),
        np.concatenate([mesh.face_labels for mesh in meshes]),
    )


def loft(
    half_widths: ArrayLike,
    half_depths: ArrayLike,
    heights: ArrayLike,
    *,
    labels: ArrayLike = 0,
    exponent: ArrayLike = 2.0,
    n_around: int = 64,
) -> Mesh:
    """Skin over k horizontal sections, each a superellipse `|x/width|^e + |y/depth|^e = 1`.

    Parameters
    ----------
    half_widths, half_depths, heights : array-like of shape (k,)
        Half extent along x and y, and z, of each section. Half extents of 0 close the skin.
    labels : int or array-like of shape (k - 1,)
        Surface part of the band between two sections.
    exponent : float or array-like of shape (k,)
        2 gives ellipses, larger values round rectangles.
    n_around : int
        Corners of a section.
    """
    heights = np.asarray(heights, dtype=np.float64)
    turn = 2.0 * np.pi * np.arange(n_around) / n_around
    power = (2.0 / np.broadcast_to(np.asarray(exponent, dtype=np.float64), heights.shape))[:, None]
    cosine, sine = np.cos(turn), np.sin(turn)
    x = np.asarray(half_widths)[:, None] * np.sign(cosine) * np.abs(cosine) ** power
    y = np.asarray(half_depths)[:, None] * np.sign(sine) * np.abs(sine) ** power
    z = np.broadcast_to(heights[:, None], x.shape)
    return _skin(np.stack([x, y, z], axis=-1), labels)


def revolve(radii: ArrayLike, heights: ArrayLike, *, labels: ArrayLike = 0, n_around: int = 64) -> Mesh:
    """Solid of revolution about z, from the (k,) radii and heights of its profile."""
    return loft(radii, radii, heights, labels=labels, n_around=n_around)


def ellipsoid(
    half_axes: ArrayLike, centre: ArrayLike = (0.0, 0.0, 0.0), *, label: int = 0, n: int = 24
) -> Mesh:
    """Ellipsoid with half axes along x, y and z."""
    half_axes = np.asarray(half_axes, dtype=np.float64)
    polar = np.linspace(0.0, np.pi, n + 1)
    ring, height = np.sin(polar), -np.cos(polar)
    mesh = loft(half_axes[0] * ring, half_axes[1] * ring, half_axes[2] * height, labels=label, n_around=2 * n)
    return moved(mesh, centre)


def tube(
    path: ArrayLike, radii: ArrayLike, *, label: int = 0, flatness: float = 1.0, n_around: int = 20
) -> Mesh:
    """Tube along a smooth path.

    Parameters
    ----------
    path : array-like of shape (k, 3)
    radii : array-like of shape (k,)
        Half the thickness in the plane of the bend; radii of 0 close the ends.
    label : int
    flatness : float
        Half the thickness across that plane, in units of `radii`.
    n_around : int
        Corners of a section.
    """
    path = np.asarray(path, dtype=np.float64)
    tangents = np.gradient(path, axis=0)
    bend = np.cross(path[len(path) // 2] - path[0], path[-1] - path[0])
    if np.linalg.norm(bend) < 1e-9:
        bend = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    bend /= np.linalg.norm(bend)
    inward = np.cross(tangents, bend)
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    turn = 2.0 * np.pi * np.arange(n_around) / n_around
    thickness = np.asarray(radii, dtype=np.float64)[:, None, None]
    rings = path[:, None] + thickness * (
        np.cos(turn)[None, :, None] * inward[:, None] + flatness * np.sin(turn)[None, :, None] * bend
    )
    return _skin(rings, label)


def limb(
    start: ArrayLike, middle: ArrayLike, end: ArrayLike, radius: float, end_radius: float, label: int
) -> Mesh:
    """Round-ended tube along a quadratic Bézier curve."""
    fraction = (1.0 - np.cos(np.linspace(0.0, np.pi, 24))) / 2.0
    path = bezier(np.array([start, middle, end], dtype=np.float64), fraction)
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    full = radius + fraction * (end_radius - radius)
    to_end = length * np.minimum(fraction, 1.0 - fraction)
    roundness = np.sqrt(np.clip(1.0 - (1.0 - to_end / full) ** 2, 0.0, None)) * (to_end < full) + (
        to_end >= full
    )
    return tube(path, full * roundness, label=label)


def bezier(control: ArrayLike, fraction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of a Bézier curve of any degree at some fractions of it (de Casteljau)."""
    points = np.asarray(control, dtype=np.float64)[:, None, :]
    fraction = fraction[None, :, None]
    while len(points) > 1:
        points = (1.0 - fraction) * points[:-1] + fraction * points[1:]
    return points[0]


def sheet(points: NDArray[np.float64], label: int) -> Mesh:
    """Rectangular grid of points, (a, b, 3), as triangles."""
    index = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    corners = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    first, second, third, fourth = corners
    faces = np.stack([first, second, third, first, third, fourth], axis=-1).reshape(-1, 3)
    return Mesh(points.reshape(-1, 3), faces, np.full(len(faces), label, dtype=np.int64))


def moved(mesh: Mesh, offset: ArrayLike) -> Mesh:
    """The mesh shifted by an offset (3,) in metres."""
    return mesh._replace(vertices=mesh.vertices + np.asarray(offset))


def rotated(mesh: Mesh, axis: int, angle: float) -> Mesh:
    """The mesh turned about the x (0), y (1) or z (2) axis by an angle in radians."""
    first, second = [(1, 2), (2, 0), (0, 1)][axis]
    turned = mesh.vertices.copy()
    turned[:, first] = np.cos(angle) * mesh.vertices[:, first] - np.sin(angle) * mesh.vertices[:, second]
    turned[:, second] = np.sin(angle) * mesh.vertices[:, first] + np.cos(angle) * mesh.vertices[:, second]
    return mesh._replace(vertices=turned)


def mirrored(mesh: Mesh, label: int) -> Mesh:
    """The mesh reflected in the plane x = 0, as another part."""
    return Mesh(mesh.vertices * (-1.0, 1.0, 1.0), mesh.faces, np.full_like(mesh.face_labels, label))


def _skin(rings: NDArray[np.float64], labels: ArrayLike) -> Mesh:
    """Quadrilaterals between consecutive closed rings, (k, n, 3), as triangles."""
    n_rings, n_around = rings.shape[:2]
    index = np.arange(n_rings * n_around).reshape(n_rings, n_around)
    here, above = index[:-1], index[1:]
    after, above_after = np.roll(here, -1, axis=1), np.roll(above, -1, axis=1)
    faces = np.stack([here, after, above_after, here, above_after, above], axis=-1).reshape(-1, 3)
    bands = np.broadcast_to(np.asarray(labels, dtype=np.int64), (n_rings - 1,))
    return Mesh(rings.reshape(-1, 3), faces, np.repeat(bands, 2 * n_around))
