"""Reads depth images: PNG and TIFF with one channel, and arrays."""

from __future__ import annotations

import re
import struct
from io import BytesIO
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from shapeconcepts.io.cloud import Cloud
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.io.unpacking import check_unpacked
from shapeconcepts.scan import ScanError

# Focal lengths and principal point of a Kinect, pixels (the factory values that ROS and PCL assume).
KINECT_INTRINSICS = (525.0, 525.0, 319.5, 239.5)
KINECT_SIZE = (640, 480)
DEPTH_SUFFIXES = (".png", ".tif", ".tiff")
# Pillow knows more, and starts other programs for some of them.
PNG, TIFF = ("PNG",), ("TIFF",)
MASK_SUFFIXES = (".png", ".bmp", ".gif", ".jpg", ".jpeg", ".ppm", ".tif", ".tiff")
MASK_FORMATS = ("PNG", "BMP", "GIF", "JPEG", "PPM", "TIFF")
# One channel of 16 or 32 bits, or of floating point numbers.
TIFF_MODES = ("I;16", "I;16B", "I;16L", "I", "F")
# More pixels than any depth camera has.
MOST_PIXELS = 2**23
# Metres per unit: whole numbers are mostly millimetres, others metres.
MILLIMETRES, METRES = 0.001, 1.0
# What sensors of 16 bits write where they measure nothing, beside 0.
_SATURATED = 2**16 - 1
# Metres. Depth cameras measure objects within.
_USUAL_DEPTHS = (0.1, 10.0)

Intrinsics = tuple[float, float, float, float]
Mask = ArrayLike | str | PathLike[str]


def check_camera(intrinsics: Intrinsics | None, depth_scale: float | None) -> None:
    """Raise ValueError where a parameter is out of range."""
    if intrinsics is not None:
        values = np.asarray(intrinsics, dtype=np.float64)
        if values.shape != (4,) or not np.isfinite(values).all() or not (values[:2] > 0.0).all():
            raise ValueError(
                "intrinsics must be 4 finite numbers (fx, fy, cx, cy) in pixels, fx and fy > 0, "
                f"got {intrinsics!r}"
            )
    if depth_scale is not None and not 0.0 < depth_scale < np.inf:
        raise ValueError(f"depth_scale must be metres per unit of depth, > 0, got {depth_scale!r}")


def read_depth_image(
    data: bytes, intrinsics: Intrinsics | None, mask: Mask | None, depth_scale: float | None
) -> Cloud:
    """Cloud of an image in PNG or TIFF, see `depth_cloud`; ScanError says what is wrong with it."""
    is_png = data.startswith(b"\x89PNG")
    width, height = png_depth_size(data) if is_png else _tiff_depth_size(data)
    if intrinsics is None:
        if (width, height) != KINECT_SIZE:
            raise ScanError(f"is {width} x {height} pixels; intrinsics are needed for all but 640 x 480")
        intrinsics = KINECT_INTRINSICS
    return depth_cloud(_pixels(data, PNG if is_png else TIFF), intrinsics, mask, depth_scale, len(data))


def depth_cloud(
    depth: NDArray, intrinsics: Intrinsics, mask: Mask | None, depth_scale: float | None, file_size: int
) -> Cloud:
    """Cloud of the pixels (h, w) that have a depth and lie in the mask, row by row.

    Not measured are 0 and less, NaN and infinity, and the largest number of 16 bits. Points are in the camera
    frame (x right, y down, z forward), and the camera is the viewpoint. ScanError says what is wrong.
    """
    if depth_scale is None:
        depth_scale = METRES if depth.dtype.kind == "f" else MILLIMETRES
    measured = (depth > 0) & np.isfinite(depth)
    if depth.dtype.kind != "f" and depth.dtype.itemsize == 2:
        measured &= depth != _SATURATED
    if mask is not None:
        measured &= _mask(mask, (depth.shape[0], depth.shape[1]))
    n_points = int(np.count_nonzero(measured))
    if n_points == 0:
        raise ScanError(
            "has no pixel with a depth" if mask is None else "has no pixel with a depth in its mask"
        )
    check_unpacked(depth.nbytes, file_size, n_points)
    rows, columns = np.nonzero(measured)
    fx, fy, cx, cy = intrinsics
    points = np.empty((len(rows), 3))
    with np.errstate(over="ignore", invalid="ignore"):
        points[:, 2] = z = depth[rows, columns].astype(np.float64) * depth_scale
        points[:, 0] = (columns - cx) / fx * z
        points[:, 1] = (rows - cy) / fy * z
    pixels = rows * depth.shape[1] + columns
    notices = _unusual_depth(float(np.median(z)))
    return Cloud(points, np.zeros(3), None, notices, (depth.shape[0], depth.shape[1]), pixels)


