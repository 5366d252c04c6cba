"""Memory that was let go of goes back to the system."""

import platform
from mmap import PAGESIZE
from pathlib import Path

import numpy as np
import pytest

from shapeconcepts.heap import give_back


def resident() -> int:
    """Memory of this process that is really there, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGESIZE


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other allocators are left alone")
def test_what_is_free_between_what_is_used_is_given_back() -> None:
    before = resident()
    # Small enough to lie on the heap side by side.
    arrays = [np.ones(2000) for _ in range(8000)]
    assert resident() - before > 100_000_000
    kept = arrays[::100]
    del arrays
    give_back()
    assert resident() - before < 40_000_000
    assert all((array == 1.0).all() for array in kept)
