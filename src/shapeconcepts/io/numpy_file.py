"""Reads NumPy files: NPY, and NPZ with the arrays `points`, `viewpoint` and `labels`."""

from __future__ import annotations

import zipfile
from io import BytesIO
from math import prod

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from shapeconcepts.io.cloud import LABEL_NAMES, VIEWPOINT_NAMES, Cloud, labels_or_notice, value_or_notice
from shapeconcepts.io.unpacking import check_unpacked
from shapeconcepts.io.viewpoint import common_position, unless_default
from shapeconcepts.scan import ScanError

# Members are unpacked piece by piece, straight to their place.
PIECE = 2**20
LONGEST_HEADER = 2**17
POINTS_NAMES = ("points", "xyz", "pc", "pcd", "point_cloud", "pointcloud", "cloud", "vertices", "pos")
POSITION_NAMES = ("viewpoint", "sensor_origin", "sensor_position", "camera_position", "camera_center")
# Coordinates with normals, colours, intensities and labels have no more columns.
MOST_COLUMNS = 16


def read_npy(data: bytes) -> Cloud:
    """Cloud from an array of shape (n, 3 or more) or (h, w, 3 or more); ScanError says what is wrong."""
    array = _array(data)
    labels, of_labels = labels_or_notice(lambda: _label_field(array))
    viewpoint, of_viewpoint = value_or_notice("a viewpoint", lambda: _viewpoint_fields(array))
    return Cloud(_points(array), viewpoint, labels, of_viewpoint + of_labels, _image_shape(array))


def depth_of_npy(data: bytes) -> NDArray | None:
    """The depths in an array of shape (h, w) or (h, w, 1); None where it holds something else."""
    array = _array(data)
    if array.dtype.names or not _is_image(array.shape):
        return None
    return array.reshape(array.shape[:2])


def read_npz(data: bytes) -> Cloud:
    """Cloud from an archive with the array `points`, optionally `viewpoint` and `labels`.

    Points may also be called as in `POINTS_NAMES`, the viewpoint as in `POSITION_NAMES`; the only array of an
    archive is taken for the points whatever its name. ScanError says what is wrong with it.
    """
    try:
        archive = zipfile.ZipFile(BytesIO(data))
    except Exception as error:  # zipfile raises struct.error, ValueError and others beside BadZipFile
        raise ScanError(f"is not an NPZ archive ({error})") from None
    names = archive.namelist()
    points_name = next((name for name in POINTS_NAMES if f"{name}.npy" in names), None)
    others = {name: f"{name}.npy" for name in (*POSITION_NAMES, *LABEL_NAMES) if f"{name}.npy" in names}
    if points_name is None and (others or len(names) != 1):
        raise ScanError(f"has no array points, only {', '.join(names[:10]) or 'nothing'}")
    member = names[0] if points_name is None else f"{points_name}.npy"
    n_bytes = sum(archive.getinfo(name).file_size for name in (member, *others.values()))
    check_unpacked(n_bytes, len(data))
    array = _array(_member(archive, member))
    shape = array.shape if array.dtype.names else array.shape[:-1]
    check_unpacked(n_bytes, len(data), prod(shape))
    points = _points(array)

    def declared() -> NDArray[np.float64] | None:
        name = next((name for name in POSITION_NAMES if name in others), None)
        if name is None:
            return _viewpoint_fields(array)
        position = _array(_member(archive, others[name]))
        if position.shape != (3,) or position.dtype.names:
            raise ScanError(
                f"the array {name} must be 3 numbers, got {position.dtype} of shape {position.shape}"
            )
        return position.astype(np.float64)

    def labels_of_points() -> NDArray | None:
        name = next((name for name in LABEL_NAMES if name in others), None)
        if name is None:
            return _label_field(array)
        labels = _array(_member(archive, others[name]))
        if labels.shape not in (shape, (len(points),)):
            raise ScanError(f"the labels must have the shape {shape}, got {labels.shape}")
        return labels.reshape(-1)

    viewpoint, of_viewpoint = value_or_notice("a viewpoint", declared)
    labels, of_labels = labels_or_notice(labels_of_points)
    return Cloud(points, viewpoint, labels, of_viewpoint + of_labels, _image_shape(array))


