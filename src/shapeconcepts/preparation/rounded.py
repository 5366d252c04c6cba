"""Coordinates far from the origin that were rounded when they were written.

Single precision has 24 binary digits: 447,123 m is rounded to 3 cm. C++ prints six decimal digits by default.
What that takes from a scan is lost.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError

ADVICE = "subtract an offset before they are written in single precision or with few digits"
# Steps as shares of the extent. Of scans with coordinates rounded to 1/25 of their extent as many have the
# concept of the exact ones as of those rounded to 1/1000 (88 %), from 1/15 on less than half.
NOTICED, REFUSED = 1 / 25, 1 / 15
# A few points lie on any lattice.
_FEWEST = 50
# How far, in steps, a number may be off the lattice: some programs print rounded numbers with few digits.
_OFF = 0.1
_DECIMAL_DIGITS = 6


def rounding_notices(points: NDArray[np.float64], name: str) -> tuple[str, ...]:
    """What to say of the precision of coordinates, see `Scan.notices`.

    Parameters
    ----------
    points : (n, 3) float64
        Finite and different, in the frame of the file, metres.
    name : str
        Of the scan.

    Raises
    ------
    ScanError
        If next to nothing is left of it.
    """
    if len(points) < _FEWEST:
        return ()
    # An axis may have lost all of its digits; but a single one may be that of a wall.
    is_constant = (points == points[0]).all(axis=0)
    columns = points.T if is_constant.sum() > 1 else points.T[~is_constant]
    step = max(_step(column) for column in columns)
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    if step < NOTICED * extent:
        return ()
    found = f"coordinates that are rounded to {step:.2g} m"
    if step >= REFUSED * extent:
        raise ScanError(f"{name}: has {found}, which leaves no shape of {extent:.2g} m: {ADVICE}")
    return (f"has {found} at an extent of {extent:.2g} m: {ADVICE}",)


def _step(column: NDArray[np.float64]) -> float:
    """The coarsest known lattice on which all coordinates of an axis lie; 0 for none."""
    largest = float(np.abs(column).max())
    if largest == 0.0:
        return 0.0
    return max((step for step in _steps(largest) if _lies_on(column, step)), default=0.0)


def _steps(largest: float) -> Iterator[float]:
    yield float(np.spacing(np.float32(largest)))
    yield 10.0 ** (np.floor(np.log10(largest)) + 1 - _DECIMAL_DIGITS)


def _lies_on(column: NDArray[np.float64], step: float) -> bool:
    quotients = column / step
    is_within_one = 0.0 < np.ptp(quotients) < 0.5
    return not is_within_one and bool((np.abs(quotients - np.rint(quotients)) <= _OFF).all())
