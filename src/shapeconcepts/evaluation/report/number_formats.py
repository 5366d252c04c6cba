"""Numbers as they stand in the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from shapeconcepts.evaluation.report.compared_rows import smallest_median_largest

NOTHING = "–"


def percent(share: float | None) -> str:
    """A share with one decimal."""
    return NOTHING if share is None or not np.isfinite(share) else f"{100 * share:.1f} %"


def decimal(value: float | None) -> str:
    """A number with two decimals."""
    return NOTHING if value is None or not np.isfinite(value) else f"{value:.2f}"


def whole(value: float | None) -> str:
    """A count; a median of counts may end in a half."""
    return NOTHING if value is None or not np.isfinite(value) else f"{value:g}"


def median_and_range(values: Sequence[float], written: Callable[[float | None], str]) -> tuple[str, str]:
    """Median; and from the smallest to the largest, empty where these are alike in print."""
    low, middle, high = smallest_median_largest(values)
    bounds = [written(bound).removesuffix(" %") for bound in (low, high)]
    return written(middle), "" if bounds[0] == bounds[1] else "–".join(bounds)


def mean_error(errors: dict[str, list[float]]) -> list[float]:
    """Mean over the labels, of each repetition; labels without test objects do not count."""
    if not errors:
        return []
    table = np.array(list(errors.values()), dtype=float)
    known = np.isfinite(table)
    counts = known.sum(axis=0)
    sums = np.where(known, table, 0).sum(axis=0)
    return [float(s / n) if n else np.nan for s, n in zip(sums, counts, strict=True)]


def mean_of(values: Sequence[float]) -> float:
    """Mean of the values that are numbers, NaN where none is."""
    numbers = [value for value in values if np.isfinite(value)]
    return float(np.mean(numbers)) if numbers else np.nan
