"""A scan: what a sensor saw of one object from one place."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.printable import printable

# Parts of the diagonal that a point may be outside of the box around all others.
_AMONG = 0.1


class ScanError(ValueError):
    """A scan that cannot be used; the message names the file or scan and the reason.

    What the message quotes of names and files is made printable.
    """

    def __init__(self, message: object) -> None:
        super().__init__(printable(str(message)))


class ScanWarning(UserWarning):
    """Something about scans that should be looked at; the message is printable, as that of a ScanError.

    Some are skipped, or something in them is not what it should be, see `Scan.notices`.
    """

    def __init__(self, message: object) -> None:
        super().__init__(printable(str(message)))


@contextmanager
def scan_errors(name: str, step: str) -> Iterator[None]:
    """Turn whatever is raised within into a ScanError.

    What nobody foresaw in a scan must not end the work on a thousand others.

    Parameters
    ----------
    name : str
        Of the scan.
    step : str
        What is done to it, such as "read" or "segmented".
    """
    try:
        yield
    except ScanError:
        raise
    except MemoryError as error:
        raise ScanError(f"{name}: needs more memory than there is to be {step}") from error
    except Exception as error:
        raise ScanError(f"{name}: cannot be {step} ({type(error).__name__}: {error})") from error


def measured_rows(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Points (n, 3) that were measured, (n,) bool.

    Missing measurements are NaN, infinite, or, as many sensors write them, exactly at the origin. A single
    point there is one if it lies among the others, as in clouds around the origin, or alone.
    """
    # Ten times faster than all(axis=1).
    x, y, z = np.isfinite(points).T
    finite = x & y & z
    x, y, z = points.T != 0.0
    measured = finite & (x | y | z)
    n_at_origin = int(finite.sum() - measured.sum())
    if n_at_origin == 0:
        return measured
    if not measured.any() or (n_at_origin == 1 and _origin_is_among(points[measured])):
        return finite
    return measured


def _origin_is_among(points: NDArray[np.float64]) -> bool:
    """Whether the origin lies in the bounding box of points, or next to it."""
    low, high = points.min(axis=0), points.max(axis=0)
    with np.errstate(over="ignore"):
        margin = _AMONG * float(np.linalg.norm(high - low))
    return bool(((low - margin <= 0.0) & (high + margin >= 0.0)).all())


def whole_numbers(values: ArrayLike) -> NDArray[np.int64]:
    """Point labels as int64; ScanError where one is not a whole number or does not fit."""
    try:
        labels = np.asarray(values)
    except ValueError as error:  # rows of different lengths
        raise ScanError(f"point_labels must be numbers ({error})") from None
    if labels.dtype.kind == "f":
        # 2^63 itself is a float64 but no int64.
        whole = np.isfinite(labels) & (np.abs(labels) < 2.0**63)
        whole[whole] = labels[whole] % 1 == 0
        if not whole.all():
            raise ScanError(f"point_labels must be whole numbers, got {labels[~whole].flat[0]}")
    elif labels.dtype.kind not in "iub":
        raise ScanError(f"point_labels must be numbers, got {labels.dtype}")
    elif labels.dtype == np.uint64 and labels.size and labels.max() >= 2**63:
        raise ScanError(f"point_labels must be less than 2**63, got {labels.max()}")
    return labels.astype(np.int64)


def float_array(title: str, field: str, value: object) -> NDArray[np.float64]:
    """A copy of an array-like as float64; ScanError, with title and field, where it holds no numbers."""
    try:
        # A copy: the caller may go on with the array.
        return np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ScanError(f"{title}: {field} must be numbers ({error})") from None


@dataclass(frozen=True, eq=False)
class Scan:
    """A single-view point cloud of an object.

    Parameters
    ----------
    points : array-like of shape (n, 3)
        Coordinates in metres. Non-finite rows are allowed; preparation drops them.
    viewpoint : array-like of shape (3,), optional
        Position of the sensor in the same frame. None where it is not known.
    name : str
        Where the scan comes from, used in messages and reports.
    label : str, optional
        Category of the object, for evaluation only. Learning never looks at it.
    point_labels : array-like of int, or of whole floats, of shape (n,), optional
        True surface part of each point, where the source holds it.
    instance : str, optional
        Which physical object the scan shows, where the source tells. An evaluation keeps all scans of an
        instance on one side of a split. Learning never looks at it.
    notices : tuple of str
        What a reader of its file should know, such as a field that was left out: what was found, a colon, and
        what that means or can be done about it.

    Raises
    ------
    ScanError
        If the shapes do not fit, the viewpoint is not finite, or a point label is no whole number.
    """

    points: NDArray[np.float64]
    viewpoint: NDArray[np.float64] | None = None
    name: str = ""
    label: str | None = None
    point_labels: NDArray[np.int64] | None = None
    instance: str | None = None
    notices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        points = float_array(self._title(), "points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ScanError(f"{self._title()}: points must have shape (n, 3), got {points.shape}")
        object.__setattr__(self, "points", points)
        if self.viewpoint is not None:
            viewpoint = float_array(self._title(), "viewpoint", self.viewpoint)
            if viewpoint.shape != (3,) or not np.isfinite(viewpoint).all():
                raise ScanError(
                    f"{self._title()}: viewpoint must be 3 finite numbers, got {self.viewpoint!r}"
                )
            object.__setattr__(self, "viewpoint", viewpoint)
        if self.point_labels is not None:
            try:
                point_labels = whole_numbers(self.point_labels)
            except ScanError as error:
                raise ScanError(f"{self._title()}: {error}") from None
            if point_labels.shape != (len(points),):
                raise ScanError(
                    f"{self._title()}: point_labels must have shape ({len(points)},), "
                    f"got {point_labels.shape}"
                )
            object.__setattr__(self, "point_labels", point_labels)

    def _title(self) -> str:
        return self.name or "scan"

    def __len__(self) -> int:
        return len(self.points)
