"""Reads one scan from a file of any known format."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Literal, TypedDict, TypeVar, Unpack

import numpy as np
from numpy.typing import ArrayLike

from shapeconcepts.io.cloud import Cloud
from shapeconcepts.io.depth_image import (
    DEPTH_SUFFIXES,
    Intrinsics,
    Mask,
    check_camera,
    depth_cloud,
    read_depth_image,
)
from shapeconcepts.io.mesh import Mesh
from shapeconcepts.io.mesh_library import read_glb, read_stl
from shapeconcepts.io.mesh_text import read_obj, read_off
from shapeconcepts.io.numpy_file import depth_of_npy, read_npy, read_npz
from shapeconcepts.io.pcd import read_pcd
from shapeconcepts.io.ply import read_ply
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.io.text_table import read_text_table
from shapeconcepts.io.viewpoint import viewpoint_of
from shapeconcepts.scan import Scan, ScanError, ScanWarning, measured_rows, scan_errors
from shapeconcepts.simulation.sensor import scan_mesh
from shapeconcepts.simulation.views import views
from shapeconcepts.sources.frame import Up, check_up, in_metres, metres_per_unit, turned_upright
from shapeconcepts.sources.other_formats import pointer_in, refusal_of_format
from shapeconcepts.sources.units import unit_of_cloud, unit_of_mesh

Viewpoint = ArrayLike | Literal["auto"] | None
Content = TypeVar("Content")

_READERS: dict[str, Callable[[bytes], Cloud | Mesh]] = {
    ".pcd": read_pcd,
    ".ply": read_ply,
    ".xyz": read_text_table,
    ".txt": read_text_table,
    ".csv": read_text_table,
    ".pts": read_text_table,
    ".asc": read_text_table,
    ".npy": read_npy,
    ".npz": read_npz,
    ".obj": read_obj,
    ".stl": read_stl,
    ".off": read_off,
    ".glb": read_glb,
}
SCAN_SUFFIXES = (*_READERS, *DEPTH_SUFFIXES)
MESH_SUFFIXES = (".ply", ".obj", ".stl", ".off", ".glb")
# Where a format says which axis is upwards, and in which unit coordinates are.
_UP_OF_FORMAT: dict[str, Up] = {".glb": "y"}
_IN_METRES = (".glb",)


class ReadOptions(TypedDict, total=False):
    """Parameters of `read_scan` that hold for all files; `mask` may be a folder."""

    viewpoint: Viewpoint
    intrinsics: Intrinsics | None
    mask: Mask | None
    depth_scale: float | None
    units: str | float
    up: Up | None


def read_scan(
    path: str | PathLike[str],
    *,
    viewpoint: Viewpoint = "auto",
    intrinsics: Intrinsics | None = None,
    mask: Mask | None = None,
    depth_scale: float | None = None,
    units: str | float = "auto",
    up: Up | None = None,
) -> Scan:
    """Read one scan; the suffix of the file tells its format.

    * .pcd: ascii, binary or binary_compressed; the field `label` becomes `Scan.point_labels`.
    * .ply: ascii or binary; a point cloud, or a mesh where there are faces; vertex property `label`.
    * .xyz, .txt, .csv, .pts, .asc: one point a line, separated by blanks, commas or semicolons; names of
      columns are understood, further columns ignored.
    * .npy: array of shape (n, 3 to 16) or, row by row, (h, w, 3 to 16), of which the first three columns
      count; or a structured one, (n,) or (h, w), with the fields `x`, `y`, `z` and optionally `label`; or,
      with `intrinsics`, the depths of an image, (h, w) or (h, w, 1).
    * .npz: such an array `points` (or `xyz`), optionally `viewpoint` (3,) and `labels` (n,) or (h, w); or a
      single such array of any name.
    * .png, .tif, .tiff: depth image with one channel of 16 bits; in TIFF of 32 bits or floating point, too.
    * .obj, .stl, .off, .glb: mesh, anywhere, with the z axis up (.glb: the y axis, as glTF has it). The
      simulated sensor of `datasets.sensor.scan_mesh` looks at it from one side, always the same. Without
      faces, .obj and .off are point clouds.

    Points stand as in the file, but for their unit, those that were not measured included (NaN, infinite or
    exactly (0, 0, 0)); a depth image gives its pixels with a depth.

    A compressed file may unpack to a million points of 32 bytes, or to as many points as it has bytes; the
    environment variable SHAPECONCEPTS_MOST_POINTS sets another number instead of the million.

    Parameters
    ----------
    path : str or path
        The file.
    viewpoint : "auto", (3,) array-like or None
        Position of the sensor in the frame of the points, metres. "auto" takes it from the file where it can
        be true: outside of the points by a tenth of their extent. Files tell it as VIEWPOINT (.pcd), as the
        element `camera` (.ply), as the fields `vp_x`, `vp_y`, `vp_z` of the points, in a comment (``viewpoint
        0.1 0 0.5``; .ply and text), or as the array `viewpoint` (.npz). Where a file holds none, or only the
        (0, 0, 0) that writers put there by default, the origin is taken if the points look like a camera
        frame (z forward): all of them in front, within 45° of the z axis, and not nearer than 0.25 m or three
        times their radius. Otherwise, and with None, it is unknown.
    intrinsics : (fx, fy, cx, cy), optional
        Of a depth image: focal lengths and principal point in pixels. A Kinect's (525, 525, 319.5, 239.5) for
        images of 640 x 480 pixels, needed for any other size and for arrays.
    mask : path or (height, width) or (height, width, channels) array-like, optional
        Of a depth image: an image of its size (PNG, BMP, GIF, JPEG, PPM or TIFF), where the object is not 0
        (in any colour channel; opacity does not count). Arrays of points have none.
    depth_scale : float, optional
        Of a depth image: metres per unit, by default 0.001 (millimetres) for whole numbers, 1 for others.
    units : {"auto", "m", "cm", "mm", "in", "ft"} or float
        Of the coordinates in clouds and meshes; or metres per unit. "auto" takes them for millimetres where
        they can be nothing else, else for metres, and says so where that is not what a sensor sees of an
        object in metres; see `sources.units`. Coordinates in .glb are metres, as glTF has it.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        Of a mesh: the axis that points upwards, by default that of the format.

    Returns
    -------
    Scan
        With the path as its name and without a label.

    Raises
    ------
    ScanError
        If there is no scan in the file; the message names the file and the reason.
    ValueError
        If a parameter is out of range.

    Warns
    -----
    ScanWarning
        If something in the file is not what it should be, such as labels that are no numbers; see
        `Scan.notices`.
    """
    scan = read_scan_silently(
        path,
        viewpoint=viewpoint,
        intrinsics=intrinsics,
        mask=mask,
        depth_scale=depth_scale,
        units=units,
        up=up,
    )
    for notice in scan.notices:
        warnings.warn(f"{path} {notice}", ScanWarning, stacklevel=2)
    return scan


def read_scan_silently(path: str | PathLike[str], **options: Unpack[ReadOptions]) -> Scan:
    """As `read_scan`, without warnings: they are the scan's notices."""
    path, viewpoint = Path(path), options.get("viewpoint", "auto")
    position = None if isinstance(viewpoint, str) or viewpoint is None else _checked_position(viewpoint)
    if isinstance(viewpoint, str) and viewpoint != "auto":
        raise ValueError(f'viewpoint must be "auto", 3 numbers or None, got {viewpoint!r}')
    content = read_content(path, **options)
    with scan_errors(str(path), "read"):
        scan = _scan(path, content, metres_per_unit(options.get("units", "auto")), options.get("up"))
    return scan if isinstance(viewpoint, str) else replace(scan, viewpoint=position)


