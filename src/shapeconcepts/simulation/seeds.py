"""What numbers and seeds the simulator takes."""

from __future__ import annotations

import numpy as np


def check_count(parameter: str, value: object) -> None:
    """ValueError, with the parameter's name, if a value is no whole number of 0 or more."""
    if not _is_count(value):
        raise ValueError(f"{parameter} must be a whole number, 0 or more, got {value!r}")


def seed_of(random_state: int | np.random.Generator | None) -> int:
    """Seed that a `random_state` stands for: itself, or one draw of a generator; ValueError for others."""
    if random_state is None or isinstance(random_state, np.random.Generator):
        return int(np.random.default_rng(random_state).integers(2**63))
    if not _is_count(random_state):
        raise ValueError(
            "random_state must be a whole number, 0 or more, a numpy.random.Generator or None, "
            f"got {random_state!r}"
        )
    return int(random_state)


def _is_count(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and int(value) >= 0
