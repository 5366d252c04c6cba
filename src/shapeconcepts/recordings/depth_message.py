"""Depths in an Image or CompressedImage message, metres."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.depth_image import METRES, MILLIMETRES, png_depths
from shapeconcepts.scan import ScanError

# Type of a pixel, and metres per unit.
_ENCODINGS = {"16UC1": ("u2", MILLIMETRES), "mono16": ("u2", MILLIMETRES), "32FC1": ("f4", METRES)}
# What sensors of 16 bits write where they measure nothing, beside 0.
_SATURATED = 2**16 - 1
_TRANSPORT = "compressedDepth"
# A number that is not used, and the parameters of the quantisation.
_HEADER = struct.Struct("<i2f")
_PNG_START = b"\x89PNG"


def refusal_of_encoding(encoding: str) -> str:
    """Why an Image with this encoding is not read; empty where it is."""
    if encoding in _ENCODINGS:
        return ""
    return f"holds images of the encoding {encoding!r}, expected depths: {' or '.join(_ENCODINGS)}"


def refusal_of_format(form: str, data: bytes) -> str:
    """Why a CompressedImage with this format, whose data begin so, is not read; empty where it is."""
    encoding, is_depth = _encoding(form), _TRANSPORT in form
    if is_depth and "rvl" in form:
        return f"holds images of the format {form!r}; of compressed depths, only png is read"
    if encoding not in (*_ENCODINGS, ""):
        return refusal_of_encoding(encoding).replace("encoding", "format", 1)
    # Bytes 24 and 25 of a PNG image are its bits and its colour type: 16 in grey.
    image = data[_HEADER.size :] if is_depth else data
    if image.startswith(_PNG_START) and (image[24:26] == b"\x10\0" or len(image) < 26):
        return ""
    return f"holds images of the format {form!r}, expected depths: PNG with one channel of 16 bits"


def image_depths(message: Any) -> NDArray[np.float64]:
    """Depths (h, w) of an Image, metres, NaN where nothing was measured.

    Raises
    ------
    ScanError
        If the message does not hold what it says; without a name.
    """
    if refusal := refusal_of_encoding(encoding := str(message.encoding)):
        raise ScanError(refusal)
    height, width, step = int(message.height), int(message.width), int(message.step)
    letters, scale = _ENCODINGS[encoding]
    kind = np.dtype((">" if message.is_bigendian else "<") + letters)
    if height * width == 0:
        raise ScanError(f"holds no pixels ({width} x {height})")
    if step < width * kind.itemsize:
        raise ScanError(f"has step {step}, expected at least {width} pixels of {kind.itemsize} bytes")
    needed = (height - 1) * step + width * kind.itemsize
    if needed > len(message.data):
        raise ScanError(
            f"has {len(message.data)} bytes of data, expected at least {needed} for {width} x {height} pixels"
        )
    pixels: NDArray[Any] = np.ndarray((height, width), kind, message.data, 0, (step, kind.itemsize))
    return _metres(pixels, scale)


def compressed_depths(message: Any) -> NDArray[np.float64]:
    """Depths (h, w) of a CompressedImage, as `image_depths` gives them.

    That is a PNG image of 16 bits, alone, in millimetres, or behind the header of `compressedDepth`. Of
    32FC1, that header says how inverse depths were quantised.
    """
    form, data = str(message.format), message.data.tobytes()
    if refusal := refusal_of_format(form, data):
        raise ScanError(refusal)
    if _TRANSPORT not in form:
        return _metres(png_depths(data), MILLIMETRES)
    if len(data) <= _HEADER.size:
        raise ScanError(f"has {len(data)} bytes of data, expected a header of {_HEADER.size} and an image")
    pixels = png_depths(data[_HEADER.size :])
    if _encoding(form) != "32FC1":
        return _metres(pixels, MILLIMETRES)
    _, factor, offset = _HEADER.unpack_from(data)
    # In single precision, as image_transport does it.
    with np.errstate(all="ignore"):
        depths = np.float32(factor) / (pixels.astype(np.float32) - np.float32(offset))
    return _metres(np.where(pixels == 0, np.float32(np.nan), depths), METRES)


def _encoding(form: str) -> str:
    """Encoding in a format such as "16UC1; compressedDepth png"; empty where there is none in it."""
    encoding = form.partition(";")[0].strip()
    return "" if encoding in ("png", _TRANSPORT) else encoding


def _metres(pixels: NDArray[Any], scale: float) -> NDArray[np.float64]:
    depths = pixels.astype(np.float64)
    with np.errstate(invalid="ignore"):
        missing = ~((depths > 0.0) & (depths < (np.inf if pixels.dtype.kind == "f" else _SATURATED)))
    depths *= scale
    depths[missing] = np.nan
    return depths