def read_content(path: Path, **options: Unpack[ReadOptions]) -> Cloud | Mesh:
    """What is in a file, in its own units; errors are those of `read_scan`."""
    suffix, intrinsics, mask = path.suffix.lower(), options.get("intrinsics"), options.get("mask")
    depth_scale = options.get("depth_scale")
    check_camera(intrinsics, depth_scale)
    metres_per_unit(options.get("units", "auto"))
    check_up(options.get("up"))
    if mask is not None and suffix not in (*DEPTH_SUFFIXES, ".npy"):
        raise ValueError(f"mask is for depth images ({' '.join(DEPTH_SUFFIXES)}), got one for {path}")
    with scan_errors(str(path), "read"):
        data = _content(path, suffix)
        depths = None if intrinsics is None or suffix != ".npy" else _read(path, lambda: depth_of_npy(data))
        if suffix in DEPTH_SUFFIXES:
            return _read(path, lambda: read_depth_image(data, intrinsics, mask, depth_scale))
        if depths is not None and intrinsics is not None:
            return _read(path, lambda: depth_cloud(depths, intrinsics, mask, depth_scale, len(data)))
        return _read(path, lambda: _READERS[suffix](data))


def scan_of_cloud(path: Path, cloud: Cloud, **options: Unpack[ReadOptions]) -> Scan:
    """The scan that a file's cloud is, see `read_scan`; points stay in their order."""
    with scan_errors(str(path), "read"):
        return _scan(path, cloud, metres_per_unit(options.get("units", "auto")), options.get("up"))


