"""Checks the JSON description in a binary glTF file: each value is of its kind, and what it names is there.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from shapeconcepts.scan import ScanError

COMPONENT_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
INDEX_TYPES = (5121, 5123, 5125)
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
MOVES = {"matrix": 16, "translation": 3, "rotation": 4, "scale": 3}
# The length of a binary glTF file has 32 bits.
LARGEST_FILE = 2**32 - 1
TITLES = {
    "scenes": "scene",
    "nodes": "node",
    "meshes": "mesh",
    "accessors": "accessor",
    "bufferViews": "buffer view",
    "buffers": "buffer",
}

Description = dict[str, Any]


def check_description(description: object) -> Description:
    """The description, with a list of objects for all that makes shapes; ScanError where it is damaged."""
    if not isinstance(description, dict):
        raise ScanError(f"has a JSON description that is {_shown(description)}, expected an object")
    description = {**description, **{key: _objects(description, key, "its description") for key in TITLES}}
    n = {key: len(description[key]) for key in TITLES}
    if not n["meshes"]:
        raise ScanError("has no meshes")
    if "scene" in description:
        _check_index(description, "scene", n["scenes"], "its description")
    for where, scene in _numbered(description, "scenes"):
        _check_indices(scene, "nodes", n["nodes"], where)
    for where, node in _numbered(description, "nodes"):
        _check_indices(node, "children", n["nodes"], where)
        if "mesh" in node:
            _check_index(node, "mesh", n["meshes"], where)
        for key, length in MOVES.items():
            if key in node:
                _check_numbers(node, key, length, where)
    for where, view in _numbered(description, "bufferViews"):
        _check_whole(view, "buffer", 0, where)
        _check_whole(view, "byteLength", 1, where)
        _check_optional(view, "byteOffset", 0, where)
        _check_optional(view, "byteStride", 1, where)
    for where, accessor in _numbered(description, "accessors"):
        _check_choice(accessor, "componentType", tuple(COMPONENT_TYPES), where)
        _check_choice(accessor, "type", tuple(COMPONENTS), where)
        _check_whole(accessor, "count", 1, where)
        _check_optional(accessor, "byteOffset", 0, where)
        if "bufferView" not in accessor or "sparse" in accessor:
            raise ScanError(f"{where} describes {accessor['count']} values that the file does not hold")
        _check_index(accessor, "bufferView", n["bufferViews"], where)
    for where, mesh in _numbered(description, "meshes"):
        for number, primitive in enumerate(_objects(mesh, "primitives", where)):
            _check_primitive(primitive, description["accessors"], f"primitive {number} of {where}")
    return description


def component_type(accessor: Description) -> np.dtype:
    """Of one number of an array."""
    return np.dtype(COMPONENT_TYPES[accessor["componentType"]])


def row_bytes(accessor: Description) -> int:
    """Bytes of one value of an array, such as a vertex."""
    return component_type(accessor).itemsize * COMPONENTS[accessor["type"]]


def is_triangles(primitive: Description) -> bool:
    """Whether a primitive is a surface, and not points or lines."""
    return primitive.get("mode", TRIANGLES) >= TRIANGLES


def n_triangles(primitive: Description, accessors: Sequence[Description]) -> int:
    """Number of a primitive's triangles."""
    if not is_triangles(primitive):
        return 0
    corners = n_corners(primitive, accessors)
    return corners - 2 if primitive.get("mode") == TRIANGLE_STRIP else corners // 3


def n_corners(primitive: Description, accessors: Sequence[Description]) -> int:
    """Number of vertices that a primitive goes through one after the other."""
    count: int = accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"]
    return count


