"""Binary glTF: scenes of moved parts, and a true message for each way in which one can be damaged."""

import json
import struct
import warnings

import numpy as np
import pytest
import trimesh

from mesh_examples import TRIANGLES, VERTICES, corners, exported, write
from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan


def test_glb_scene_with_moved_parts(tmp_path, scanned):
    part = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
    scene = trimesh.Scene()
    moves = [trimesh.transformations.rotation_matrix(0.3, [1, 2, 3], [0, 1, 0]), np.eye(4)]
    for move in moves:
        scene.add_geometry(part, transform=move)
    read_scan(write(tmp_path, scene.export(file_type="glb"), "mesh.glb"))
    expected = np.vstack([trimesh.transform_points(VERTICES, move)[TRIANGLES] for move in moves]).reshape(
        -1, 3
    )
    expected = np.column_stack([expected[:, 0], -expected[:, 2], expected[:, 1]])
    np.testing.assert_allclose(
        corners(scanned["vertices"], scanned["faces"]),
        corners(expected, np.arange(18).reshape(6, 3)),
        atol=2e-5,
    )


def glb_bytes(scene, binary):
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    return (
        struct.pack("<5I", 0x46546C67, 2, total, len(text), 0x4E4F534A)
        + text
        + struct.pack("<2I", len(binary), 0x004E4942)
        + binary
    )


def simple_glb(n_triangles=300, **changes):
    positions = np.random.default_rng(0).random((3 * n_triangles, 3)).astype("<f4").tobytes()
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3 * n_triangles, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(positions)}],
        "buffers": [{"byteLength": len(positions)}],
    }
    scene.update(changes)
    return glb_bytes(scene, positions)


def test_glb_without_a_library(tmp_path, scanned):
    read_scan(write(tmp_path, simple_glb(), "mesh.glb"))
    assert scanned["faces"].shape == (300, 3)


ACCESSOR = {"bufferView": 0, "componentType": 5126, "count": 900, "type": "VEC3"}
VIEW = {"buffer": 0, "byteLength": 10_800}
PRIMITIVE = {"attributes": {"POSITION": 0}}


def accessor(**changes):
    return {"accessors": [{**ACCESSOR, **changes}]}


def view(**changes):
    return {"bufferViews": [{**VIEW, **changes}]}


def primitive(**changes):
    return {"meshes": [{"primitives": [{**PRIMITIVE, **changes}]}]}


def node(**changes):
    return {"nodes": [{"mesh": 0, **changes}]}


def indices(**changes):
    # The bytes of the positions, read as numbers of vertices.
    indexed = {"bufferView": 0, "componentType": 5125, "count": 300, "type": "SCALAR", **changes}
    return {"accessors": [ACCESSOR, indexed], **primitive(indices=1)}


