"""From what the page says to an edit of the model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel

_LONGEST_NAME = 1000


def edit_of(document: Mapping[str, Any]) -> Callable[[ShapeConceptModel], object]:
    """What makes an edit.

    Parameters
    ----------
    document : mapping
        `kind`, and what the method of the model takes: key, keys, name, scans, together, granularity, rate.

    Raises
    ------
    ValueError
        If it is none.
    """
    if document.get("kind") not in tuple(_EDITS):
        raise ValueError(f"kind must be one of {', '.join(_EDITS)}")
    needed, possible, make = _EDITS[document["kind"]]
    if unknown := sorted(set(document) - {"kind", *needed, *possible}):
        raise ValueError(f"{document['kind']} does not take {unknown[0]!r:.40}")
    for name in (*needed, *possible):
        if (value := document.get(name)) is not None:
            _CHECKS[name](name, value)
        elif name in needed:
            raise ValueError(f"{document['kind']} needs {name}")
    return lambda model: make(model, document)


def _move(model: ShapeConceptModel, given: Mapping[str, Any]) -> object:
    return model.move(given["scans"], given.get("key"), given.get("name") or "")


def _link(model: ShapeConceptModel, given: Mapping[str, Any]) -> object:
    if len(given["scans"]) != 2:
        raise ValueError(f"scans must be two, got {len(given['scans'])}")
    first, second = given["scans"]
    return model.link(first, second, given.get("together") is not False)


# What each needs, and what it may have.
_EDITS: dict[
    str, tuple[tuple[str, ...], tuple[str, ...], Callable[[ShapeConceptModel, Mapping[str, Any]], object]]
] = {
    "rename": (("key",), ("name",), lambda model, given: model.rename(given["key"], given.get("name") or "")),
    "merge": (("keys",), ("name",), lambda model, given: model.merge(given["keys"], given.get("name") or "")),
    "split": (("key",), ("scans",), lambda model, given: model.split(given["key"], given.get("scans"))),
    "move": (("scans",), ("key", "name"), _move),
    "foreign": (("scans",), (), lambda model, given: model.mark_foreign(given["scans"])),
    "link": (("scans",), ("together",), _link),
    "confirm": (("scans",), (), lambda model, given: model.confirm(given["scans"])),
    "recut": (("granularity",), (), lambda model, given: model.recut(given["granularity"])),
    "propagate": ((), ("rate",), lambda model, given: model.propagate(given.get("rate", 0.05))),
    "undo": ((), (), lambda model, given: model.undo()),
    "redo": ((), (), lambda model, given: model.redo()),
}


def _check_key(name: str, value: object) -> None:
    if type(value) is not int:
        raise ValueError(f"{name} must be the key of a concept, got {value!r:.40}")


def _check_whole_numbers(name: str, value: object) -> None:
    if not (isinstance(value, list) and all(type(one) is int for one in value)):
        raise ValueError(f"{name} must be a list of whole numbers, got {value!r:.40}")


def _check_text(name: str, value: object) -> None:
    if not (isinstance(value, str) and len(value) <= _LONGEST_NAME):
        raise ValueError(f"{name} must be a text of up to {_LONGEST_NAME} letters, got {value!r:.40}")


def _check_truth(name: str, value: object) -> None:
    if not isinstance(value, bool):
        raise ValueError(f"{name} must be true or false, got {value!r:.40}")


def _check_share(name: str, value: object) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{name} must be a number, got {value!r:.40}")


_CHECKS: dict[str, Callable[[str, object], None]] = {
    "key": _check_key,
    "keys": _check_whole_numbers,
    "scans": _check_whole_numbers,
    "name": _check_text,
    "together": _check_truth,
    "granularity": _check_share,
    "rate": _check_share,
}
