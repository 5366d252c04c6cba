"""Pictures of scans, made when they are asked for."""

from __future__ import annotations

import struct
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from os import cpu_count
from threading import Condition, Thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shapeconcepts.report.html import ScanPreview

N_ELEMENTS = 300
MOST_BYTES_KEPT = 64_000_000
_HEADER = struct.Struct("<IHHfffff")


class Previews:
    """Makes packed previews in a few threads, each once, and keeps the latest ones.

    What was asked for last is made first: whoever scrolls through thousands wants those that are in sight.
    Kernels run without the lock of Python, so that threads keep as many cores busy.

    Parameters
    ----------
    kept : callable
        The packed preview of a row where it is known, at once; None where it has to be made.
    made : callable
        The packed preview of a row.
    """

    def __init__(self, kept: Callable[[int], bytes | None], made: Callable[[int], bytes]) -> None:
        self._kept, self._make = kept, made
        self._changed = Condition()
        self._futures: OrderedDict[int, Future[bytes]] = OrderedDict()
        self._wanted: OrderedDict[int, Future[bytes]] = OrderedDict()
        self._n_bytes, self._is_closed = 0, False
        for number in range(cpu_count() or 1):
            Thread(target=self._work, name=f"previews {number}", daemon=True).start()

    def of(self, row: int) -> Future[bytes]:
        """The preview of a scan, which may still be in the making."""
        with self._changed:
            future = self._futures.get(row)
            if future is None:
                future = self._futures[row] = Future()
                if (content := self._kept(row)) is not None:
                    self._finish(future, content)
                else:
                    self._wanted[row] = future
                    self._changed.notify()
            self._futures.move_to_end(row)
            if row in self._wanted:
                self._wanted.move_to_end(row)
            return future

    def forget(self) -> None:
        """Make all of them anew, as there is another model."""
        with self._changed:
            # Those in the making are still waited for.
            self._futures, self._n_bytes = OrderedDict(self._wanted), 0

    def close(self) -> None:
        """Make no more."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._wanted or self._is_closed)
                if self._is_closed:
                    return
                row, future = self._wanted.popitem()
            try:
                content = self._make(row)
            except BaseException as error:
                future.set_exception(error)
                continue
            with self._changed:
                self._finish(future, content)

    def _finish(self, future: Future[bytes], content: bytes) -> None:
        future.set_result(content)
        self._n_bytes += len(content)
        while self._n_bytes > MOST_BYTES_KEPT:
            oldest = next((row for row, one in self._futures.items() if one.done()), None)
            if oldest is None:
                return
            self._n_bytes -= len(self._futures.pop(oldest).result())


def pack(row: int, one: ScanPreview | None) -> bytes:
    """A preview as it is sent: row, number of elements, 0, extent, spacing, sides, and the elements."""
    if one is None:
        return _HEADER.pack(row, 0, 0, 0, 0, 0, 0, 0)
    header = _HEADER.pack(row, len(one.positions), 0, one.extent, one.spacing, *one.sides)
    return header + one.to_bytes()
