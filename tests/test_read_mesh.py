"""Meshes: OBJ, STL, OFF, GLB and PLY with faces, down to the scan that the simulator makes of them."""

import json
import struct
import tracemalloc

import numpy as np
import pytest
import trimesh

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources import read_scan, reader

SUFFIXES = ["obj", "stl", "off", "glb", "ply"]
# A unit square and a triangle beside it, in cm around (1, 2, 3).
VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1.0]]) * 0.1 + [1, 2, 3]
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 4]])


@pytest.fixture
def scanned(monkeypatch):
    """The mesh that a reader hands to the simulator."""
    seen = {}

    def scan_mesh(vertices, faces, *, random_state, name):
        seen.update(vertices=vertices, faces=faces, random_state=random_state)
        return Scan(vertices, name=name)

    monkeypatch.setattr(reader, "scan_mesh", scan_mesh)
    return seen


def write(tmp_path, data, name):
    path = tmp_path / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


def corners(vertices, faces):
    """Triangles as sorted coordinates, which do not depend on how a file shares its vertices."""
    return np.array(sorted(np.round(vertices[faces], 5).reshape(-1, 9).tolist()))


def exported(file_type):
    mesh = trimesh.Trimesh(VERTICES, TRIANGLES, process=False)
    data = mesh.export(file_type=file_type)
    return data.encode() if isinstance(data, str) else data


@pytest.mark.parametrize("file_type", [*SUFFIXES, "stl_ascii"])
def test_written_by_trimesh(tmp_path, scanned, file_type):
    path = write(tmp_path, exported(file_type), f"mesh.{file_type.partition('_')[0]}")
    assert read_scan(path).name == str(path)
    vertices = scanned["vertices"]
    if file_type == "glb":
        vertices = np.column_stack([vertices[:, 0], vertices[:, 2], -vertices[:, 1]])
    np.testing.assert_allclose(corners(vertices, scanned["faces"]), corners(VERTICES, TRIANGLES), atol=2e-5)
    assert scanned["random_state"] == 0


V = "".join(f"v {x} {y} {z}\n" for x, y, z in VERTICES)


@pytest.mark.parametrize(
    "text",
    [
        V + "f 1 2 3\nf 1 3 4\nf 1 2 5\n",
        V + "f 1 2 3 4\nf 1 2 5\n",
        V + "f -5 -4 -3 -2\nf -5 -4 -1\n",
        "mtllib ghost.mtl\no thing\n"
        + V
        + "vt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1 4/1/1\ns off\nf 1//1 2//1 5//1",
        "# é\r\n" + V.replace("\n", " 0.5 0.5 0.5\r\n") + "f 1 2 3 \\\r\n 4\r\nf 1 2 5\r\n",
        V + "f -5 -4 -3 -2\nf 1 2 5\nv 9 9 9\n",
    ],
)
def test_obj_as_people_write_it(tmp_path, scanned, text):
    read_scan(write(tmp_path, text.encode("latin-1"), "mesh.obj"))
    np.testing.assert_array_equal(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES)
    )


ROWS = "".join(f"{x} {y} {z}\n" for x, y, z in VERTICES)