BAD_GLB = {
    "zeros from nothing": (
        {"accessors": [{"componentType": 5126, "count": 10**9, "type": "VEC3"}]},
        "accessor 0 describes 1000000000 values that the file does not hold",
    ),
    "sparse": (accessor(sparse={}), "accessor 0 describes 900 values that the file does not hold"),
    "more than the view": (accessor(count=903), "accessor 0 ends at byte 10836, its buffer view has 10800"),
    "offset in the view": (
        accessor(byteOffset=4),
        "accessor 0 ends at byte 10804, its buffer view has 10800",
    ),
    "negative offset": (
        accessor(byteOffset=-4),
        "accessor 0 has byteOffset -4, expected a whole number from",
    ),
    "negative count": (accessor(count=-3), "accessor 0 has count -3, expected a whole number from 1"),
    "count in words": (accessor(count="900"), "accessor 0 has count '900', expected a whole number from 1"),
    "half a count": (accessor(count=4.5), "accessor 0 has count 4.5, expected a whole number from 1"),
    "endless count": (accessor(count=10**400), "accessor 0 has count 1000"),
    "no count": (
        {"accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3"}]},
        "has count missing",
    ),
    "true is no count": (accessor(count=True), "accessor 0 has count True, expected a whole number from 1"),
    "component type": (
        accessor(componentType=5124),
        "accessor 0 has componentType 5124, expected one of 5120",
    ),
    "list as type": (accessor(type=[]), r"accessor 0 has type \[\], expected one of SCALAR"),
    "no such view": (
        accessor(bufferView=1),
        "accessor 0 has bufferView 1, expected a whole number from 0, below 1",
    ),
    "single numbers": (
        accessor(type="SCALAR"),
        "primitive 0 of mesh 0 is accessor 0 of type SCALAR and componentType 5126, expected VEC3",
    ),
    "two coordinates": (
        accessor(type="VEC2"),
        "is accessor 0 of type VEC2 and componentType 5126, expected VEC3",
    ),
    "normalized": (accessor(normalized=True), "POSITION of primitive 0 of mesh 0 is in normalized numbers"),
    "no triangles": (
        accessor(count=899),
        "primitive 0 of mesh 0 has 899 corners of triangles, expected a multiple",
    ),
    "short strip": (
        {**accessor(count=2), **primitive(mode=5)},
        "is a strip of 2 corners, expected at least 3",
    ),
    "indices that are shares": (
        indices(componentType=5126),
        "is accessor 1 of type SCALAR and componentType 5126",
    ),
    "indices in pairs": (
        indices(type="VEC2"),
        "the indices of primitive 0 of mesh 0 is accessor 1 of type VEC2",
    ),
    "indices too large": (
        indices(),
        r"mesh 0 has a triangle with vertex \d+, expected whole numbers from 0, below 900",
    ),
    "no such indices": (
        primitive(indices=5),
        "primitive 0 of mesh 0 has indices 5, expected a whole number from 0",
    ),
    "view longer than the file": (view(byteLength=10**9), "describes 1000000000 bytes of arrays in"),
    "view longer than the buffer": (
        view(byteLength=10_804),
        "buffer view 0 ends at byte 10804, its buffer has 10800",
    ),
    "view behind the buffer": (view(byteOffset=4), "buffer view 0 ends at byte 10804, its buffer has 10800"),
    "view of another buffer": (view(buffer=1), "buffer view 0 is in buffer 1, the file has 1"),
    "view without length": (
        {"bufferViews": [{"buffer": 0}]},
        "buffer view 0 has byteLength missing, expected",
    ),
    "small stride": (view(byteStride=8), "accessor 0 has a byteStride of 8, expected at least 12"),
    "large stride": (view(byteStride=16), "accessor 0 ends at byte 14396, its buffer view has 10800 bytes"),
    "negative stride": (
        view(byteStride=-12),
        "buffer view 0 has byteStride -12, expected a whole number from 1",
    ),
    "ten thousand views": ({"bufferViews": [VIEW] * 10_000}, "describes 108000000 bytes of arrays in"),
    "thousand accessors": ({"accessors": [ACCESSOR] * 1000}, "describes 10800000 bytes of arrays in"),
    "ten thousand primitives": (
        {"meshes": [{"primitives": [PRIMITIVE] * 10_000}]},
        "describes 3000000 triangles",
    ),
    "placed a thousand times": (
        {"nodes": [{"mesh": 0}] * 1000, "scenes": [{"nodes": list(range(1000))}]},
        "describes 300000 triangles in",
    ),
    "a million nodes": ({"nodes": [{"mesh": 0}] + [{}] * 10**5}, "has 100001 parts, at most 1024"),
    "own child": (node(children=[0]), "has a node with two parents"),
    "two parents": (
        {"nodes": [{"children": [2]}, {"children": [2]}, {"mesh": 0}], "scenes": [{"nodes": [0, 1]}]},
        "has a node with two parents",
    ),
    "no such child": (
        node(children=[3]),
        r"node 0 has children \[3\], expected whole numbers from 0, below 1",
    ),
    "half a matrix": (node(matrix=[1] * 15), r"node 0 has matrix \[1, .*, expected 16 finite numbers"),
    "matrix in words": (node(matrix=["1"] * 16), "node 0 has matrix .*, expected 16 finite numbers"),
    "translation in a plane": (
        node(translation=[1, 2]),
        r"node 0 has translation \[1, 2\], expected 3 finite",
    ),
    "rotation around an axis": (
        node(rotation=[1, 0, 0]),
        "node 0 has rotation .*, expected 4 finite numbers",
    ),
    "scale": (node(scale=2), "node 0 has scale 2, expected 3 finite numbers"),
    "not a number": (node(scale=[1, 1, float("nan")]), r"node 0 has scale \[1, 1, nan\], expected 3 finite"),
    "endless number": (
        node(translation=[0, 0, 10**400]),
        "node 0 has translation .*, expected 3 finite numbers",
    ),
    "far away": (node(translation=[-1e308, 0, 0]), r"the coordinate 1e\+308, expected at most 1e\+09 m"),
    "other file": (
        {"buffers": [{"byteLength": 10_800, "uri": "other.bin"}]},
        "keeps its data in another file",
    ),
    "draco": (
        {"extensionsUsed": ["KHR_draco_mesh_compression"]},
        "is compressed with KHR_draco_mesh_compression",
    ),
    "triangle fan": (primitive(mode=6), "primitive 0 of mesh 0 is a triangle fan, which is not supported"),
    "no such mode": (
        primitive(mode=7),
        "primitive 0 of mesh 0 has mode 7, expected one of 0, 1, 2, 3, 4, 5, 6",
    ),
    "points": (primitive(mode=0), "has no triangles in its scene"),
    "no such accessor": (
        primitive(attributes={"POSITION": 7}),
        "primitive 0 of mesh 0 has POSITION 7, expected a whole number from 0, below 1",
    ),
    "no positions": (primitive(attributes={}), "primitive 0 of mesh 0 has POSITION missing, expected"),
    "no such mesh": (node(mesh=7), "node 0 has mesh 7, expected a whole number from 0, below 1"),
    "no meshes": ({"meshes": []}, "has no meshes"),
    "mesh that is nowhere": ({"scenes": [{"nodes": []}]}, "has no triangles in its scene"),
    "no such scene": ({"scene": 1}, "its description has scene 1, expected a whole number from 0, below 1"),
    "wrong type": ({"nodes": 5}, "its description has nodes 5, expected a list"),
    "wrong type in a list": ({"nodes": [5]}, r"its description has nodes\[0\] 5, expected an object"),
}


