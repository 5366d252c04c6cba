"""Work on many objects in several jobs."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

from joblib import Parallel, delayed, effective_n_jobs

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_chunks(
    function: Callable[..., list[Result]],
    items: list[Item],
    n_jobs: int | None,
    prefer: str | None,
    *arguments: object,
) -> list[Result]:
    """Apply a function of a list to equal shares of it, several for each job, so that none waits for long."""
    n_jobs = effective_n_jobs(n_jobs)
    if n_jobs == 1 or len(items) < 2:
        return function(items, *arguments)
    n_chunks = min(len(items), 4 * n_jobs)
    bounds = [i * len(items) // n_chunks for i in range(n_chunks + 1)]
    chunks = Parallel(n_jobs, prefer=prefer)(
        delayed(function)(items[start:end], *arguments) for start, end in pairwise(bounds)
    )
    return [result for chunk in chunks for result in chunk]