@pytest.mark.parametrize(
    "text",
    [
        "OFF\n5 2 0\n" + ROWS + "4 0 1 2 3\n3 0 1 4\n",
        "OFF 5 2 0\n\n# comment\n" + ROWS + "4 0 1 2 3 255 0 0\n3 0 1 4 # red\n",
        "COFF\n5 3\n" + ROWS.replace("\n", " 255 0 0 255\n") + "3 0 1 2\n3 0 2 3\n3 0 1 4\n",
    ],
)
def test_off_as_people_write_it(tmp_path, scanned, text):
    read_scan(write(tmp_path, text, "mesh.off"))
    np.testing.assert_array_equal(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES)
    )


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("name", ["vertex_indices", "vertex_index"])
def test_ply_with_mixed_polygons(tmp_path, scanned, form, name):
    order = ">" if form.endswith("big_endian") else "<"
    header = (
        f"ply\nformat {form} 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 2\nproperty uchar red\n"
        f"property list uchar int {name}\nproperty list uchar float uv\nend_header\n"
    ).encode()
    if form == "ascii":
        body = (ROWS + "255 4 0 1 2 3 2 0.5 0.5\n255 3 0 1 4 0\n").encode()
    else:
        body = VERTICES.astype(order + "f8").tobytes()
        body += struct.pack(order + "BB4iB2f", 255, 4, 0, 1, 2, 3, 2, 0.5, 0.5)
        body += struct.pack(order + "BB3iB", 255, 3, 0, 1, 4, 0)
    read_scan(write(tmp_path, header + body, "mesh.ply"))
    np.testing.assert_array_equal(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES)
    )

    for lost in (3, 6, 20):
        with pytest.raises(ScanError, match=r"mesh\.ply"):
            read_scan(write(tmp_path, (header + body)[:-lost], "mesh.ply"))
    for n_faces in (b"3", b"123456789012345678"):
        with pytest.raises(ScanError, match=r"mesh\.ply: is truncated"):
            read_scan(write(tmp_path, header.replace(b"face 2", b"face " + n_faces) + body, "mesh.ply"))
    with pytest.raises(ScanError, match="list of integers"):
        read_scan(write(tmp_path, header.replace(name.encode(), b"corners") + body, "mesh.ply"))


def test_stl_with_names_that_look_like_keywords(tmp_path, scanned):
    text = exported("stl_ascii").decode().strip()
    lines = text.splitlines()
    lines[0], lines[-1] = "solid vertex facet", "endsolid vertex facet"
    both = "\n".join([*lines, *lines])
    read_scan(write(tmp_path, both, "mesh.stl"))
    np.testing.assert_allclose(
        corners(scanned["vertices"], scanned["faces"]),
        corners(np.vstack([VERTICES, VERTICES]), np.vstack([TRIANGLES, TRIANGLES])),
        atol=1e-5,
    )


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


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_real_simulator_scans_it(tmp_path, suffix):
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    box.export(tmp_path / f"box.{suffix}")
    scan = read_scan(tmp_path / f"box.{suffix}")
    assert len(scan) > 100
    assert scan.name.endswith(f"box.{suffix}")
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])
    np.testing.assert_array_equal(scan.points, read_scan(tmp_path / f"box.{suffix}").points)