@pytest.mark.parametrize("case", BAD_GLB)
def test_bad_glb(tmp_path, case):
    changes, message = BAD_GLB[case]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ScanError, match=rf"mesh\.glb: .*{message}") as caught:
            read_scan(write(tmp_path, simple_glb(**changes), "mesh.glb"))
    assert len(str(caught.value)) < len(str(tmp_path)) + 250


def test_glb_with_strides_offsets_and_lines(tmp_path, scanned):
    """Beside a mesh of triangles one of lines, between the scene and the triangles."""
    positions = VERTICES.astype("<f4")
    rows = np.zeros((5, 4), "<f4")
    rows[:, 1:] = positions
    binary = rows.tobytes() + TRIANGLES.astype("<u2").tobytes()
    scene = {
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"mesh": 1, "translation": [1, 0, 0], "children": [1]},
            {"mesh": 0, "scale": [1, 2, 1], "name": ["no", "name"]},
        ],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]},
            {"primitives": [{"attributes": {"POSITION": 0}, "mode": 3}]},
        ],
        "accessors": [
            {"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 5, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 9, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 80, "byteStride": 16},
            {"buffer": 0, "byteOffset": 80, "byteLength": 18},
        ],
        "buffers": [{"byteLength": len(binary)}],
    }
    read_scan(write(tmp_path, glb_bytes(scene, binary), "mesh.glb"))
    x, y, z = (positions * [1, 2, 1] + [1, 0, 0]).T
    np.testing.assert_allclose(
        corners(scanned["vertices"], scanned["faces"]),
        corners(np.column_stack([x, -z, y]), TRIANGLES),
        atol=2e-5,
    )


@pytest.mark.parametrize("text", [b"[" * 100_000, b"[1]   ", b"{}  ", b'{"a":' + b"9" * 99_999 + b"}", b"{"])
def test_glb_with_bad_json(tmp_path, text):
    data = struct.pack("<5I", 0x46546C67, 2, 20 + len(text), len(text), 0x4E4F534A) + text
    with pytest.raises(ScanError, match=r"mesh\.glb: has (a JSON description|a description that|no meshes)"):
        read_scan(write(tmp_path, data, "mesh.glb"))


def test_trimesh_does_not_log(tmp_path, scanned, monkeypatch, caplog):
    load_mesh = trimesh.load_mesh

    def talkative(*args, **options):
        trimesh.util.log.error("said while loading")
        return load_mesh(*args, **options)

    monkeypatch.setattr(trimesh, "load_mesh", talkative)
    read_scan(write(tmp_path, exported("glb"), "mesh.glb"))
    trimesh.util.log.error("said afterwards")
    assert [record.message for record in caplog.records] == ["said afterwards"]
