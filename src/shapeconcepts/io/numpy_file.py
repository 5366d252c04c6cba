"""Reads NumPy files: NPY, and NPZ with the arrays `points`, `viewpoint` and `labels`."""

from __future__ import annotations

import zipfile
from io import BytesIO
from math import prod

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from shapeconcepts.io.cloud import LABEL_NAMES, Cloud
from shapeconcepts.io.unpacking import check_unpacked
from shapeconcepts.io.viewpoint import camera_frame_viewpoint, declared_viewpoint
from shapeconcepts.scan import ScanError, whole_numbers

# Members are unpacked piece by piece, straight to their place.
PIECE = 2**20
LONGEST_HEADER = 2**17


def read_npy(data: bytes) -> Cloud:
    """Cloud from an array of shape (n, 3 or more) or (h, w, 3 or more); ScanError says what is wrong."""
    array = _array(data)
    points, labels = _points(array), _label_field(array)
    return Cloud(points, camera_frame_viewpoint(points), None if labels is None else whole_numbers(labels))


def read_npz(data: bytes) -> Cloud:
    """Cloud from an archive with the array `points`, optionally `viewpoint` and `labels`.

    The only array of an archive is taken for the points whatever its name.
    ScanError says what is wrong with it. A given viewpoint is believed where it is outside of the cloud.
    """
    try:
        archive = zipfile.ZipFile(BytesIO(data))
    except Exception as error:  # zipfile raises struct.error, ValueError and others beside BadZipFile
        raise ScanError(f"is not an NPZ archive ({error})") from None
    names = archive.namelist()
    members = {
        name: f"{name}.npy" for name in ("points", "viewpoint", *LABEL_NAMES) if f"{name}.npy" in names
    }
    if not members and len(names) == 1:
        members["points"] = names[0]
    if "points" not in members:
        raise ScanError(f"has no array points, only {', '.join(names[:10]) or 'nothing'}")
    n_bytes = sum(archive.getinfo(name).file_size for name in members.values())
    check_unpacked(n_bytes, len(data))
    arrays = {name: _array(_member(archive, member)) for name, member in members.items()}
    array = arrays.pop("points")
    shape = array.shape if array.dtype.names else array.shape[:-1]
    check_unpacked(n_bytes, len(data), prod(shape))
    points = _points(array)
    label_field = None if arrays.keys() & set(LABEL_NAMES) else _label_field(array)
    if label_field is not None:
        label_field = whole_numbers(label_field)
    # It can fill the memory.
    del array
    if "viewpoint" in arrays:
        position = arrays["viewpoint"]
        if position.shape != (3,) or position.dtype.names:
            raise ScanError(
                f"the array viewpoint must be 3 numbers, got {position.dtype} of shape {position.shape}"
            )
        viewpoint = declared_viewpoint(points, position.astype(np.float64))
    else:
        viewpoint = camera_frame_viewpoint(points)
    labels = next((arrays[name] for name in LABEL_NAMES if name in arrays), None)
    if labels is not None and labels.shape not in (shape, (len(points),)):
        raise ScanError(f"the labels must have the shape {shape}, got {labels.shape}")
    labels = label_field if labels is None else labels.reshape(-1)
    return Cloud(points, viewpoint, None if labels is None else whole_numbers(labels))


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
        with np.errstate(over="ignore"):
            for column, axis in enumerate("xyz"):
                points[:, column] = _field(array, axis)
        return points
    if array.ndim == 2 and array.shape[0] == 3 < array.shape[1]:
        raise ScanError(f"holds an array of shape {array.shape}, (n, 3) is expected, got (3, n)")
    if array.ndim not in (2, 3) or array.shape[-1] < 3:
        raise ScanError(f"holds an array of shape {array.shape}, (n, 3) is expected")
    array = array.reshape(-1, array.shape[-1])
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array[:, :3], dtype=np.float64)


def _label_field(array: NDArray) -> NDArray | None:
    name = next((name for name in LABEL_NAMES if name in (array.dtype.names or ())), None)
    return None if name is None else _field(array, name)


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
