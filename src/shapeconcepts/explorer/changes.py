"""Tells every window of the page when there is something new."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from threading import Lock

_SECONDS_BETWEEN_COMMENTS = 15.0


class Changes:
    """A version that rises, whichever thread says so, and those who wait for it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._version = 0
        self._waiting: set[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = set()

    @property
    def version(self) -> int:
        """How often something changed."""
        return self._version

    def announce(self) -> None:
        """Something changed."""
        with self._lock:
            self._version += 1
            for loop, event in self._waiting:
                loop.call_soon_threadsafe(event.set)

    async def events(self) -> AsyncIterator[bytes]:
        """Server-sent events: the version now and after each change, and a comment where nothing happens."""
        one = asyncio.get_running_loop(), asyncio.Event()
        with self._lock:
            self._waiting.add(one)
        try:
            told = -1
            while True:
                if told != self._version:
                    told = self._version
                    yield f"data: {told}\n\n".encode()
                else:
                    yield b": still here\n\n"
                try:
                    await asyncio.wait_for(one[1].wait(), _SECONDS_BETWEEN_COMMENTS)
                except TimeoutError:
                    continue
                one[1].clear()
        finally:
            with self._lock:
                self._waiting.discard(one)
