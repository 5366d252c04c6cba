"""Small files that ask for much: memory is bounded by the file or by a limit, time by the file."""

import io
import json
import struct
import tracemalloc
import zipfile

import lzf
import numpy as np
import pytest
import trimesh
from PIL import Image

from shapeconcepts.io import glb, ply
from shapeconcepts.io.glb import MOST_LEVELS, checked_glb
from shapeconcepts.io.mesh import MOST_TRIANGLES
from shapeconcepts.io.unpacking import MOST_POINTS_VARIABLE, check_unpacked
from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan

MEGABYTE = 2**20
ONE_BYTE = [("x", "u1"), ("y", "u1"), ("z", "u1")]


def read(path, data, **options):
    """What is read from a file, and the highest memory that it took."""
    path.write_bytes(data)
    tracemalloc.start()
    try:
        return read_scan(path, **options)
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 64 * MEGABYTE


def pcd(n_points, *, padding=0, random=False):
    content = np.ones((3 + padding) * n_points, np.uint8)
    if random:
        content[:n_points] = np.random.default_rng(0).integers(0, 255, n_points, np.uint8)
    header = (
        f"FIELDS x y z{' _' if padding else ''}\nSIZE 1 1 1{' 1' if padding else ''}\n"
        f"TYPE U U U{' U' if padding else ''}\nCOUNT 1 1 1{f' {padding}' if padding else ''}\n"
        f"WIDTH {n_points}\nHEIGHT 1\nDATA binary_compressed\n"
    )
    block = lzf.compress(content.tobytes()) or b""
    return header.encode() + struct.pack("<II", len(block), content.size) + block


def npz(**arrays):
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def png(width, height):
    stream = io.BytesIO()
    Image.fromarray(np.full((height, width), 900, np.uint16)).save(stream, "PNG")
    return stream.getvalue()


CAMERA = {"intrinsics": (500.0, 500.0, 0.0, 0.0)}
BOMBS = [
    ("a.pcd", lambda: pcd(5_000_000), {}),
    ("a.pcd", lambda: pcd(1_000_001), {}),
    ("a.pcd", lambda: pcd(300_000, padding=120), {}),
    ("a.npz", lambda: npz(points=np.ones(1_000_001, ONE_BYTE)), {}),
    ("a.npz", lambda: npz(points=np.ones((1_000_001, 3), np.bool_)), {}),
    ("a.npz", lambda: npz(points=np.ones((6_000, 6_000), np.uint8)), {}),
    ("a.npz", lambda: npz(other=np.ones((1001, 1001, 3), np.uint8)), {}),
    ("a.npz", lambda: npz(points=np.ones((9, 3)), labels=np.ones(40_000_000, np.uint8)), {}),
    ("a.npz", lambda: npz(points=np.ones((9, 3)), viewpoint=np.ones(5_000_000)), {}),
    ("a.png", lambda: png(1001, 1000), CAMERA),
]


@pytest.mark.parametrize(("name", "make", "options"), BOMBS)
def test_what_unpacks_to_much_is_refused_and_says_how_to_read_it(tmp_path, name, make, options):
    with pytest.raises(ScanError, match=rf"a\.\w+: unpacks from \d+ bytes to .*{MOST_POINTS_VARIABLE}"):
        read(tmp_path / name, make(), **options)


@pytest.mark.parametrize(("name", "make", "options"), [BOMBS[1], BOMBS[3], BOMBS[4], BOMBS[9]])
def test_the_limit_can_be_raised(tmp_path, monkeypatch, name, make, options):
    monkeypatch.setenv(MOST_POINTS_VARIABLE, "2000000")
    (tmp_path / name).write_bytes(make())
    assert len(read_scan(tmp_path / name, **options)) in (1_000_001, 1_001_000)


@pytest.mark.parametrize("text", ["many", "-1", "1e6", "²", "9" * 30])
def test_limit_that_is_no_number(tmp_path, monkeypatch, text):
    monkeypatch.setenv(MOST_POINTS_VARIABLE, text)
    (tmp_path / "a.pcd").write_bytes(pcd(100))
    with pytest.raises(ScanError, match=f"{MOST_POINTS_VARIABLE} must be a number of points, got '"):
        read_scan(tmp_path / "a.pcd")


