"""A process that is told to end does so at once, and leaves neither half a file nor a process behind."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import RLock, Thread
from time import sleep
from typing import NoReturn

INTERRUPTED = "Interrupted"
# Files and folders that are being written: they are removed at the end.
unfinished: set[Path] = set()

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_SECONDS_BETWEEN_LOOKS = 0.5
# What is not to be left half done takes less; and a command that hangs in it must end as well.
_MOST_SECONDS_TO_FINISH = 2.0
_SHOW_CURSOR_ON_AN_EMPTY_LINE = "\r\x1b[K\x1b[?25h"
_being_finished = RLock()
_message = INTERRUPTED


def end_at_signals() -> None:
    """From now on, SIGINT (Ctrl-C) and SIGTERM end this process with exit code 130 or 143, whatever it does.

    A thread ends it, not an exception: that may come up where a library drops it, takes it for another
    failure or waits for its threads, and a main thread within compiled code does not see it. Signals that are
    ignored, as in the background of a shell, stay ignored.
    """
    # What remains of a process that ends at once is removed by another one, to which it hands its options: it
    # is not to tell of it after the end.
    sys.warnoptions.append("ignore:resource_tracker")
    told, tell = socket.socketpair()
    tell.setblocking(False)
    signal.set_wakeup_fd(tell.detach(), warn_on_full_buffer=False)
    for number in _SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _leave_it_to_the_thread)
    Thread(target=_end_when_told, args=(told,), name="end at signals", daemon=True).start()


@contextmanager
def signals_awaited() -> Iterator[Callable[[], int]]:
    """Within, SIGINT and SIGTERM end nothing: the first that came is told when asked for, 0 before.

    For the main thread of a command that has something to save before it ends. A second one ends it at once.
    """
    came: list[int] = []

    def note(number: int, frame: object) -> None:
        if came:
            os._exit(128 + number)
        came.append(number)

    wakeup = signal.set_wakeup_fd(-1)
    before = {number: signal.getsignal(number) for number in _SIGNALS}
    for number, handler in before.items():
        if handler != signal.SIG_IGN:
            signal.signal(number, note)
    try:
        yield lambda: came[0] if came else 0
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(wakeup)


def say_when_interrupted(message: str) -> None:
    """What the user is told when a signal ends the process."""
    global _message
    _message = message


def message_when_interrupted() -> str:
    """What `say_when_interrupted` was told last."""
    return _message


def end_with_parent(parent: int) -> None:
    """From now on, this process ends when the one that started it is gone, however that came.

    Parameters
    ----------
    parent : int
        Id of the process that started this one.
    """
    Thread(target=_end_without, args=(parent,), name="end with parent", daemon=True).start()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """No signal ends the process within, if that takes less than two seconds; it ends it right after."""
    with _being_finished:
        yield


@contextmanager
def signals_kept_from_children() -> Iterator[None]:
    """Processes that are started within do not get SIGINT and SIGTERM: they end when this process does.

    Ctrl-C goes to all processes of a terminal. Those that are just starting would tell of it by a traceback,
    and this process would take the end of the others for a failure.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _leave_it_to_the_thread(number: int, frame: object) -> None:
    pass


def _end_when_told(told: socket.socket) -> None:
    while (number := told.recv(1)[0]) not in _SIGNALS:
        pass
    _end(128 + number, _message)


def _end_without(parent: int) -> None:
    while os.getppid() == parent:
        sleep(_SECONDS_BETWEEN_LOOKS)
    _end(1)


def _end(code: int, message: str = "") -> NoReturn:
    try:
        # It is not given back: no other thread begins a file any more.
        _being_finished.acquire(timeout=_MOST_SECONDS_TO_FINISH)
        for path in list(unfinished):
            # What cannot be removed must not keep the process from its end.
            with suppress(OSError):
                if path.is_dir():
                    shutil.rmtree(path)
                else:
                    path.unlink(missing_ok=True)
        if message:
            shown = _SHOW_CURSOR_ON_AN_EMPTY_LINE if os.isatty(2) else ""
            # The streams of Python may be in use.
            os.write(2, f"{shown}{message}\n".encode())
    finally:
        os._exit(code)
