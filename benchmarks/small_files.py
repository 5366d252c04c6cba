"""What hostile files of 1 MB cost to read, each in a process of its own.

    python benchmarks/small_files.py [--only WORD]

Each process first reads a small honest file of the format, which imports what the format needs and loads its
kernels. Seconds are those of the processor, so that what else runs does not count; "MB" is the highest resident memory after that, above what was there (Linux only); "result" is the
number of points, or the beginning of the refusal. The bar is 2 s and 64 MB.
"""

# One file a line.
# ruff: noqa: E501

from __future__ import annotations

import io
import json
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import lzf
import numpy as np

from common import command

MEGABYTE = 10**6
MOST_SECONDS, MOST_MEGABYTES = 2.0, 64.0
# A process that takes longer is ended, seconds.
LONGEST = 120.0

READ = """
import sys, time, warnings
from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan
def memory(key):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith(key))
warnings.simplefilter("ignore")
camera = {"intrinsics": (500.0, 500.0, 0.0, 0.0)} if sys.argv[1].endswith(".png") else {}
read_scan(sys.argv[1], **camera)
# The highest memory counts from here.
with open("/proc/self/clear_refs", "w") as peak:
    peak.write("5")
before, start = memory("VmRSS"), time.process_time()
try:
    result = f"{len(read_scan(sys.argv[2], **camera))} points"
except ScanError as error:
    result = str(error).removeprefix(f"{sys.argv[2]}: ")
seconds = time.process_time() - start
print(seconds, memory("VmHWM") - before, result[:70].replace(chr(10), " "))
"""


def filled(start: str, piece: str, end: str = "") -> bytes:
    """A text of a megabyte in which a piece repeats."""
    return (start + piece * ((MEGABYTE - len(start) - len(end)) // len(piece)) + end).encode()


def pcd(fields: str, size: str, kind: str, n_points: int, encoding: str, body: bytes) -> bytes:
    """A PCD file."""
    header = f"FIELDS {fields}\nSIZE {size}\nTYPE {kind}\nWIDTH {n_points}\nHEIGHT 1\nDATA {encoding}\n"
    return header.encode() + body


def bytes_pcd(n_points: int) -> bytes:
    """A compressed PCD file with one byte for each coordinate."""
    content = np.ones(3 * n_points, np.uint8).tobytes()
    block = lzf.compress(content)
    sizes = struct.pack("<II", len(block), len(content))
    return pcd("x y z", "1 1 1", "U U U", n_points, "binary_compressed", sizes + block)


def npy(array: np.ndarray) -> bytes:
    """An NPY file."""
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npy_header(description: str, shape: tuple[int, ...], body: bytes) -> bytes:
    """An NPY file whose header says what it likes."""
    header = f"{{'descr': {description}, 'fortran_order': False, 'shape': {shape}}}".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + body


def npz(**arrays: np.ndarray) -> bytes:
    """A deflated NPZ archive."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            archive.writestr(f"{name}.npy", npy(array))
    return stream.getvalue()


def structured(n_points: int) -> np.ndarray:
    """Points of one byte a coordinate."""
    return np.ones(n_points, [("x", "u1"), ("y", "u1"), ("z", "u1")])


def chunk(kind: bytes, content: bytes) -> bytes:
    """A part of a PNG image."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png(width: int, height: int, *more: bytes, pixel: bytes = b"\x03\x84") -> bytes:
    """A depth image with one depth everywhere, and other chunks before its pixels."""
    rows = (b"\0" + pixel * width) * height
    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", header),
            *more,
            chunk(b"IDAT", zlib.compress(rows, 9)),
            chunk(b"IEND", b""),
        ]
    )


def glb(scene: dict[str, object], binary: bytes = b"") -> bytes:
    """A binary glTF file."""
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def triangle_scene(n_faces: int, nodes: list[dict[str, object]], **more: object) -> bytes:
    """A GLB mesh of many faces over the same three vertices, placed by nodes."""
    vertices = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0.1]], np.float32).tobytes()
    faces = bytes(np.tile(np.arange(3, dtype=np.uint8), n_faces))
    children = {child for node in nodes for child in node.get("children", [])}  # type: ignore[attr-defined]
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [index for index in range(len(nodes)) if index not in children]}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [0.1, 0.1, 0.1]},
            {"bufferView": 1, "componentType": 5121, "count": 3 * n_faces, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": len(faces)},
        ],
        "buffers": [{"byteLength": 36 + len(faces)}],
        **more,
    }  # fmt: skip
    return glb(scene, vertices + faces)