def read_views(
    path: str | PathLike[str], n_views: int, *, units: str | float = "auto", up: Up | None = None
) -> list[Scan]:
    """Scans of a mesh from sides spread over the sphere around it, see `datasets.views`.

    Parameters
    ----------
    path : str or path
        .obj, .stl, .off, .glb, or .ply with faces; see `read_scan`.
    n_views : int
        From 1.
    units, up
        As in `read_scan`.

    Returns
    -------
    list of Scan
        Empty where the file holds something else than a mesh.

    Raises
    ------
    ScanError
        If the file cannot be read, or the mesh not be scanned.
    ValueError
        If a parameter is out of range.
    """
    path, suffix = Path(path), Path(path).suffix.lower()
    scale = metres_per_unit(units)
    check_up(up)
    if suffix not in MESH_SUFFIXES:
        return []
    with scan_errors(str(path), "read"):
        data = _content(path, suffix)
        content = _read(path, lambda: _READERS[suffix](data))
        if isinstance(content, Cloud):
            return []
        vertices, notices = _placed(content, suffix, scale, up)
        return [
            replace(view, notices=notices) for view in views(vertices, content.faces, n_views, name=str(path))
        ]


def _scan(path: Path, cloud: Cloud | Mesh, scale: float | None, up: Up | None) -> Scan:
    if isinstance(cloud, Mesh):
        vertices, notices = _placed(cloud, path.suffix.lower(), scale, up)
        return replace(scan_mesh(vertices, cloud.faces, random_state=0, name=str(path)), notices=notices)
    if cloud.pixels is not None:
        # Depth images have a scale of their own, and their camera is the viewpoint.
        return _scan_of_cloud(path, cloud, cloud.viewpoint)
    if scale is None:
        scale, notices = unit_of_cloud(cloud.points, cloud.viewpoint)
        cloud = cloud._replace(notices=(*cloud.notices, *notices))
    if scale != 1.0:
        with np.errstate(over="ignore"):
            viewpoint = None if cloud.viewpoint is None else in_metres(cloud.viewpoint, scale)
            cloud = cloud._replace(points=in_metres(cloud.points, scale), viewpoint=viewpoint)
    return _scan_of_cloud(path, cloud, viewpoint_of(cloud.points, cloud.viewpoint))


def _scan_of_cloud(path: Path, cloud: Cloud, viewpoint: np.ndarray | None) -> Scan:
    if len(cloud.points) == 0:
        raise ScanError(f"{path}: holds no points")
    if not measured_rows(cloud.points).any():
        raise ScanError(f"{path}: holds no point with finite x, y and z")
    return Scan(cloud.points, viewpoint, str(path), point_labels=cloud.point_labels, notices=cloud.notices)


def _placed(
    mesh: Mesh, suffix: str, scale: float | None, up: Up | None
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Vertices in metres, z upwards, and what there is to say of their unit."""
    notices: tuple[str, ...] = ()
    if scale is None:
        scale, notices = (1.0, ()) if suffix in _IN_METRES else unit_of_mesh(mesh.vertices)
    upright = turned_upright(mesh.vertices, up or _UP_OF_FORMAT.get(suffix, "z"))
    return in_metres(upright, scale), notices


def _read(path: Path, read: Callable[[], Content]) -> Content:
    try:
        return read()
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None


def _checked_position(viewpoint: ArrayLike) -> np.ndarray:
    position = np.asarray(viewpoint)
    if position.shape != (3,) or position.dtype.kind not in "fiu" or not np.isfinite(position).all():
        raise ValueError(f'viewpoint must be "auto", 3 finite numbers or None, got {viewpoint!r}')
    return position.astype(np.float64)


def _content(path: Path, suffix: str) -> bytes:
    if os.path.isdir(path):
        raise ScanError(f"{path}: is a folder, read_scans reads those")
    if suffix not in SCAN_SUFFIXES and os.path.exists(path):
        reason = refusal_of_format(suffix)
        known = f"the format {suffix or 'without a suffix'} is not known, only {' '.join(SCAN_SUFFIXES)}"
        raise ScanError(f"{path}: {reason or known}")
    try:
        data = read_regular_file(path)
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None
    if not data:
        raise ScanError(f"{path}: is empty")
    if pointer := pointer_in(data):
        raise ScanError(f"{path}: {pointer}")
    return data
