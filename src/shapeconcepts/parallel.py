"""Work on many items in several jobs: the one place where the package does anything in parallel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sized
from itertools import islice
from typing import TypeVar

from joblib import Parallel, delayed, effective_n_jobs

Item = TypeVar("Item")
Result = TypeVar("Result")

# Items that are sent at once: enough that sending costs nothing beside the work, few enough that all jobs end
# at the same time.
MOST_AT_ONCE = 32
_CHUNKS_PER_JOB = 4
_AT_ONCE_FROM_A_STREAM = 8
# Kernels run without the lock of Python, so that a few threads keep as many cores busy, and are neither
# started nor sent anything. It is held for a sixth of the time: beyond these, processes do more.
MOST_THREADS = 4


def map_in_order(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    n_jobs: int | None = None,
    *,
    share_memory: bool = False,
) -> Iterator[Result]:
    """Results of work on items, in their order.

    A few jobs are threads, more are processes (loky), unless ``joblib.parallel_config(backend=...)`` says
    otherwise, which reaches a cluster. Work is sent along with each chunk of items: it should carry
    parameters, not data.

    Parameters
    ----------
    work : callable
        Of one item.
    items : iterable
        Taken a few chunks ahead of the results.
    n_jobs : int or None
        As in joblib. The results do not depend on it.
    share_memory : bool
        Work that carries data: it is done by threads, however many.
    """
    n_jobs = effective_n_jobs(n_jobs)
    if n_jobs == 1:
        yield from map(work, items)
        return
    at_once = _AT_ONCE_FROM_A_STREAM
    if isinstance(items, Sized):
        at_once = min(max(len(items) // (_CHUNKS_PER_JOB * n_jobs), 1), MOST_AT_ONCE)
    remaining = iter(items)
    chunks = iter(lambda: list(islice(remaining, at_once)), [])
    tasks = (delayed(_work_on)(work, chunk) for chunk in chunks)
    prefer = "threads" if share_memory or n_jobs <= MOST_THREADS else "processes"
    for results in Parallel(n_jobs, prefer=prefer, return_as="generator")(tasks):
        yield from results


def _work_on(work: Callable[[Item], Result], chunk: list[Item]) -> list[Result]:
    return [work(item) for item in chunk]
