"""Checks a binary glTF file before a library unpacks it.

A few bytes of its JSON can ask for arrays of any size: zeros that stand nowhere in the file, or one mesh that
is placed a million times. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from shapeconcepts.io.glb_description import (
    COMPONENTS,
    Description,
    check_description,
    component_type,
    is_triangles,
    n_triangles,
    row_bytes,
)
from shapeconcepts.io.mesh import check_triangles
from shapeconcepts.scan import ScanError

MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
MOST_PARTS = 1024
# The library walks from the scene to each node, one by one. Skeletons and assemblies have a few dozen levels.
MOST_LEVELS = 64
# A scene may use one array several times, but not without end.
LARGEST_GROWTH = 16

# Of the scene, what decides on its shape. The library copies all else for every part.
NEEDED = {
    "scenes": ("nodes",),
    "nodes": ("children", "matrix", "translation", "rotation", "scale"),
    "accessors": ("bufferView", "byteOffset", "componentType", "count", "type"),
    "bufferViews": ("buffer", "byteOffset", "byteLength", "byteStride"),
    "buffers": ("byteLength",),
}


def checked_glb(data: bytes) -> bytes:
    """The file with nothing but triangles in it; ScanError unless it holds what its JSON describes."""
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
        read = json.loads(data[20 : 20 + json_length])
    except RecursionError:
        raise ScanError("has a JSON description that is nested too deep") from None
    except ValueError as error:
        raise ScanError(f"has a description that is no JSON ({error})") from None
    description = check_description(read)
    _check_bounds(description, len(data))
    _check_arrays(description, _binary_chunks(data[:length], 20 + json_length))
    text = json.dumps(_shapes(description)).encode()
    text += b" " * (-len(text) % 4)
    others = data[20 + json_length : length]
    return struct.pack("<5I", MAGIC, 2, 20 + len(text) + len(others), len(text), JSON_CHUNK) + text + others


def _shapes(description: Description) -> Description:
    reduced: dict[str, Any] = {"scene": description.get("scene", 0)}
    for key, names in NEEDED.items():
        reduced[key] = [{name: one[name] for name in names if name in one} for one in description[key]]
    meshes = [
        [
            {
                "attributes": {"POSITION": primitive["attributes"]["POSITION"]},
                **{name: primitive[name] for name in ("indices", "mode") if name in primitive},
            }
            for primitive in mesh.get("primitives", [])
            if is_triangles(primitive)
        ]
        for mesh in description["meshes"]
    ]
    reduced["meshes"] = [{"primitives": primitives} for primitives in meshes]
    for node, original in zip(reduced["nodes"], description["nodes"], strict=True):
        # The library loses the children of a node with an empty mesh.
        if "mesh" in original and meshes[original["mesh"]]:
            node["mesh"] = original["mesh"]
    return reduced


def _check_bounds(description: Description, file_size: int) -> None:
    """Require that the library takes no more time and memory than the file is worth."""
    nodes, accessors = description["nodes"], description["accessors"]
    meshes = [mesh.get("primitives", []) for mesh in description["meshes"]]
    # The library looks at each mesh, whatever the list of extensions says.
    extensions = [description.get("extensionsUsed")]
    extensions += [primitive.get("extensions") for mesh in meshes for primitive in mesh]
    for names in extensions:
        for name in COMPRESSIONS:
            if isinstance(names, list | dict) and name in names:
                raise ScanError(f"is compressed with {name}, which is not supported")
    if any("uri" in buffer for buffer in description["buffers"]):
        raise ScanError("keeps its data in another file, which is not supported")

    views = [view["byteLength"] for view in description["bufferViews"]]
    sizes = [accessor["count"] * row_bytes(accessor) for accessor in accessors]

    children = [child for node in nodes for child in node.get("children", [])]
    graphs = [graph.get("nodes", []) for graph in description["scenes"]]
    roots = {root for graph in graphs for root in graph}
    twice = any(len(set(names)) < len(names) for names in (children, *graphs))
    if twice or set(children) & roots:
        raise ScanError("has a node with two parents")
    _walk(nodes, list(roots))

    triangles = [sum(n_triangles(primitive, accessors) for primitive in mesh) for mesh in meshes]
    placed = [node["mesh"] for node in nodes if "mesh" in node]
    check_triangles(max(sum(triangles), sum(triangles[mesh] for mesh in placed)), file_size)
    in_scene = _walk(nodes, graphs[description.get("scene", 0)] if graphs else [])
    if not any(triangles[nodes[node]["mesh"]] for node in in_scene if "mesh" in nodes[node]):
        raise ScanError("has no triangles in its scene")
    n_parts = max(len(nodes), sum(len(mesh) for mesh in meshes), sum(len(meshes[mesh]) for mesh in placed))
    if n_parts > MOST_PARTS:
        raise ScanError(f"has {n_parts} parts, at most {MOST_PARTS} are supported")
    mesh_sizes = [sum(sizes[array] for primitive in mesh for array in _arrays(primitive)) for mesh in meshes]
    n_bytes = max(sum(views), sum(sizes), sum(mesh_sizes[mesh] for mesh in placed))
    if n_bytes > LARGEST_GROWTH * file_size:
        raise ScanError(f"describes {n_bytes} bytes of arrays in {file_size} bytes of file")


def _walk(nodes: list[Description], roots: list[int]) -> list[int]:
    """Nodes that are roots or below them; ScanError where they are too many levels below."""
    found: list[int] = []
    level, n_levels = roots, 0
    while level:
        n_levels += 1
        if n_levels > MOST_LEVELS:
            raise ScanError(f"has nodes below more than {MOST_LEVELS} others, which is not supported")
        found += level
        level = [child for node in level for child in nodes[node].get("children", [])]
    return found


def _arrays(primitive: Description) -> list[int]:
    arrays = [primitive["attributes"]["POSITION"]]
    return [*arrays, primitive["indices"]] if "indices" in primitive else arrays


def _binary_chunks(data: bytes, start: int) -> list[memoryview]:
    chunks = []
    while start + 8 <= len(data):
        length, kind = struct.unpack_from("<2I", data, start)
        chunk = memoryview(data)[start + 8 : start + 8 + length]
        if len(chunk) < length:
            raise ScanError(f"has a part that promises {length} bytes, {len(chunk)} follow")
        if kind == BINARY_CHUNK:
            chunks.append(chunk)
        start += 8 + length
    return chunks


def _check_arrays(description: Description, chunks: list[memoryview]) -> None:
    """Require that arrays lie within the binary part, and that indices lead to vertices."""
    views, accessors = description["bufferViews"], description["accessors"]
    for number, view in enumerate(views):
        if view["buffer"] >= len(chunks):
            raise ScanError(f"buffer view {number} is in buffer {view['buffer']}, the file has {len(chunks)}")
        end, length = view.get("byteOffset", 0) + view["byteLength"], len(chunks[view["buffer"]])
        if end > length:
            raise ScanError(f"buffer view {number} ends at byte {end}, its buffer has {length}")
    for number, accessor in enumerate(accessors):
        view, row = views[accessor["bufferView"]], row_bytes(accessor)
        stride = view.get("byteStride", row)
        if stride < row:
            raise ScanError(f"accessor {number} has a byteStride of {stride}, expected at least {row}")
        end = accessor.get("byteOffset", 0) + (accessor["count"] - 1) * stride + row
        if end > view["byteLength"]:
            raise ScanError(
                f"accessor {number} ends at byte {end}, its buffer view has {view['byteLength']} bytes"
            )
    largest: dict[int, int] = {}
    for number, mesh in enumerate(description["meshes"]):
        for primitive in mesh.get("primitives", []):
            if "indices" not in primitive:
                continue
            indices, n_vertices = (
                primitive["indices"],
                accessors[primitive["attributes"]["POSITION"]]["count"],
            )
            if indices not in largest:
                view = views[accessors[indices]["bufferView"]]
                largest[indices] = int(_values(accessors[indices], view, chunks[view["buffer"]]).max())
            if largest[indices] >= n_vertices:
                raise ScanError(
                    f"mesh {number} has a triangle with vertex {largest[indices]}, "
                    f"expected whole numbers from 0, below {n_vertices}"
                )


def _values(accessor: Description, view: Description, chunk: memoryview) -> np.ndarray:
    row = row_bytes(accessor)
    kind = component_type(accessor)
    return np.ndarray(
        (accessor["count"], COMPONENTS[accessor["type"]]),
        kind,
        chunk,
        view.get("byteOffset", 0) + accessor.get("byteOffset", 0),
        (view.get("byteStride", row), kind.itemsize),
    )
