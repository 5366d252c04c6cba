"""Work on the machines of a Dask cluster."""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import Any, TypeVar

from joblib.parallel import get_active_backend
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

Chunk = TypeVar("Chunk")
Result = TypeVar("Result")

# Enough that no worker waits for the next, few enough that a stream stays a stream.
_WAITING_PER_THREAD = 4


def active_cluster() -> Any:
    """Client of the Dask cluster that ``joblib.parallel_config(backend="dask")`` chose, None without one."""
    backend, _ = get_active_backend()
    return backend.client if type(backend).__name__ == "DaskDistributedBackend" else None


def map_on_cluster(client: Any, work: Callable[[Chunk], Result], chunks: Iterable[Chunk]) -> Iterator[Result]:
    """Results of work on chunks, in their order.

    Work goes once to each worker that needs it, a chunk to one. What a worker that dies had not finished is
    done by others; what it held is sent again.

    Parameters
    ----------
    client : distributed.Client
    work : callable
        Of one chunk. What it returns must not depend on which worker does it.
    chunks : iterable
        Taken a few ahead of the results.
    """
    # Comes with Dask.
    import cloudpickle

    # A task of its own: data that are only handed out are lost with the last worker that has them.
    carried = client.submit(_same, work, pure=False)
    waiting: deque[Any] = deque()
    most = _WAITING_PER_THREAD * max(sum(client.nthreads().values()), 1)
    try:
        for chunk in chunks:
            # In one piece: many small arrays are sent one by one.
            waiting.append(client.submit(_done, carried, cloudpickle.dumps(chunk), pure=False))
            if len(waiting) == most:
                yield pickle.loads(waiting.popleft().result())
        while waiting:
            yield pickle.loads(waiting.popleft().result())
    finally:
        client.cancel([carried, *waiting])


def _same(work: Any) -> Any:
    return work


def _done(work: Callable[[Any], Any], chunk: bytes) -> bytes:
    _keep_libraries_in_one_thread()
    return pickle.dumps(work(pickle.loads(chunk)))


@cache
def _keep_libraries_in_one_thread() -> None:
    # As on one machine: over several threads, sums round differently. For good, as a worker may have several.
    threadpool_limits(1)
