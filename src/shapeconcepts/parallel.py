"""Work on many items in several jobs: the one place where the package does anything in parallel."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sized
from contextlib import contextmanager
from functools import partial
from itertools import chain, islice
from multiprocessing import resource_tracker
from threading import RLock
from typing import TypeVar

from joblib import Parallel, delayed, effective_n_jobs
from joblib._parallel_backends import LokyBackend
from joblib.externals.loky.backend import resource_tracker as loky_resource_tracker
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from shapeconcepts.cluster import active_cluster, map_on_cluster
from shapeconcepts.interruption import end_with_parent, signals_kept_from_children, uninterrupted

Item = TypeVar("Item")
Result = TypeVar("Result")

# Items that are sent at once: enough that sending costs nothing beside the work, few enough that all jobs end
# at the same time.
MOST_AT_ONCE = 32
_CHUNKS_PER_JOB = 4
_AT_ONCE_FROM_A_STREAM = 8
# How much more it costs to send something to another machine.
_TIMES_FURTHER = 4
# Kernels run without the lock of Python, so that a few threads keep as many cores busy, and are neither
# started nor sent anything. It is held for a sixth of the time: beyond these, processes do more.
MOST_THREADS = 4
_libraries_are_limited = RLock()


def map_in_order(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    n_jobs: int | None = None,
    *,
    share_memory: bool = False,
    own_process: bool = False,
) -> Iterator[Result]:
    """Results of work on items, in their order.

    A few jobs are threads, more are processes (loky), unless ``joblib.parallel_config(backend=...)`` says
    otherwise. With the backend "dask", a cluster does the work; see `map_on_cluster`. Otherwise, work is sent
    along with each chunk of items: it should carry parameters, not data. Processes end with this one.

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
    own_process : bool
        Work that changes what the threads of a process share, such as filters of warnings: it is done by
        processes, however few.
    """
    n_jobs = effective_n_jobs(n_jobs)
    if n_jobs == 1:
        yield from map(work, items)
        return
    client, at_once = active_cluster(), _AT_ONCE_FROM_A_STREAM
    if isinstance(items, Sized):
        most = MOST_AT_ONCE * (_TIMES_FURTHER if client else 1)
        at_once = min(max(len(items) // (_CHUNKS_PER_JOB * n_jobs), 1), most)
    remaining = iter(items)
    if not own_process:
        # One alone is done before jobs have started.
        first = list(islice(remaining, 2))
        if len(first) < 2:
            yield from map(work, first)
            return
        remaining = chain(first, remaining)
    chunks = iter(lambda: list(islice(remaining, at_once)), [])
    if client:
        for results in map_on_cluster(client, partial(_work_on, work), chunks):
            yield from results
        return
    tasks = (delayed(_work_on)(work, chunk) for chunk in chunks)
    few = n_jobs <= MOST_THREADS and not own_process
    prefer = "threads" if share_memory or few else "processes"
    parallel = Parallel(n_jobs, prefer=prefer, return_as="generator")
    if isinstance(parallel._backend, LokyBackend):
        _tie_to_this_process(parallel._backend)
    with uninterrupted(), signals_kept_from_children():
        working = parallel(tasks)
    for results in working:
        yield from results


@contextmanager
def libraries_in_one_thread() -> Iterator[None]:
    """Keep BLAS, LAPACK and OpenMP to one thread each.

    Over several, sums round differently with each number of them; and on a busy machine, threads that wait
    for each other take long. The number is that of the whole process: Python's threads come in one at a time.
    """
    with _libraries_are_limited, threadpool_limits(1):
        yield


def _tie_to_this_process(backend: LokyBackend) -> None:
    """Let the processes of a backend end with this one."""
    # Nothing public hands an initializer to them before joblib 1.5.
    backend.configure = partial(backend.configure, initializer=end_with_parent, initargs=(os.getpid(),))
    if os.name == "posix":
        # These would start along with the first process, and unblock signals before the others start.
        resource_tracker.ensure_running()
        loky_resource_tracker.ensure_running()


def _work_on(work: Callable[[Item], Result], chunk: list[Item]) -> list[Result]:
    return [work(item) for item in chunk]
