"""Checks a binary glTF file before a library unpacks it.

A few bytes of its JSON can ask for arrays of any size: zeros that stand nowhere in the file, or one mesh that
is placed a million times. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import json
import struct
from typing import Any

from shapeconcepts.io.mesh import check_triangles
from shapeconcepts.scan import ScanError

MAGIC, JSON_CHUNK = 0x46546C67, 0x4E4F534A
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
TRIANGLE_FAN = 6
TRIANGLE_STRIP = 5
MOST_PARTS = 1024
# The library walks from the scene to each node, one by one. Skeletons and assemblies have a few dozen levels.
MOST_LEVELS = 64
# A scene may use one array several times, but not without end.
LARGEST_GROWTH = 16


# Of the scene, what decides on its shape. The library copies all else for every part.
NEEDED = {
    "scenes": ("nodes",),
    "nodes": ("name", "children", "mesh", "matrix", "translation", "rotation", "scale"),
    "meshes": ("name", "primitives"),
    "accessors": ("bufferView", "byteOffset", "componentType", "count", "type"),
    "bufferViews": ("buffer", "byteOffset", "byteLength", "byteStride"),
    "buffers": ("byteLength",),
}


def checked_glb(data: bytes) -> bytes:
    """The file with nothing but shapes in it; ScanError unless it holds what its JSON describes."""
    if len(data) < 20:
        raise ScanError("is not a GLB file")
    magic, version, length, json_length, kind = struct.unpack_from("<5I", data)
    if (magic, version, kind) != (MAGIC, 2, JSON_CHUNK):
        raise ScanError("is not a GLB file of version 2")
    if length > len(data) or 20 + json_length > length:
        raise ScanError(
            f"is truncated: its header promises {max(length, 20 + json_length)} bytes, it has {len(data)}"
        )
    try:
        scene = json.loads(data[20 : 20 + json_length])
        _check_scene(scene, len(data))
        text = json.dumps(_shapes(scene)).encode()
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError) as error:
        if isinstance(error, ScanError):
            raise
        raise ScanError(f"has a damaged JSON description ({type(error).__name__}: {error})") from None
    text += b" " * (-len(text) % 4)
    others = data[20 + json_length : length]
    return struct.pack("<5I", MAGIC, 2, 20 + len(text) + len(others), len(text), JSON_CHUNK) + text + others


def _shapes(scene: dict[str, Any]) -> dict[str, Any]:
    reduced: dict[str, Any] = {key: scene[key] for key in ("asset", "scene") if key in scene}
    for key, names in NEEDED.items():
        if key in scene:
            reduced[key] = [{name: one[name] for name in names if name in one} for one in scene[key]]
    for mesh in reduced["meshes"]:
        mesh["primitives"] = [
            {
                "attributes": {"POSITION": primitive["attributes"]["POSITION"]},
                **{name: primitive[name] for name in ("indices", "mode") if name in primitive},
            }
            for primitive in mesh["primitives"]
        ]
    return reduced


def _check_scene(scene: dict[str, Any], file_size: int) -> None:
    # The library looks at each mesh, whatever the list of extensions says.
    extensions = [scene.get("extensionsUsed", [])]
    for mesh in scene["meshes"]:
        extensions += [primitive.get("extensions", {}) for primitive in mesh["primitives"]]
    compression = set(COMPRESSIONS).intersection(name for names in extensions for name in names)
    if compression:
        raise ScanError(f"is compressed with {compression.pop()}, which is not supported")
    if any("uri" in buffer for buffer in scene.get("buffers", [])):
        raise ScanError("keeps its data in another file, which is not supported")

    views = [view["byteLength"] for view in scene.get("bufferViews", [])]
    sizes = []
    for accessor in scene.get("accessors", []):
        size = accessor["count"] * COMPONENT_BYTES[accessor["componentType"]] * COMPONENTS[accessor["type"]]
        if (
            "bufferView" not in accessor
            or "sparse" in accessor
            or not 0 <= size <= views[accessor["bufferView"]]
        ):
            raise ScanError(f"describes an array of {accessor['count']} values that it does not hold")
        sizes.append(size)

    nodes = scene.get("nodes", [])
    children = [child for node in nodes for child in node.get("children", [])]
    graphs = [graph.get("nodes", []) for graph in scene.get("scenes", [])]
    roots = {root for graph in graphs for root in graph}
    twice = any(len(set(names)) < len(names) for names in (children, *graphs))
    if twice or set(children) & roots:
        raise ScanError("has a node with two parents")
    _check_levels(nodes, roots)

    meshes = [
        [_primitive_size(primitive, sizes) for primitive in mesh["primitives"]] for mesh in scene["meshes"]
    ]
    placed = [size for node in nodes if "mesh" in node for size in meshes[node["mesh"]]]
    counts = [accessor["count"] for accessor in scene.get("accessors", [])]
    triangles = [
        sum(_n_triangles(primitive, counts) for primitive in mesh["primitives"]) for mesh in scene["meshes"]
    ]
    n_triangles = max(sum(triangles), sum(triangles[node["mesh"]] for node in nodes if "mesh" in node))
    check_triangles(n_triangles, file_size)
    n_parts = max(len(nodes), len(placed), sum(len(mesh) for mesh in meshes))
    if n_parts > MOST_PARTS:
        raise ScanError(f"has {n_parts} parts, at most {MOST_PARTS} are supported")
    n_bytes = max(sum(views), sum(sizes), sum(placed))
    if min(views, default=0) < 0 or n_bytes > LARGEST_GROWTH * file_size:
        raise ScanError(f"describes {n_bytes} bytes of arrays in {file_size} bytes of file")


def _check_levels(nodes: list[dict[str, Any]], roots: set[int]) -> None:
    level, n_levels = list(roots), 0
    while level:
        n_levels += 1
        if n_levels > MOST_LEVELS:
            raise ScanError(f"has nodes below more than {MOST_LEVELS} others, which is not supported")
        level = [child for node in level for child in nodes[node].get("children", [])]


def _n_triangles(primitive: dict[str, Any], counts: list[int]) -> int:
    corners = counts[primitive.get("indices", primitive["attributes"]["POSITION"])]
    return corners if primitive.get("mode") == TRIANGLE_STRIP else corners // 3


def _primitive_size(primitive: dict[str, Any], sizes: list[int]) -> int:
    # The library leaves out what it does not know.
    if primitive.get("mode") == TRIANGLE_FAN:
        raise ScanError("holds triangle fans, which are not supported")
    indices = [*primitive["attributes"].values()]
    if "indices" in primitive:
        indices.append(primitive["indices"])
    return sum(sizes[index] for index in indices)
