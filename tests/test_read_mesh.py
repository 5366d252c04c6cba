"""Meshes: OBJ, STL, OFF, GLB and PLY with faces, down to the scan that the simulator makes of them."""

import struct
import tracemalloc

import numpy as np
import pytest
import trimesh

from mesh_examples import TRIANGLES, VERTICES, corners, exported, write
from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan, reader
from shapeconcepts.sources.reader import read_views

SUFFIXES = ["obj", "stl", "off", "glb", "ply"]


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
        "NOFF 5 2 0\n" + ROWS.replace("\n", " 0 0 1\n") + "4 0 1 2 3\n3 0 1 4\n",
        "STCN4OFF\n5 2 0\n" + ROWS.replace("\n", " 1 0 0 1 255 0 0 255 0 0\n") + "4 0 1 2 3\n3 0 1 4\n",
        "\ufeffOFF5 2 0\n" + ROWS + "4 0 1 2 3\n3 0 1 4\n",
    ],
)
def test_off_as_people_write_it(tmp_path, scanned, text):
    read_scan(write(tmp_path, text, "mesh.off"))
    np.testing.assert_array_equal(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES)
    )


def test_off_of_modelnet(tmp_path, scanned):
    text = "OFF4 4 0\n0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
    read_scan(write(tmp_path, text, "mesh.off"))
    np.testing.assert_array_equal(scanned["vertices"], [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    np.testing.assert_array_equal(scanned["faces"], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.mark.parametrize(
    ("suffix", "text"),
    [("obj", "# a cloud\no thing\n" + V), ("obj", "\ufeff" + V), ("off", "OFF\n5 0 0\n" + ROWS)],
)
@pytest.mark.parametrize(("z", "viewpoint"), [(0.0, [0, 0, 0]), (-6.0, None)])
def test_vertices_without_faces_are_a_cloud(tmp_path, suffix, text, z, viewpoint):
    moved = VERTICES * [0.1, 0.1, 1] + [0, 0, z]
    for before, after in zip(VERTICES, moved, strict=True):
        text = text.replace(" ".join(map(str, before)), " ".join(map(str, after)))
    path = write(tmp_path, text, f"cloud.{suffix}")
    scan = read_scan(path)
    np.testing.assert_array_equal(scan.points, moved)
    assert (None if scan.viewpoint is None else scan.viewpoint.tolist()) == viewpoint
    assert read_views(path, 3) == []


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


def test_ascii_stl_without_its_last_line(tmp_path, scanned):
    text = exported("stl_ascii").decode()
    end = text.rindex("endsolid")
    for cut in (text[:end], text[:end].rstrip(), text[:end].upper()):
        read_scan(write(tmp_path, cut, "mesh.stl"))
        np.testing.assert_allclose(
            corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES), atol=1e-5
        )
    # Only behind its facets is it complete.
    for cut in range(1, len(text[:end].rstrip())):
        if text[:cut].rstrip().endswith("endfacet"):
            continue
        with pytest.raises(ScanError, match=r"is truncated|is not an STL file"):
            read_scan(write(tmp_path, text[:cut], "mesh.stl"))


def test_facet_that_is_no_triangle(tmp_path):
    lines = exported("stl_ascii").decode().splitlines(keepends=True)
    fourth = [number for number, line in enumerate(lines) if "vertex" in line][3]
    for n_corners, text in ((2, []), (4, lines[fourth : fourth + 1] * 2)):
        with pytest.raises(ScanError, match=f"is damaged: facet 2 has {n_corners} vertices, expected 3"):
            changed = [*lines[:fourth], *text, *lines[fourth + 1 :]]
            read_scan(write(tmp_path, "".join(changed), "mesh.stl"))


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
    "obj no vertices, no faces": ("obj", "o thing\n"),
    "obj vertex without coordinates": ("obj", "v\n" + V + "f 1 2 3\n"),
    "obj nan": ("obj", V.replace("2.0", "nan") + "f 1 2 3\n"),
    "obj random": ("obj", np.random.default_rng(0).bytes(9999)),
    "off index too large": ("off", "OFF\n5 1 0\n" + ROWS + "3 0 1 5\n"),
    "off index negative": ("off", "OFF\n5 1 0\n" + ROWS + "3 0 1 -1\n"),
    "off too few corners": ("off", "OFF\n5 1 0\n" + ROWS + "4 0 1 2\n"),
    "off too few faces": ("off", "OFF\n5 2 0\n" + ROWS + "3 0 1 2\n"),
    "off too few vertices": ("off", "OFF\n9999999999 1 0\n" + ROWS),
    "off negative": ("off", "OFF\n-5 1 0\n" + ROWS + "3 0 1 2\n"),
    "off no counts": ("off", "OFF\n"),
    "off unknown prefix": ("off", "XOFF\n5 1 0\n" + ROWS + "3 0 1 2\n"),
    "off no vertices": ("off", "OFF 0 0 0\n"),
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


def test_normals_of_an_ascii_stl_do_not_matter(tmp_path, scanned):
    read_scan(write(tmp_path, exported("stl_ascii").replace(b"normal ", b"normal x", 1), "mesh.stl"))
    assert len(scanned["faces"]) == 3


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
        read_scan(path, units="m")
    assert str(caught.value).startswith(f"{path}: the mesh is ")


@pytest.mark.parametrize("more", ["; made by somebody\n", "end of file\n", "\n\n"])
def test_ascii_stl_with_more_behind_it(tmp_path, scanned, more):
    text = exported("stl_ascii").decode()
    read_scan(write(tmp_path, text.rstrip() + "\n" + more, "mesh.stl"))
    np.testing.assert_allclose(
        corners(scanned["vertices"], scanned["faces"]), corners(VERTICES, TRIANGLES), atol=1e-5
    )
    read_scan(write(tmp_path, text.replace("endsolid", "end solid"), "mesh.stl"))