def glb_chain(length: int, **mesh: object) -> bytes:
    """A GLB scene of nodes of which each is the child of the one before, the last one with the mesh."""
    nodes: list[dict[str, object]] = [{"children": [index + 1], **mesh} for index in range(length - 1)]
    return triangle_scene(1, [*nodes, {"mesh": 0}])


def stl(n_faces: int) -> bytes:
    """A binary STL file of equal faces."""
    face = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0.1, 0)
    return b"\0" * 80 + struct.pack("<I", n_faces) + face * n_faces


def binary_ply(elements: str, body: bytes) -> bytes:
    """A binary PLY file."""
    return f"ply\nformat binary_little_endian 1.0\n{elements}end_header\n".encode() + body


XYZ = "property {0} x\nproperty {0} y\nproperty {0} z\n"
CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0.1]], "<f4").tobytes()
PLY_ASCII = "ply\nformat ascii 1.0\n"
PLY_VERTICES = "element vertex 3\n" + XYZ.format("float")
PLY_POINTS = "0 0 0\n0.1 0 0\n0 0.1 0.1\n"
FACES = "property list uchar uchar vertex_indices\n"
STL_FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex .1 0 0\nvertex 0 .1 .1\nendloop\nendfacet\n"

SMALL: dict[str, Callable[[], bytes]] = {
    "pcd": lambda: bytes_pcd(100),
    "npy": lambda: npy(np.eye(3)),
    "npz": lambda: npz(points=np.eye(3)),
    "png": lambda: png(32, 32),
    "xyz": lambda: b"0 0 1\n1 0 1\n0 1 1\n",
    "csv": lambda: b"0,0,1\n1,0,1\n0,1,1\n",
    "ply": lambda: (PLY_ASCII + PLY_VERTICES + f"element face 1\n{FACES}end_header\n{PLY_POINTS}3 0 1 2\n").encode(),
    "obj": lambda: b"v 0 0 0\nv .1 0 0\nv 0 .1 .1\nf 1 2 3\n",
    "off": lambda: f"OFF\n3 1 0\n{PLY_POINTS}3 0 1 2\n".encode(),
    "stl": lambda: stl(1),
    "glb": lambda: triangle_scene(1, [{"mesh": 0}]),
}  # fmt: skip

