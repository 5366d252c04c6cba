"""Reads NumPy files: NPY, and NPZ with the arrays `points`, `viewpoint` and `labels`."""

from __future__ import annotations

import zipfile
from io import BytesIO
from math import prod

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from shapeconcepts.io.cloud import LABEL_NAMES, Cloud
from shapeconcepts.io.viewpoint import camera_frame_viewpoint, declared_viewpoint
from shapeconcepts.scan import ScanError, whole_numbers

# Point clouds hardly shrink below a tenth; an archive that unpacks to much more is made to fill the memory.
LARGEST_GROWTH = 100
SMALL_ENOUGH = 2**26


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
    arrays = {
        name: _array(_member(archive, f"{name}.npy"))
        for name in ("points", "viewpoint", *LABEL_NAMES)
        if f"{name}.npy" in names
    }
    if not arrays and len(names) == 1:
        arrays["points"] = _array(_member(archive, names[0]))
    if "points" not in arrays:
        raise ScanError(f"has no array points, only {', '.join(names[:10]) or 'nothing'}")
    # Bytes become numbers of eight bytes each.
    n_bytes = 8 * arrays["points"].size
    if n_bytes > max(LARGEST_GROWTH * len(data), SMALL_ENOUGH):
        raise ScanError(f"has {n_bytes} bytes of points in {len(data)} bytes of file")
    points = _points(arrays["points"])
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
    array = arrays["points"]
    shape = array.shape if array.dtype.names else array.shape[:-1]
    if labels is not None and labels.shape not in (shape, (len(points),)):
        raise ScanError(f"the labels must have the shape {shape}, got {labels.shape}")
    labels = _label_field(array) if labels is None else labels.reshape(-1)
    return Cloud(points, viewpoint, None if labels is None else whole_numbers(labels))


def _array(data: bytes) -> NDArray:
    """Array of numbers in the bytes of an NPY file. np.load allocates before it looks into the file."""
    stream = BytesIO(data)
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
        with np.errstate(over="ignore"):
            return np.column_stack([_field(array, axis).astype(np.float64) for axis in "xyz"])
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


def _member(archive: zipfile.ZipFile, name: str) -> bytes:
    info = archive.getinfo(name)
    if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ScanError(f"{name} is compressed in a way that NPZ files are not")
    if info.file_size > max(LARGEST_GROWTH * info.compress_size, SMALL_ENOUGH):
        raise ScanError(
            f"{name} says it unpacks from {info.compress_size} to {info.file_size} bytes, "
            f"more than {LARGEST_GROWTH} times as many"
        )
    try:
        with archive.open(info) as stream:
            content = stream.read(info.file_size)
    except Exception as error:  # zipfile and zlib have errors of their own
        raise ScanError(f"{name} is damaged ({error})") from None
    if len(content) != info.file_size:
        raise ScanError(f"{name} is truncated: {len(content)} of {info.file_size} bytes")
    return content
