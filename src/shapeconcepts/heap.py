"""Memory that was let go of goes back to the system."""

from __future__ import annotations

import ctypes
from collections.abc import Callable


def _found() -> Callable[[int], object] | None:
    try:
        trim: Callable[[int], object] = ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):  # pragma: no cover - only glibc has it, and needs it
        return None
    return trim


_trim = _found()


def give_back() -> None:
    """Give the system what is free between what is still used.

    Between stages that each need large arrays of other sizes, as what glibc keeps of one is of little use to
    the next. Other allocators are left alone.
    """
    if _trim is not None:  # pragma: no branch
        _trim(0)