HOSTILE: list[tuple[str, str, Callable[[], bytes]]] = [
    ("pcd", "compressed, 25 million points of 3 bytes", lambda: bytes_pcd(25_000_000)),
    ("pcd", "compressed, a million points of 3 bytes", lambda: bytes_pcd(1_000_000)),
    ("pcd", "binary, points of 3 bytes", lambda: pcd("x y z", "1 1 1", "U U U", 333_000, "binary", b"\1" * 999_000)),
    ("pcd", "ascii, short lines", lambda: pcd("x y z", "4 4 4", "F F F", 166_000, "ascii", filled("", "1 2 3\n"))),
    ("pcd", "ascii, empty lines", lambda: pcd("x y z", "4 4 4", "F F F", 1, "ascii", filled("1 2 3", "\n"))),
    ("pcd", "ascii, one long line", lambda: pcd("x y z", "4 4 4", "F F F", 1, "ascii", filled("", "1 "))),
    ("pcd", "header of comments", lambda: filled("", "#\n")),
    ("npy", "points of 3 bytes", lambda: npy(np.ones((333_000, 3), np.uint8))),
    ("npy", "fields over each other", lambda: npy_header(
        "('u1', {'x': ('u1', 0), 'y': ('u1', 0), 'z': ('u1', 0)})", (999_000,), b"\1" * 999_000)),
    ("npy", "huge shape of no bytes", lambda: npy_header("[('x', '<U0'), ('y', '<U0'), ('z', '<U0')]", (2**40,), b"")),
    ("npy", "nested header", lambda: npy_header("(" * 20_000 + ")" * 20_000, (3, 3), b"\1" * 950_000)),
    ("npy", "header of 10,000 fields", lambda: npy_header(
        repr([("x", "u1"), ("y", "u1"), ("z", "u1"), *((f"{i:x}", "u1") for i in range(3000))]), (300,), b"\1" * 901_000)),
    ("npz", "25 million points of 3 bytes", lambda: npz(points=structured(25_000_000))),
    ("npz", "20 MB of labels", lambda: npz(points=structured(900_000), labels=np.ones(900_000, np.int64))),
    ("npz", "a million points of 24 bytes", lambda: npz(points=np.ones((1_000_000, 3)))),
    ("npz", "5,000 columns", lambda: npz(points=np.ones((8_000, 5_000), np.uint8))),
    ("npz", "100 MB in a member of no name", lambda: npz(other=np.ones((33_000_000, 3), np.uint8))),
    ("png", "8 million pixels", lambda: png(2896, 2896)),
    ("png", "a million pixels", lambda: png(1000, 999)),
    ("png", "8 million pixels, none measured", lambda: png(2896, 2896, pixel=b"\0\0")),
    ("png", "compressed comments", lambda: png(
        32, 32, *[chunk(b"zTXt", b"a\0\0" + zlib.compress(b"a" * 1_000_000, 9))] * 900)),
    ("png", "chunks of no content", lambda: png(32, 32, *[chunk(b"IDAT", b"")] * 83_000)),
    ("xyz", "short lines", lambda: filled("", "1 2 3\n")),
    ("xyz", "empty lines", lambda: filled("1 2 3", "\n")),
    ("xyz", "lines of one letter", lambda: filled("1 2 3\n", "#\n")),
    ("xyz", "one long line of numbers", lambda: filled("", "1 ")),
    ("xyz", "one long word", lambda: filled("", "1")),
    ("xyz", "one long fraction", lambda: filled("0.", "1", " 1 1")),
    ("xyz", "many long fractions", lambda: filled("", "0." + "1" * 60_000 + " 1 1\n")),
    ("xyz", "comments that could name columns", lambda: filled("", "# x y z a b\n", "1 2 3\n")),
    ("csv", "half a million columns", lambda: filled("", "1,")),
    ("csv", "columns with names", lambda: filled("x,y,z", ",a", "\n" + "1," * 200_000)),
    ("ply", "21,000 elements before 100,000 lines", lambda: (
        PLY_ASCII + "element a 0\n" * 21_000 + "element vertex 100000\n" + XYZ.format("char") + "end_header\n"
        + "1 2 3\n" * 100_000).encode()),
    ("ply", "21,000 elements of one line each", lambda: (
        PLY_ASCII + "element a 1\n" * 15_000 + "element vertex 100000\n" + XYZ.format("char") + "end_header\n"
        + "1\n" * 15_000 + "1 2 3\n" * 100_000).encode()),
    ("ply", "12,000 properties of a face of 1 MB", lambda: (
        PLY_ASCII + PLY_VERTICES + f"element face 1\n{FACES}" + "".join(f"property char {i:x}\n" for i in range(12_000))
        + f"end_header\n{PLY_POINTS}3 0 1 2 " + "1 " * 400_000).encode()),
    ("ply", "12,000 lists of a face", lambda: (
        PLY_ASCII + PLY_VERTICES + f"element face 1\n{FACES}"
        + "".join(f"property list char char {i:x}\n" for i in range(8_000))
        + f"end_header\n{PLY_POINTS}3 0 1 2 " + "20 " + "1 " * 20 + ("20 " + "1 " * 20) * 7_999).encode()),
    ("ply", "12,000 properties of binary vertices", lambda: binary_ply(
        "element vertex 80\n" + XYZ.format("char") + "".join(f"property char {i:x}\n" for i in range(12_000)),
        b"\1" * 960_300)),
    ("ply", "21,000 binary elements", lambda: binary_ply(
        "element a 0\n" * 21_000 + "element vertex 200000\n" + XYZ.format("char"), b"\1" * 600_000)),
    ("ply", "binary vertices of 3 bytes", lambda: binary_ply(
        "element vertex 333000\n" + XYZ.format("char"), b"\1" * 999_000)),
    ("ply", "binary faces of no corners", lambda: binary_ply(
        PLY_VERTICES + f"element face 999000\n{FACES}", CORNERS + b"\0" * 999_000)),
    ("ply", "binary faces of one byte a corner", lambda: binary_ply(
        PLY_VERTICES + f"element face 249000\n{FACES}", CORNERS + b"\3\0\1\2" * 249_000)),
    ("ply", "binary faces of 16,384 corners", lambda: binary_ply(
        PLY_VERTICES + "element face 60\nproperty list ushort uchar vertex_indices\n",
        CORNERS + (struct.pack("<H", 16384) + b"\0\1\2\1" * 4096) * 60)),
    ("ply", "header without end", lambda: filled(PLY_ASCII, "comment\n")),
    ("obj", "short faces", lambda: filled("v 0 0 0\nv .1 0 0\nv 0 .1 .1\n", "f 1 2 3\n")),
    ("obj", "small faces, one beside the other", lambda: filled(
        "".join(f"v {i % 100 / 1000} {i // 100 / 1000} 0\n" for i in range(300)), "f 1 2 103\n")),
    ("obj", "faces of 16,384 corners", lambda: filled("v 0 0 0\nv .1 0 0\nv 0 .1 .1\n", "f" + " 1 2 3" * 5461 + "\n")),
    ("obj", "faces of no corners", lambda: filled("v 0 0 0\nv .1 0 0\nv 0 .1 .1\nf 1 2 3\n", "f\n")),
    ("obj", "vertices", lambda: filled("", "v 0 0 0\n", "f 1 2 3\n")),
    ("obj", "groups", lambda: filled("v 0 0 0\nv .1 0 0\nv 0 .1 .1\nf 1 2 3\n", "g\n")),
    ("obj", "continued lines", lambda: filled("v 0 0 0\nv .1 0 0\nv 0 .1 .1\nf 1 2 3", "\\\n")),
    ("obj", "large faces", lambda: filled(
        "v -1 -1 -1\nv 1 1 1\nv -1 1 1\n", "f 1 2 3\n").replace(b"f 1 2 3\n", b"f 1 2 3\n" * 3000 + b"#", 1)[:24_100]),
    ("off", "short faces", lambda: filled(f"OFF\n3 120000 0\n{PLY_POINTS}", "3 0 1 2\n")),
    ("off", "one long line", lambda: filled("OFF ", "1 ")),
    ("off", "comments", lambda: filled("OFF\n", "#\n")),
    ("stl", "binary faces", lambda: stl(19_998)),
    ("stl", "ascii facets", lambda: filled("solid\n", STL_FACET, "endsolid\n")),
    ("stl", "solids", lambda: filled("", f"solid\n{STL_FACET}endsolid\n")),
    ("stl", "empty facets", lambda: filled("solid\n", "facet\n", "endsolid\n")),
    ("stl", "blanks", lambda: filled("solid\n", " ", "\nendsolid\n")),
    ("stl", "lines of blanks", lambda: filled("solid\n", " " * 20_000 + "\n", "endsolid\n")),
    ("glb", "chain of 1,001 nodes", lambda: glb_chain(1_001)),
    ("glb", "chain of 1,001 nodes with a mesh each", lambda: glb_chain(1_001, mesh=0)),
    ("glb", "mesh of 1,000 nodes", lambda: triangle_scene(1, [{"mesh": 0}] * 1_000)),
    ("glb", "faces of 3 bytes", lambda: triangle_scene(330_000, [{"mesh": 0}])),
    ("glb", "faces of 3 bytes, placed 15 times", lambda: triangle_scene(330_000, [{"mesh": 0}] * 15)),
    ("glb", "empty lists in the JSON", lambda: triangle_scene(1, [{"mesh": 0}], extras=[[]] * 330_000)),
    ("glb", "nested lists in the JSON", lambda: glb({"asset": {}}).replace(
        b'{"asset":{}}', b'{"asset":' + b"[" * 100_000 + b"]" * 100_000 + b"}")),
    ("glb", "1,000 meshes of 1,000 primitives", lambda: triangle_scene(
        1, [{"mesh": 0}], meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}] * 20}] * 900)),
    ("glb", "materials and images", lambda: triangle_scene(
        1, [{"mesh": 0}], materials=[{}] * 100_000, images=[{"bufferView": 0}] * 30_000)),
    ("glb", "accessors", lambda: triangle_scene(1, [{"mesh": 0}], accessors=[
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"},
        *[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}] * 14_000])),
]  # fmt: skip


