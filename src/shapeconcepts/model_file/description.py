"""Checks of what a file says of its scans, concepts and numbers."""

from __future__ import annotations

from typing import Any

from shapeconcepts.model_file.error import require
from shapeconcepts.model_file.layout import FIELDS, STAGES, check_names


def check_description(description: dict[str, Any], n_scans: int, n_concepts: int) -> None:
    """Require names, labels and numbers of the right types and counts; not the parameters.

    Raises
    ------
    ModelError
    """
    check_names("field", set(description), FIELDS - {"checksum"})
    for field, length, allowed in [
        ("scan_names", n_scans, (str,)),
        ("scan_labels", n_scans, (str, type(None))),
        ("concept_names", n_concepts, (str,)),
    ]:
        values = description[field]
        is_list = isinstance(values, list) and len(values) == length
        require(is_list, f"{field} must be a list of {length} names, got {_outline(values)}")
        for position, value in enumerate(values):
            require(isinstance(value, allowed), f"{field}[{position}] must be a string, got {value!r:.60}")
    keys, n_identities = description["concept_keys"], description["n_identities"]
    require(
        type(n_identities) is int and n_identities >= 0,
        f"n_identities must be a number of concepts, got {n_identities!r:.60}",
    )
    are_keys = isinstance(keys, list) and all(type(key) is int and 0 <= key < n_identities for key in keys)
    require(
        are_keys and len(keys) == n_concepts == len(set(keys)),
        f"concept_keys must hold {n_concepts} different numbers below {n_identities}, got {keys!r:.60}",
    )
    stages = description["stages"]
    require(isinstance(stages, dict), f"stages must be a JSON object, got {stages!r:.60}")
    check_names("stage", set(stages), STAGES)
    numbers = _numbers_with_text(description, "skipped", "scans with a reason")
    is_rising = numbers == sorted(set(numbers)) and all(0 <= number < n_scans for number in numbers)
    require(
        is_rising and len(numbers) < n_scans,
        f"skipped must name some of the scans 0 to {n_scans - 1}, rising, got {numbers!r:.60}",
    )
    _numbers_with_text(description, "group_names", "groups with a name")
    for field in ("concept_time", "epsilon_max", "granularity", "largest_divergence"):
        value = description[field]
        require(
            _is_share(value) or (value is None and field != "largest_divergence"),
            f"{field} must be a number from 0 to 1, got {value!r:.60}",
        )
    has_time = description["concept_time"] is not None
    require(
        has_time == (n_concepts > 0),
        f"concept_time must be a number where there are concepts, and only there: {n_concepts} concepts",
    )


def _numbers_with_text(description: dict[str, Any], field: str, what: str) -> list[int]:
    """Numbers of a field that must hold pairs of a number and a text."""
    pairs = description[field]
    require(isinstance(pairs, list), f"{field} must be a list, got {_outline(pairs)}")
    for entry in pairs:
        is_pair = isinstance(entry, list) and len(entry) == 2
        require(
            is_pair and type(entry[0]) is int and isinstance(entry[1], str),
            f"{field} must hold numbers of {what}, got {entry!r:.60}",
        )
    return [number for number, _ in pairs]


def _outline(value: object) -> str:
    return f"a list of {len(value)}" if isinstance(value, list) else f"{value!r:.60}"


def _is_share(value: object) -> bool:
    return type(value) in (int, float) and 0 <= value <= 1  # type: ignore[operator]
