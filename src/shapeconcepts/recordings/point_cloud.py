"""Coordinates and labels of a PointCloud2 message, whatever its layout."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError

# By the numbers that sensor_msgs/PointField has for them.
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
_FLOATS = (7, 8)
_AXES = ("x", "y", "z")
_LABEL = "label"


def cloud_points(
    message: Any,
) -> tuple[NDArray[np.float64], NDArray[np.int64] | None, tuple[str, ...]]:
    """Points of a message, equal to the bit, their labels, and notices.

    Parameters
    ----------
    message : sensor_msgs/PointCloud2
        As rosbags makes it.

    Returns
    -------
    points : (n, 3) or, of an organised cloud, (h, w, 3) float64
        Metres, in the frame of the message.
    labels : (n,) or (h, w) int64, or None
        The field `label`, where it is there and of a whole type.
    notices : tuple of str
        As of `Scene`.

    Raises
    ------
    ScanError
        If the message does not hold what it says; without a name.
    """
    height, width = int(message.height), int(message.width)
    fields: dict[str, Any] = {}
    for field in message.fields:
        fields.setdefault(str(field.name), field)
    if missing := [axis for axis in _AXES if axis not in fields]:
        raise ScanError(
            f"has no field {' '.join(missing)}, expected x, y and z, got {_listed(fields) or 'none'}"
        )
    if height * width == 0:
        raise ScanError(f"holds no points ({width} x {height})")
    for axis in _AXES:
        if fields[axis].datatype not in _FLOATS:
            raise ScanError(
                f"has the field {axis} of type {fields[axis].datatype}, expected float32 or float64"
            )
    grid = _Grid(message, height, width)
    shape = (height, width) if height > 1 else (width,)
    # Views: that all of them lie within the data is known before anything is allocated.
    axes = [grid.values(fields[axis]) for axis in _AXES]
    points = np.empty((*shape, 3))
    for column, values in enumerate(axes):
        points[..., column] = values.reshape(shape)
    if _LABEL not in fields:
        return points, None, ()
    if fields[_LABEL].datatype in _FLOATS or fields[_LABEL].datatype not in _TYPES:
        notice = "has a field label that is of no whole type: it is left out"
        return points, None, (notice,)
    return points, grid.values(fields[_LABEL]).reshape(shape).astype(np.int64), ()


class _Grid:
    """The bytes of a message, row by row with gaps between and within points."""

    def __init__(self, message: Any, height: int, width: int) -> None:
        self._data = message.data
        self._order = ">" if message.is_bigendian else "<"
        self._shape = (height, width)
        self._point_step = int(message.point_step)
        # A single row needs no distance to the next one, and some drivers leave it 0.
        self._row_step = int(message.row_step) if height > 1 else width * self._point_step
        if self._row_step < width * self._point_step:
            raise ScanError(
                f"has row_step {self._row_step}, expected at least {width} points of {self._point_step} bytes"
            )

    def values(self, field: Any) -> NDArray[Any]:
        """A view (h, w) of one field, of the type that it has."""
        kind = np.dtype(self._order + _TYPES[field.datatype])
        begin = int(field.offset)
        if field.count > 1:
            raise ScanError(f"has {field.count} values in the field {field.name}, expected 1")
        if begin + kind.itemsize > self._point_step:
            raise ScanError(
                f"has the field {field.name} at bytes {begin} to {begin + kind.itemsize} of a point, "
                f"expected within point_step {self._point_step}"
            )
        height, width = self._shape
        needed = (height - 1) * self._row_step + (width - 1) * self._point_step + begin + kind.itemsize
        if needed > len(self._data):
            raise ScanError(
                f"has {len(self._data)} bytes of data, expected at least {needed} for {width} x {height} "
                "points"
            )
        steps = (self._row_step, self._point_step)
        return np.ndarray(self._shape, kind, self._data, begin, steps)


def _listed(fields: dict[str, Any]) -> str:
    return " ".join(fields)[:100]