def read(small: Path, hostile: Path) -> tuple[float, float, str]:
    """Seconds, MB and result of reading a file after another one, in a process of its own."""
    program = [sys.executable, "-c", READ, str(small), str(hostile)]
    try:
        done = subprocess.run(program, stdout=subprocess.PIPE, text=True, check=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return LONGEST, float("nan"), "no end"
    seconds, megabytes, result = done.stdout.rstrip("\n").split(" ", 2)
    return float(seconds), float(megabytes), result


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", default="", metavar="WORD", help="files with this word in format or kind")
    options = parser.parse_args()
    print(f"{'file':47}{'MB':>5}{'seconds':>8}{'MB':>6}  {'bar':6}  result")
    worst = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        for suffix, kind, make in HOSTILE:
            if options.only not in f"{suffix} {kind}":
                continue
            small, hostile = Path(folder, f"small.{suffix}"), Path(folder, f"hostile.{suffix}")
            small.write_bytes(SMALL[suffix]())
            hostile.write_bytes(make())
            seconds, megabytes, result = read(small, hostile)
            worst = [max(worst[0], seconds), max(worst[1], megabytes)]
            missed = seconds > MOST_SECONDS or megabytes > MOST_MEGABYTES
            print(
                f"{suffix}: {kind:42}{hostile.stat().st_size / MEGABYTE:5.2f}{seconds:8.2f}"
                f"{megabytes:6.0f}  {'missed' if missed else '':6}  {result}",
                flush=True,
            )
    print(f"slowest {worst[0]:.2f} s, largest {worst[1]:.0f} MB")


if __name__ == "__main__":
    main()
