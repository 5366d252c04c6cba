"""Pictures of scans, made when they are asked for."""

from __future__ import annotations

import struct
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from os import cpu_count
from threading import Lock
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shapeconcepts.report.html import ScanPreview

N_ELEMENTS = 300
MOST_BYTES_KEPT = 64_000_000
# While one reads what was kept, another may wait for the model.
_LEAST_THREADS = 2
_HEADER = struct.Struct("<IHHfffff")


class Previews:
    """Makes packed previews in a few threads, each once, and keeps the latest ones.

    Kernels run without the lock of Python, so that threads keep as many cores busy.

    Parameters
    ----------
    packed : callable
        The packed preview of a row.
    """

    def __init__(self, packed: Callable[[int], bytes]) -> None:
        self._packed = packed
        self._threads = ThreadPoolExecutor(max(cpu_count() or 1, _LEAST_THREADS), "previews")
        self._lock = Lock()
        self._made: OrderedDict[int, Future[bytes]] = OrderedDict()
        self._n_bytes = 0

    def of(self, row: int) -> Future[bytes]:
        """The preview of a scan, which may still be in the making."""
        with self._lock:
            future = self._made.get(row)
            if future is None:
                future = self._made[row] = self._threads.submit(self._make, row)
            self._made.move_to_end(row)
            return future

    def forget(self) -> None:
        """Make all of them anew, as there is another model."""
        with self._lock:
            self._made, self._n_bytes = OrderedDict(), 0

    def close(self) -> None:
        """Make no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _make(self, row: int) -> bytes:
        packed = self._packed(row)
        with self._lock:
            self._n_bytes += len(packed)
            while self._n_bytes > MOST_BYTES_KEPT:
                oldest = next((key for key, one in self._made.items() if one.done()), None)
                if oldest is None:
                    break
                self._n_bytes -= len(self._made.pop(oldest).result())
        return packed


def pack(row: int, one: ScanPreview | None) -> bytes:
    """A preview as it is sent: row, number of elements, 0, extent, spacing, sides, and the elements."""
    if one is None:
        return _HEADER.pack(row, 0, 0, 0, 0, 0, 0, 0)
    header = _HEADER.pack(row, len(one.positions), 0, one.extent, one.spacing, *one.sides)
    return header + one.to_bytes()
