"""How kernels are compiled: by numba, once, and kept for the next run where there is a place to keep them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Set
from functools import partial
from typing import Any

from numba import njit

from shapeconcepts.kernel_cache import KernelCache

_has_warned = False


def kernel(function: Callable[..., Any] | None = None, *, fastmath: Set[str] = frozenset()) -> Any:
    """Compile a function of numbers and arrays.

    It runs without Python's lock, so that threads work side by side, and divides by zero as numpy does.

    Parameters
    ----------
    function : callable
    fastmath : set of str
        What the compiler may do that changes the last bits, such as "reassoc" or "contract"; see numba. The
        result is still the same for the same input on one machine.

    Warns
    -----
    UserWarning
        Once, if compiled code can be kept nowhere: every process then compiles anew.
    """
    if function is None:
        return partial(kernel, fastmath=fastmath)
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": set(fastmath) or False}
    compiled = njit(**options)(function)
    # Where NUMBA_DISABLE_JIT is set, there is nothing to keep.
    if compiled is function:
        return compiled
    try:
        compiled._cache = KernelCache(function)
        return compiled
    except RuntimeError as error:
        if "no locator available" not in str(error):
            raise
    global _has_warned
    if not _has_warned:
        _has_warned = True
        warnings.warn(
            "compiled code can be kept nowhere, as neither the package's folder nor a cache folder of the "
            "user can be written: each process takes up to a minute to compile; the environment variable "
            "NUMBA_CACHE_DIR can name a folder for it",
            stacklevel=2,
        )
    return compiled
