"""A scene: what a sensor saw at one moment from one place, several objects among other things."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError, float_array, whole_numbers


@dataclass(frozen=True, eq=False)
class Scene:
    """A point cloud of a place with objects, as one frame of a depth camera gives it.

    Parameters
    ----------
    points : array-like of shape (n, 3) or, row by row of the image, (height, width, 3)
        Coordinates in metres; not finite where nothing was measured.
    viewpoint : array-like of shape (3,), optional
        Position of the sensor in the same frame. None where it is not known.
    up : array-like of shape (3,), optional
        Direction against gravity in the same frame, of any length. None where it is not known.
    name : str
        Where the scene comes from, used in messages and names of objects.
    time : float, optional
        When it was seen, seconds since 1970.
    point_labels : array-like of int, of the shape of the points without the last axis, optional
        True object of each point, where the source holds it. For evaluation only.
    notices : tuple of str
        As of `Scan`.

    Raises
    ------
    ScanError
        If the shapes do not fit, viewpoint or direction are not finite, or a label is no whole number.
    """

    points: NDArray[np.float64]
    viewpoint: NDArray[np.float64] | None = None
    up: NDArray[np.float64] | None = None
    name: str = ""
    time: float | None = None
    point_labels: NDArray[np.int64] | None = None
    notices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        title = self.name or "scene"
        points = float_array(title, "points", self.points)
        if points.ndim not in (2, 3) or points.shape[-1] != 3:
            raise ScanError(
                f"{title}: points must have shape (n, 3) or (height, width, 3), got {points.shape}"
            )
        object.__setattr__(self, "points", points)
        for field in ("viewpoint", "up"):
            if (given := getattr(self, field)) is None:
                continue
            vector = float_array(title, field, given)
            if vector.shape != (3,) or not np.isfinite(vector).all():
                raise ScanError(f"{title}: {field} must be 3 finite numbers, got {given!r}")
            object.__setattr__(self, field, vector)
        if self.up is not None:
            length = np.linalg.norm(self.up)
            if length == 0.0:
                raise ScanError(f"{title}: up must be a direction, got {self.up.tolist()}")
            object.__setattr__(self, "up", self.up / length)
        if self.time is not None and not np.isfinite(self.time):
            raise ScanError(f"{title}: time must be seconds since 1970, got {self.time!r}")
        if self.point_labels is not None:
            try:
                labels = whole_numbers(self.point_labels)
            except ScanError as error:
                raise ScanError(f"{title}: {error}") from None
            if labels.shape != points.shape[:-1]:
                raise ScanError(
                    f"{title}: point_labels must have shape {points.shape[:-1]}, got {labels.shape}"
                )
            object.__setattr__(self, "point_labels", labels)

    @property
    def is_organised(self) -> bool:
        """Whether points stand row by row as the pixels of an image."""
        return self.points.ndim == 3