def _unusual_depth(median: float) -> tuple[str, ...]:
    if _USUAL_DEPTHS[0] <= median <= _USUAL_DEPTHS[1]:
        return ()
    return (f"has a median depth of {median:.3g} m: the depth scale (--depth-scale) may be another",)


def png_depth_size(data: bytes) -> tuple[int, int]:
    """Width and height from the PNG header, before a library allocates them; ScanError if there is none."""
    if len(data) < 33 or not data.startswith(b"\x89PNG\r\n\x1a\n") or data[12:16] != b"IHDR":
        raise ScanError("is not a PNG image")
    width, height, bits, colour = struct.unpack_from(">IIBB", data, 16)
    if (bits, colour) != (16, 0):
        raise ScanError("is not a depth image: one channel of 16 bits is expected")
    return _checked_size(width, height)


def png_depths(data: bytes) -> NDArray:
    """Pixels (h, w) of a PNG image with one channel of 16 bits; ScanError says what is wrong with it."""
    png_depth_size(data)
    return _pixels(data, PNG)


def _tiff_depth_size(data: bytes) -> tuple[int, int]:
    try:
        with Image.open(BytesIO(data), formats=TIFF) as image:
            size, mode = image.size, image.mode
    except Exception:  # Pillow raises SyntaxError, OSError, ValueError and others
        raise ScanError("is not a PNG image, nor a TIFF image") from None
    if mode not in TIFF_MODES:
        raise ScanError(f"is not a depth image: one channel of 16 or 32 bits is expected, got {mode}")
    return _checked_size(*size)


def _checked_size(width: int, height: int) -> tuple[int, int]:
    if width * height > MOST_PIXELS:
        raise ScanError(f"is {width} x {height} pixels, at most {MOST_PIXELS} are supported")
    return width, height


def _pixels(data: bytes, formats: tuple[str, ...], shape: tuple[int, int] | None = None) -> NDArray:
    try:
        with Image.open(BytesIO(data), formats=formats) as image:
            if shape is not None and image.size != shape[::-1]:
                raise ScanError(
                    f"is {image.width} x {image.height} pixels, the depth image {shape[1]} x {shape[0]}"
                )
            return np.asarray(image)
    except ScanError:
        raise
    except Exception as error:  # Pillow raises SyntaxError, OSError, ValueError and others
        # Of bytes in memory, Pillow tells where they lie.
        reason = re.sub(r" <_io\.BytesIO[^>]*>", "", str(error))
        raise ScanError(f"is no image that can be read ({reason})") from None


def _mask(mask: Mask, shape: tuple[int, int]) -> NDArray[np.bool_]:
    if isinstance(mask, str | PathLike):
        try:
            values = _pixels(read_regular_file(Path(mask)), MASK_FORMATS, shape)
        except ScanError as error:
            raise ScanError(f"the mask {Path(mask)} {error}") from None
    else:
        values = np.asarray(mask)
    if values.ndim == 3 and 1 <= values.shape[2] <= 4:
        # Of two or four channels, the last one is the opacity.
        colours = values[:, :, : 1 if values.shape[2] <= 2 else 3]
        values = (colours != 0).any(axis=2)
    if values.shape != shape:
        raise ScanError(f"the mask must be an image of shape {shape}, got {values.shape}")
    return values != 0