BAD = {
    "obj index too large": ("obj", V + "f 1 2 6\n"),
    "obj index zero": ("obj", V + "f 0 1 2\n"),
    "obj index too negative": ("obj", V + "f -6 1 2\n"),
    "obj index not a number": ("obj", V + "f 1 2 x\n"),
    "obj index huge": ("obj", V + "f 1 2 " + "9" * 30 + "\n"),
    "obj index very huge": ("obj", V + "f 1 2 " + "9" * 9999 + "\n"),
    "obj coordinate not a number": ("obj", V + "v 1 x 3\nf 1 2 3\n"),
    "obj two coordinates": ("obj", V + "v 1 2\nf 1 2 3\n"),
    "obj no vertices": ("obj", "f 1 2 3\n"),
    "obj no faces": ("obj", V),
    "obj nan": ("obj", V.replace("2.0", "nan") + "f 1 2 3\n"),
    "obj random": ("obj", np.random.default_rng(0).bytes(9999)),
    "off index too large": ("off", "OFF\n5 1 0\n" + ROWS + "3 0 1 5\n"),
    "off index negative": ("off", "OFF\n5 1 0\n" + ROWS + "3 0 1 -1\n"),
    "off too few corners": ("off", "OFF\n5 1 0\n" + ROWS + "4 0 1 2\n"),
    "off too few faces": ("off", "OFF\n5 2 0\n" + ROWS + "3 0 1 2\n"),
    "off too few vertices": ("off", "OFF\n9999999999 1 0\n" + ROWS),
    "off negative": ("off", "OFF\n-5 1 0\n" + ROWS + "3 0 1 2\n"),
    "off no counts": ("off", "OFF\n"),
    "off no header": ("off", ROWS),
    "off random": ("off", np.random.default_rng(0).bytes(9999)),
    "stl truncated": ("stl", exported("stl")[:-1]),
    "stl more faces than there are": (
        "stl",
        exported("stl")[:80] + b"\xff\xff\xff\xff" + exported("stl")[84:],
    ),
    "stl ascii truncated": ("stl", exported("stl_ascii")[:-40]),
    "stl ascii damaged number": ("stl", exported("stl_ascii").replace(b"vertex 1", b"vertex x1", 1)),
    "stl ascii damaged keyword": ("stl", exported("stl_ascii").replace(b"vertex", b"vortex", 3)),
    "stl no faces": ("stl", "solid a\nendsolid a\n"),
    "stl empty binary": ("stl", bytes(84)),
    "stl random": ("stl", np.random.default_rng(0).bytes(9999)),
    "glb truncated": ("glb", exported("glb")[:-8]),
    "glb random": ("glb", np.random.default_rng(0).bytes(9999)),
    "glb magic only": ("glb", b"glTF"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_mesh(tmp_path, case):
    suffix, data = BAD[case]
    with pytest.raises(ScanError, match=rf"mesh\.{suffix}: "):
        read_scan(write(tmp_path, data, f"mesh.{suffix}"))


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
BAD_GLB = {
    "zeros from nothing": {"accessors": [{"componentType": 5126, "count": 10**12, "type": "VEC3"}]},
    "more than the view": {"accessors": [{**ACCESSOR, "count": 901}]},
    "negative count": {"accessors": [{**ACCESSOR, "count": -3}]},
    "view longer than the file": {"bufferViews": [{"buffer": 0, "byteLength": 10**12}]},
    "ten thousand views": {"bufferViews": [{"buffer": 0, "byteLength": 10_800}] * 10_000},
    "thousand accessors": {"accessors": [ACCESSOR] * 1000},
    "ten thousand primitives": {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}] * 10_000}]},
    "placed a thousand times": {"nodes": [{"mesh": 0}] * 1000, "scenes": [{"nodes": list(range(1000))}]},
    "a million nodes": {"nodes": [{"mesh": 0}] + [{}] * 10**5},
    "own child": {"nodes": [{"mesh": 0, "children": [0]}]},
    "two parents": {
        "nodes": [{"children": [2]}, {"children": [2]}, {"mesh": 0}],
        "scenes": [{"nodes": [0, 1]}],
    },
    "other file": {"buffers": [{"byteLength": 10_800, "uri": "other.bin"}]},
    "draco": {"extensionsUsed": ["KHR_draco_mesh_compression"]},
    "triangle fan": {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}]},
    "points": {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}]},
    "no such accessor": {"meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]},
    "no such mesh": {"nodes": [{"mesh": 7}]},
    "no meshes": {"meshes": []},
    "wrong type": {"nodes": 5},
}


@pytest.mark.parametrize("case", BAD_GLB)
def test_bad_glb(tmp_path, case):
    with pytest.raises(ScanError, match=r"mesh\.glb: "):
        read_scan(write(tmp_path, simple_glb(**BAD_GLB[case]), "mesh.glb"))


@pytest.mark.parametrize("text", [b"[" * 100_000, b"[1]   ", b"{}  ", b'{"a":' + b"9" * 99_999 + b"}"])
def test_glb_with_bad_json(tmp_path, text):
    data = struct.pack("<5I", 0x46546C67, 2, 20 + len(text), len(text), 0x4E4F534A) + text
    with pytest.raises(ScanError, match=r"mesh\.glb: "):
        read_scan(write(tmp_path, data, "mesh.glb"))


def test_trimesh_does_not_log(tmp_path, scanned, monkeypatch, caplog):
    load_mesh = trimesh.load_mesh

    def talkative(*args, **options):
        trimesh.util.log.error("said while loading")
        return load_mesh(*args, **options)

    monkeypatch.setattr(trimesh, "load_mesh", talkative)
    read_scan(write(tmp_path, exported("stl"), "mesh.stl"))
    with pytest.raises(ScanError):
        read_scan(write(tmp_path, BAD["stl ascii damaged number"][1], "mesh.stl"))
    trimesh.util.log.error("said afterwards")
    assert [record.message for record in caplog.records] == ["said afterwards"]


