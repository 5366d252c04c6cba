"""Reads one scan from a file of any known format."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from shapeconcepts.io.cloud import Cloud
from shapeconcepts.io.depth_image import Intrinsics, Mask, check_camera, read_depth_image
from shapeconcepts.io.mesh import Mesh
from shapeconcepts.io.mesh_library import read_glb, read_stl
from shapeconcepts.io.mesh_text import read_obj, read_off
from shapeconcepts.io.numpy_file import read_npy, read_npz
from shapeconcepts.io.pcd import read_pcd
from shapeconcepts.io.ply import read_ply
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.io.text_table import read_text_table
from shapeconcepts.io.viewpoint import finite_rows
from shapeconcepts.scan import Scan, ScanError, scan_errors
from shapeconcepts.simulation.sensor import scan_mesh
from shapeconcepts.simulation.views import views

Viewpoint = ArrayLike | Literal["auto"] | None

_READERS: dict[str, Callable[[bytes], Cloud | Mesh]] = {
    ".pcd": read_pcd,
    ".ply": read_ply,
    ".xyz": read_text_table,
    ".txt": read_text_table,
    ".csv": read_text_table,
    ".npy": read_npy,
    ".npz": read_npz,
    ".obj": read_obj,
    ".stl": read_stl,
    ".off": read_off,
    ".glb": read_glb,
}
SCAN_SUFFIXES = (*_READERS, ".png")
MESH_SUFFIXES = (".ply", ".obj", ".stl", ".off", ".glb")


def read_scan(
    path: str | PathLike[str],
    *,
    viewpoint: Viewpoint = "auto",
    intrinsics: Intrinsics | None = None,
    mask: Mask | None = None,
    depth_scale: float = 0.001,
) -> Scan:
    """Read one scan; the suffix of the file tells its format.

    * .pcd: ascii, binary or binary_compressed; the field `label` becomes `Scan.point_labels`.
    * .ply: ascii or binary; a point cloud, or a mesh where there are faces; vertex property `label`.
    * .xyz, .txt, .csv: one point a line, separated by blanks, commas or semicolons; names of columns are
      understood, further columns ignored.
    * .npy: array of shape (n, 3 or more) or, row by row, (h, w, 3 or more), of which the first three columns
      count; or a structured one, (n,) or (h, w), with the fields `x`, `y`, `z` and optionally `label`.
    * .npz: such an array `points`, optionally `viewpoint` (3,) and `labels` (n,) or (h, w); or a single such
      array of any name.
    * .png: depth image with 16 bits.
    * .obj, .stl, .off, .glb: mesh in metres, anywhere, with the z axis up (.glb: the y axis, as glTF has it).
      The simulated sensor of `datasets.sensor.scan_mesh` looks at it from one side, always the same.

    Points stand as in the file, non-finite ones included; a depth image gives its pixels with a depth.

    A compressed file may unpack to a million points of 32 bytes, or to as many points as it has bytes; the
    environment variable SHAPECONCEPTS_MOST_POINTS sets another number instead of the million.

    Parameters
    ----------
    path : str or path
        The file.
    viewpoint : "auto", (3,) array-like or None
        Position of the sensor in the frame of the points. "auto" takes it from the file where it can be true:
        outside of the points by a tenth of their extent. Where a file holds none, or only the (0, 0, 0) that
        writers put there by default, the origin is taken if the points look like a camera frame (z forward):
        all of them in front, within 45° of the z axis, and not nearer than 0.25 m or three times their
        radius. Otherwise, and with None, it is unknown.
    intrinsics : (fx, fy, cx, cy), optional
        Of a depth image: focal lengths and principal point in pixels. A Kinect's (525, 525, 319.5, 239.5) for
        640 x 480 pixels, needed for any other size.
    mask : path or (height, width) or (height, width, channels) array-like, optional
        Of a depth image: an image of its size (PNG, BMP, GIF, JPEG, PPM or TIFF), where the object is not 0
        (in any colour channel; opacity does not count).
    depth_scale : float
        Of a depth image: metres per unit, by default 0.001 (millimetres).

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
    """
    path, suffix = Path(path), Path(path).suffix.lower()
    check_camera(intrinsics, depth_scale)
    if mask is not None and suffix != ".png":
        raise ValueError(f"mask is for depth images (.png), got one for {path}")
    position = None if isinstance(viewpoint, str) or viewpoint is None else _checked_position(viewpoint)
    if isinstance(viewpoint, str) and viewpoint != "auto":
        raise ValueError(f'viewpoint must be "auto", 3 numbers or None, got {viewpoint!r}')

    with scan_errors(str(path), "read"):
        data = _content(path, suffix)
        if suffix == ".png":
            scan = _scan(path, lambda: read_depth_image(data, intrinsics, mask, depth_scale))
        else:
            scan = _scan(path, lambda: _READERS[suffix](data))
    return scan if isinstance(viewpoint, str) else replace(scan, viewpoint=position)


def read_views(path: str | PathLike[str], n_views: int) -> list[Scan]:
    """Scans of a mesh from sides spread over the sphere around it, see `datasets.views`.

    Parameters
    ----------
    path : str or path
        .obj, .stl, .off, .glb, or .ply with faces; see `read_scan`.
    n_views : int
        From 1.

    Returns
    -------
    list of Scan
        Empty where the file holds something else than a mesh.

    Raises
    ------
    ScanError
        If the file cannot be read, or the mesh not be scanned.
    ValueError
        If `n_views` is not a positive integer.
    """
    path, suffix = Path(path), Path(path).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        return []
    with scan_errors(str(path), "read"):
        data = _content(path, suffix)
        content = _read(path, lambda: _READERS[suffix](data))
        if isinstance(content, Cloud):
            return []
        return views(content.vertices, content.faces, n_views, name=str(path))


def _scan(path: Path, read: Callable[[], Cloud | Mesh]) -> Scan:
    content = _read(path, read)
    if isinstance(content, Cloud):
        return Scan(content.points, content.viewpoint, str(path), None, content.point_labels)
    return scan_mesh(content.vertices, content.faces, random_state=0, name=str(path))


def _read(path: Path, read: Callable[[], Cloud | Mesh]) -> Cloud | Mesh:
    try:
        content = read()
        if isinstance(content, Cloud):
            if len(content.points) == 0:
                raise ScanError("holds no points")
            if not finite_rows(content.points).any():
                raise ScanError("holds no point with finite x, y and z")
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None
    return content


def _checked_position(viewpoint: ArrayLike) -> np.ndarray:
    position = np.asarray(viewpoint)
    if position.shape != (3,) or position.dtype.kind not in "fiu" or not np.isfinite(position).all():
        raise ValueError(f'viewpoint must be "auto", 3 finite numbers or None, got {viewpoint!r}')
    return position.astype(np.float64)


def _content(path: Path, suffix: str) -> bytes:
    if os.path.isdir(path):
        raise ScanError(f"{path}: is a folder, read_scans reads those")
    if suffix not in SCAN_SUFFIXES and os.path.exists(path):
        raise ScanError(
            f"{path}: the format {suffix or 'without a suffix'} is not known, only {' '.join(SCAN_SUFFIXES)}"
        )
    try:
        data = read_regular_file(path)
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None
    if not data:
        raise ScanError(f"{path}: is empty")
    return data