def _array(data: bytes | bytearray) -> NDArray:
    """Array of numbers in the bytes of an NPY file. np.load allocates before it looks into the file."""
    # Longer headers than this are refused; a stream over all of the data can be a copy of it.
    stream = BytesIO(data[:LONGEST_HEADER])
    try:
        version = npy_format.read_magic(stream)
        read_header = (
            npy_format.read_array_header_1_0 if version == (1, 0) else npy_format.read_array_header_2_0
        )
        shape, by_column, dtype = read_header(stream)
    except Exception as error:  # the header is a Python literal, which can fail in any way
        raise ScanError(f"is not an NPY file ({error})") from None
    if dtype.kind not in "fiub" and (not dtype.names or dtype.hasobject):
        raise ScanError(f"holds an array of {dtype}, numbers are expected")
    offset = stream.tell()
    if not all(type(size) is int and 0 <= size < 2**62 for size in shape):
        raise ScanError("is not an NPY file (its header has a shape that no array can have)")
    if len(shape) > 3:
        raise ScanError(f"holds an array of shape with {len(shape)} axes, (n, 3) is expected")
    if 0 in shape:
        raise ScanError(f"holds no points, only an array of shape {shape}")
    if prod(shape) * dtype.itemsize > len(data) - offset:
        raise ScanError(f"is truncated: the header promises an array {shape} of {dtype}, the file is smaller")
    return np.frombuffer(data, dtype, prod(shape), offset).reshape(shape, order="F" if by_column else "C")


def _points(array: NDArray) -> NDArray[np.float64]:
    if array.dtype.names:
        if array.ndim not in (1, 2):
            raise ScanError(f"holds fields in an array of shape {array.shape}, (n,) or (h, w) is expected")
        if array.dtype.itemsize < 3:
            raise ScanError(f"holds the fields of {array.size} points over each other")
        points = np.empty((array.size, 3))
        capitals = not set("xyz") & set(array.dtype.names)
        with np.errstate(over="ignore"):
            for column, axis in enumerate("XYZ" if capitals else "xyz"):
                points[:, column] = _field(array, axis)
        return points
    _check_shape(array)
    array = array.reshape(-1, array.shape[-1])
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array[:, :3], dtype=np.float64)


def _image_shape(array: NDArray) -> tuple[int, int] | None:
    """Height and width of an array that has a point for each pixel; None for others."""
    shape = array.shape if array.dtype.names else array.shape[:-1]
    return (shape[0], shape[1]) if len(shape) == 2 else None


def _check_shape(array: NDArray) -> None:
    """Raise ScanError unless the last axis holds coordinates, and perhaps more."""
    shape = array.shape
    what = f"holds an array of shape {shape}, (n, 3) is expected"
    if len(shape) in (2, 3) and shape[0] == 3 < shape[-1] and (len(shape) == 2 or shape[2] > MOST_COLUMNS):
        raise ScanError(f"{what}, got {'(3, n)' if len(shape) == 2 else '(3, h, w)'}")
    if _is_image(shape):
        raise ScanError(f"{what}; a depth image is read from .npy, with intrinsics (fx, fy, cx, cy)")
    if len(shape) not in (2, 3) or not 3 <= shape[-1] <= MOST_COLUMNS:
        raise ScanError(what)
    if len(shape) == 3 and array.dtype.itemsize == 1:
        raise ScanError(f"holds an image of {array.dtype}, which are colours or flags and no coordinates")


def _is_image(shape: tuple[int, ...]) -> bool:
    """Whether an array of this shape has one number for each pixel."""
    is_flat = len(shape) == 2 or (len(shape) == 3 and shape[2] == 1)
    return is_flat and min(shape[:2]) > MOST_COLUMNS


def _label_field(array: NDArray) -> NDArray | None:
    name = next((name for name in LABEL_NAMES if name in (array.dtype.names or ())), None)
    return None if name is None else _field(array, name)


def _viewpoint_fields(array: NDArray) -> NDArray[np.float64] | None:
    if not set(VIEWPOINT_NAMES) <= set(array.dtype.names or ()):
        return None
    return unless_default(common_position(_field(array, name) for name in VIEWPOINT_NAMES))


def _field(array: NDArray, name: str) -> NDArray:
    """One number for each point, in row order."""
    names = array.dtype.names or ()
    if name not in names:
        raise ScanError(f"has no field {name}, only {', '.join(names[:10])}")
    if array.dtype[name].kind not in "fiub":
        raise ScanError(f"the field {name} must hold numbers, got {array.dtype[name]}")
    return array[name].ravel()


def _member(archive: zipfile.ZipFile, name: str) -> bytearray:
    info = archive.getinfo(name)
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ScanError(f"{name} is compressed in a way that NPZ files are not")
    content = bytearray(info.file_size)
    n_read = 0
    try:
        with archive.open(info) as stream:
            while piece := stream.read(min(PIECE, info.file_size - n_read)):
                content[n_read : n_read + len(piece)] = piece
                n_read += len(piece)
    except Exception as error:  # zipfile and zlib have errors of their own
        raise ScanError(f"{name} is damaged ({error})") from None
    if n_read != info.file_size:
        raise ScanError(f"{name} is truncated: {n_read} of {info.file_size} bytes")
    return content