def test_trimesh_does_not_log_what_it_repairs(tmp_path, scanned, caplog):
    read_scan(write(tmp_path, exported("stl_ascii").replace(b"normal ", b"normal x", 1), "mesh.stl"))
    assert len(scanned["faces"]) == 3
    assert caplog.records == []


@pytest.mark.parametrize("trailing", [b"\0", b"\0" * 49, b"made by a program\n", bytes(500)])
def test_stl_with_more_after_the_last_face(tmp_path, scanned, trailing):
    read_scan(write(tmp_path, exported("stl") + trailing, "mesh.stl"))
    np.testing.assert_allclose(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES), atol=2e-5
    )


def limited(path):
    """The reader's answer, with the memory that it took in bytes."""
    tracemalloc.start()
    try:
        with pytest.raises(ScanError) as caught:
            read_scan(path)
        return str(caught.value), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


PLY_HEADER = (
    "ply\nformat {} 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 1\nproperty list uint int vertex_indices\nend_header\n"
)
ENDLESS = " 1 2 3 4" * 250_000


@pytest.mark.parametrize(
    ("suffix", "data"),
    [
        ("obj", V + "f" + ENDLESS),
        ("obj", V + "f 1 2 3\nv" + ENDLESS),
        ("off", "OFF\n5 1 0\n" + ROWS + "1000000" + ENDLESS),
        ("ply", PLY_HEADER.format("ascii") + ROWS + "1000000" + ENDLESS),
        ("xyz", ENDLESS),
        ("pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n" + ENDLESS),
    ],
)
def test_endless_line(tmp_path, suffix, data):
    path = write(tmp_path, data, f"mesh.{suffix}")
    message, peak = limited(path)
    assert "has a line of 200000" in message
    assert peak < 10 * path.stat().st_size


@pytest.mark.parametrize("suffix", ["obj", "ply"])
def test_endless_face(tmp_path, suffix):
    if suffix == "obj":
        data = V + "f" + " 1 2 3 4" * 5000
    else:
        data = PLY_HEADER.format("binary_little_endian").encode() + VERTICES.tobytes()
        data += struct.pack("<I20000i", 20_000, *[0, 1, 2, 3] * 5000)
    message, _ = limited(write(tmp_path, data, f"mesh.{suffix}"))
    assert "a face has 20000 corners" in message


def test_polygon_of_many_corners(tmp_path, scanned):
    angles = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    rows = "".join(f"v {np.cos(angle):.9f} {np.sin(angle):.9f} 0\n" for angle in angles)
    read_scan(
        write(tmp_path, rows + "f " + " ".join(map(str, range(1, 5001))) + "\nf 1 2\nf 1 2 3\n", "mesh.obj")
    )
    fan = [[0, second, second + 1] for second in range(1, 4999)]
    np.testing.assert_array_equal(scanned["faces"], [*fan, [0, 1, 2]])


@pytest.mark.parametrize("kind", [ZeroDivisionError, IndexError])
def test_a_hole_in_the_simulator_names_the_file(tmp_path, monkeypatch, kind):
    def scan_mesh(*args, **options):
        raise kind("nobody thought of it")

    monkeypatch.setattr(reader, "scan_mesh", scan_mesh)
    with pytest.raises(ScanError, match=rf"mesh\.stl: .*{kind.__name__}: nobody thought of it") as caught:
        read_scan(write(tmp_path, exported("stl"), "mesh.stl"))
    assert isinstance(caught.value.__cause__, kind)


def test_a_mesh_that_cannot_be_scanned_is_named_once(tmp_path):
    path = write(tmp_path, exported("stl"), "mesh.stl")
    large = trimesh.Trimesh(VERTICES * 1000, TRIANGLES, process=False).export(file_type="stl")
    path.write_bytes(large)
    with pytest.raises(ScanError) as caught:
        read_scan(path)
    assert str(caught.value).startswith(f"{path}: the mesh is ")