def _check_primitive(primitive: Description, accessors: Sequence[Description], where: str) -> None:
    _check_choice({"mode": TRIANGLES, **primitive}, "mode", tuple(range(TRIANGLE_FAN + 1)), where)
    if primitive.get("mode") == TRIANGLE_FAN:
        raise ScanError(f"{where} is a triangle fan, which is not supported")
    attributes = primitive.get("attributes")
    if not isinstance(attributes, dict):
        raise ScanError(f"{where} has the attributes {_shown(attributes)}, expected an object")
    _check_index(attributes, "POSITION", len(accessors), where)
    position = attributes["POSITION"]
    _check_array(accessors[position], "VEC3", tuple(COMPONENT_TYPES), f"the POSITION of {where}", position)
    if accessors[position].get("normalized", False) is not False:
        raise ScanError(f"the POSITION of {where} is in normalized numbers, which is not supported")
    if "indices" in primitive:
        _check_index(primitive, "indices", len(accessors), where)
        indices = primitive["indices"]
        _check_array(accessors[indices], "SCALAR", INDEX_TYPES, f"the indices of {where}", indices)
    corners = n_corners(primitive, accessors)
    if primitive.get("mode", TRIANGLES) == TRIANGLES and corners % 3:
        raise ScanError(f"{where} has {corners} corners of triangles, expected a multiple of 3")
    if is_triangles(primitive) and corners < 3:
        raise ScanError(f"{where} is a strip of {corners} corners, expected at least 3")


def _check_array(
    accessor: Description, kind: str, component_types: tuple[int, ...], where: str, number: int
) -> None:
    if accessor["type"] != kind or accessor["componentType"] not in component_types:
        raise ScanError(
            f"{where} is accessor {number} of type {accessor['type']} and componentType "
            f"{accessor['componentType']}, expected {kind} and one of {', '.join(map(str, component_types))}"
        )


def _numbered(description: Description, key: str) -> list[tuple[str, Description]]:
    return [(f"{TITLES[key]} {number}", one) for number, one in enumerate(description[key])]


def _objects(owner: Description, key: str, where: str) -> list[Description]:
    values = owner.get(key, [])
    if not isinstance(values, list):
        raise ScanError(f"{where} has {key} {_shown(values)}, expected a list")
    for number, value in enumerate(values):
        if not isinstance(value, dict):
            raise ScanError(f"{where} has {key}[{number}] {_shown(value)}, expected an object")
    return values


def _check_index(owner: Description, key: str, n: int, where: str) -> None:
    value = owner.get(key)
    if type(value) is not int or not 0 <= value < n:
        raise ScanError(f"{where} has {key} {_shown(value)}, expected a whole number from 0, below {n}")


def _check_indices(owner: Description, key: str, n: int, where: str) -> None:
    values = owner.get(key, [])
    if not isinstance(values, list) or not all(type(value) is int and 0 <= value < n for value in values):
        raise ScanError(f"{where} has {key} {_shown(values)}, expected whole numbers from 0, below {n}")


def _check_whole(owner: Description, key: str, smallest: int, where: str) -> None:
    value = owner.get(key)
    if type(value) is not int or not smallest <= value <= LARGEST_FILE:
        raise ScanError(
            f"{where} has {key} {_shown(value)}, expected a whole number from {smallest} to {LARGEST_FILE}"
        )


def _check_optional(owner: Description, key: str, smallest: int, where: str) -> None:
    if key in owner:
        _check_whole(owner, key, smallest, where)


def _check_choice(owner: Description, key: str, choices: tuple[object, ...], where: str) -> None:
    value = owner.get(key)
    # 5126.0 equals 5126, and True equals 1.
    if not any(type(value) is type(one) and value == one for one in choices):
        expected = ", ".join(map(str, choices))
        raise ScanError(f"{where} has {key} {_shown(value)}, expected one of {expected}")


def _check_numbers(owner: Description, key: str, length: int, where: str) -> None:
    values = owner[key]
    are_numbers = isinstance(values, list) and all(
        type(value) in (int, float) and abs(value) <= sys.float_info.max for value in values
    )
    if not are_numbers or len(values) != length:
        raise ScanError(f"{where} has {key} {_shown(values)}, expected {length} finite numbers")


def _shown(value: object) -> str:
    return "missing" if value is None else f"{value!r:.60}"