@pytest.mark.parametrize(
    ("name", "make", "options"),
    [
        ("a.pcd", lambda: pcd(1_000_000), {}),
        ("a.npz", lambda: npz(points=np.ones(1_000_000, ONE_BYTE)), {}),
        ("a.npz", lambda: npz(points=np.ones((1_000_000, 3)), viewpoint=np.zeros(3)), {}),
        ("a.npz", lambda: npz(points=np.ones((720, 1280, 3), "f4"), labels=np.ones((720, 1280), "u1")), {}),
        ("a.png", lambda: png(1280, 720), CAMERA),
    ],
)  # fmt: skip
def test_frame_of_a_depth_camera_is_read_in_little_memory(tmp_path, name, make, options):
    assert len(read(tmp_path / name, make(), **options)) >= 720 * 1280


def test_large_file_may_hold_as_many_points_as_it_has_bytes(tmp_path):
    data = pcd(1_500_000, random=True)
    (tmp_path / "a.pcd").write_bytes(data)
    assert len(data) > 1_500_000
    assert len(read_scan(tmp_path / "a.pcd")) == 1_500_000
    check_unpacked(480_000_000, 90_000_000, 10_000_000)


def npy(description, shape, body):
    header = f"{{'descr': {description}, 'fortran_order': False, 'shape': {shape}}}".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + body


@pytest.mark.parametrize(
    "data",
    [
        npy("('u1', {'x': ('u1', 0), 'y': ('u1', 0), 'z': ('u1', 0)})", (999_000,), b"\1" * 999_000),
        npy("[('x', '<U0'), ('y', '<U0'), ('z', '<U0')]", (2**40,), b""),
        npy("[('x', 'u1', (0,)), ('y', 'u1', (0,)), ('z', 'u1', (0,))]", (2**40,), b""),
        npy("'<f8'", (2**40, 3), b"\0" * 24),
        npy("[('x', 'u1', (1000000,)), ('y', 'u1'), ('z', 'u1')]", (2**40,), b"\0" * 24),
        npy("('u1', (3000000000,))", (3, 3), b"\0" * 24),
    ],
)
def test_npy_header_that_promises_much(tmp_path, data):
    with pytest.raises(ScanError):
        read(tmp_path / "a.npy", data)


def test_archive_that_says_less_than_it_holds(tmp_path):
    data = bytearray(npz(points=np.ones((2_000_000, 3))))
    true_size = zipfile.ZipFile(io.BytesIO(bytes(data))).infolist()[0].file_size
    small = struct.pack("<I", 1000)
    for place in [
        place for place in range(len(data) - 3) if data[place : place + 4] == struct.pack("<I", true_size)
    ]:
        data[place : place + 4] = small
    with pytest.raises(ScanError, match=r"a\.npz"):
        read(tmp_path / "a.npz", bytes(data))


HEADER = "ply\nformat {} 1.0\n"
VERTEX = "element vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"


class CountedLines(list):
    """Lines of a file that count how many of them were copied."""

    n_copied = 0

    def __getitem__(self, index):
        found = super().__getitem__(index)
        if isinstance(index, slice):
            type(self).n_copied += len(found)
            return CountedLines(found)
        return found


@pytest.mark.parametrize("n_rows", [0, 1])
@pytest.mark.parametrize("behind", [False, True], ids=["before the vertices", "behind them"])
def test_ply_of_many_elements_copies_its_lines_once(tmp_path, monkeypatch, n_rows, behind):
    monkeypatch.setattr(CountedLines, "n_copied", 0)
    monkeypatch.setattr(ply, "_lines_with_content", lambda data: CountedLines(data.decode().splitlines()))
    others, rows = f"element a {n_rows}\nproperty char b\n" * 300, ["1"] * (300 * n_rows)
    vertices, points = VERTEX.format(2000, *["char"] * 3), ["1 2 3"] * 2000
    header = vertices + others if behind else others + vertices
    lines = points + rows if behind else rows + points
    content = f"{HEADER.format('ascii')}{header}end_header\n" + "\n".join(lines) + "\n"
    assert len(read(tmp_path / "a.ply", content.encode())) == 2000
    assert 0 < CountedLines.n_copied <= 2 * len(lines)


FACE = "element face {}\nproperty list uchar {} vertex_indices\n"
TRIANGLE = "0 0 0\n0.1 0 0\n0 0.1 0.1\n"


@pytest.mark.parametrize("kind", ["scalars", "lists", "scalars before"])
def test_ply_of_many_face_properties(tmp_path, kind):
    scalars = "".join(f"property char p{i}\n" for i in range(3_000))
    lists = "".join(f"property list char char p{i}\n" for i in range(2_000))
    header = HEADER.format("ascii") + VERTEX.format(3, *["float"] * 3) + FACE.format(1, "int")
    corners, row = "3 0 1 2 ", "1 " * 3_000
    if kind == "scalars before":
        header = header.replace("property list", f"{scalars}property list")
        line = row + corners
    else:
        header += scalars if kind == "scalars" else lists
        line = corners + (row if kind == "scalars" else "2 1 1 " * 2_000)
    plain = HEADER.format("ascii") + VERTEX.format(3, *["float"] * 3) + FACE.format(1, "int")
    scan = read(tmp_path / "a.ply", f"{header}end_header\n{TRIANGLE}{line}\n".encode())
    expected = read(tmp_path / "b.ply", f"{plain}end_header\n{TRIANGLE}{corners}\n".encode())
    np.testing.assert_array_equal(scan.points, expected.points)


CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0.1]], "<f4").tobytes()


@pytest.mark.parametrize(
    ("n_faces", "body", "message"),
    [
        (900_000, b"\0" * 900_000, "faces of two corners or more do not fit"),
        (30_000, b"\0" * 90_000, "no faces"),
        (60_000, b"\3\0\1\2" * 60_000, "faces cover"),
        (3_515, (b"\xff" + b"\0\1\2" * 85) * 3_515, "describes 889295 triangles in 9"),
    ],
)
def test_binary_ply_of_many_faces(tmp_path, n_faces, body, message):
    header = HEADER.format("binary_little_endian") + VERTEX.format(3, *["float"] * 3)
    header += FACE.format(n_faces, "uchar") + "end_header\n"
    with pytest.raises(ScanError, match=message):
        read(tmp_path / "a.ply", header.encode() + CORNERS + body)


def scene(change=None):
    """JSON and binary part of a GLB file of a box, changed."""
    data = trimesh.creation.box((0.1, 0.2, 0.1)).export(file_type="glb")
    length = struct.unpack_from("<I", data, 12)[0]
    description = json.loads(data[20 : 20 + length])
    if change is not None:
        change(description)
    text = json.dumps(description).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<5I", 0x46546C67, 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    return head + text + rest


def chain(n_nodes, *, meshes=False):
    def change(description):
        nodes = [{"children": [index + 1]} for index in range(n_nodes - 1)]
        description["nodes"] = [*nodes, {}]
        for node in description["nodes"] if meshes else description["nodes"][-1:]:
            node["mesh"] = 0
        description["scenes"] = [{"nodes": [0]}]

    return change


@pytest.mark.parametrize("meshes", [True, False])
def test_glb_chain(tmp_path, meshes):
    expected = read(tmp_path / "a.glb", scene())
    scan = read(tmp_path / "a.glb", scene(chain(MOST_LEVELS)))
    np.testing.assert_array_equal(scan.points, expected.points)
    with pytest.raises(ScanError, match="has nodes below more than 64 others"):
        read(tmp_path / "a.glb", scene(chain(1001, meshes=meshes)))


def test_glb_chain_that_bites_its_tail(tmp_path):
    def change(description):
        chain(3)(description)
        description["nodes"][-1]["children"] = [1]

    with pytest.raises(ScanError, match="has a node with two parents"):
        read(tmp_path / "a.glb", scene(change))


def test_glb_of_many_triangles_in_few_bytes(tmp_path):
    def change(description):
        description["nodes"] = [{"mesh": 0}] * 100
        description["scenes"] = [{"nodes": list(range(100))}]

    assert len(read(tmp_path / "a.glb", scene(change))) > 0
    n_faces = MOST_TRIANGLES + 1
    faces = np.tile(np.arange(3, dtype=np.uint8), n_faces).tobytes()

    def more(description):
        description["accessors"][0].update(count=3 * n_faces, componentType=5121)
        description["bufferViews"][0].update(byteLength=len(faces))

    with pytest.raises(ScanError, match=f"describes {n_faces} triangles"):
        checked_glb(scene(more) + faces)


def test_only_shapes_reach_the_library(tmp_path):
    def change(description):
        description["extras"] = description["nodes"][0]["extras"] = [[]] * 1000
        description["meshes"][0]["extras"] = {"a": [[]] * 1000}
        description["images"] = [{"bufferView": 0}] * 1000
        description["materials"] = description["animations"] = description["skins"] = [{}] * 1000

    assert len(checked_glb(scene(change))) == len(checked_glb(scene()))
    np.testing.assert_array_equal(
        read(tmp_path / "a.glb", scene(change)).points, read(tmp_path / "b.glb", scene()).points
    )


@pytest.mark.parametrize("name", glb.COMPRESSIONS)
def test_compression_that_the_file_does_not_declare(tmp_path, name):
    def change(description):
        description["meshes"][0]["primitives"][0]["extensions"] = {name: {"bufferView": 0}}

    with pytest.raises(ScanError, match=f"is compressed with {name}"):
        read(tmp_path / "a.glb", scene(change))
