"""PLY point clouds: ascii and both byte orders, labels, and damage. Meshes are in test_read_mesh."""

import numpy as np
import pytest
import trimesh

from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan

FORMATS = ["ascii", "binary_little_endian", "binary_big_endian"]
NUMPY = {"float": "f4", "double": "f8", "uchar": "u1", "int": "i4", "ushort": "u2", "int16": "i2"}


def ply_bytes(properties, columns, form="ascii", before="", before_body=b"", after=""):
    n = len(columns[0])
    order = ">" if form.endswith("big_endian") else "<"
    header = f"ply\nformat {form} 1.0\ncomment made by a test\nobj_info °\n{before}element vertex {n}\n"
    header += "".join(f"property {kind} {name}\n" for name, kind in properties) + after + "end_header\n"
    rows = np.empty(n, [(name, order + NUMPY[kind]) for name, kind in properties])
    for (name, _), column in zip(properties, columns, strict=True):
        rows[name] = column
    if form == "ascii":
        body = "".join(" ".join(str(value) for value in row.item()) + "\n" for row in rows).encode()
    else:
        body = rows.tobytes()
    return header.encode() + before_body + body


XYZ = [("x", "float"), ("y", "float"), ("z", "float")]


def cloud(n=100):
    points = np.random.default_rng(0).normal(0, 0.05, (n, 3)) + np.array([0.1, 0.0, 0.8])
    return points.astype(np.float32).astype(np.float64)


def write(tmp_path, data):
    (tmp_path / "scan.ply").write_bytes(data)
    return tmp_path / "scan.ply"


@pytest.mark.parametrize("form", FORMATS)
def test_plain_cloud(tmp_path, form):
    points = cloud()
    scan = read_scan(write(tmp_path, ply_bytes(XYZ, points.T, form)))
    np.testing.assert_array_equal(scan.points, points)
    assert scan.point_labels is None


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("label", ["label", "labels"])
def test_any_order_and_types_with_duplicates_and_nan(tmp_path, form, label):
    """Rows stay as they are: a mesh library would merge the equal points."""
    points = cloud() + 1e-12
    points[3] = points[4] = points[5]
    points[7] = np.nan
    labels = np.arange(len(points)) - 50
    properties = [
        ("red", "uchar"),
        ("z", "double"),
        (label, "int16"),
        ("x", "double"),
        ("nx", "float"),
        ("y", "double"),
    ]
    columns = [np.full(len(points), 255), points[:, 2], labels, points[:, 0], points[:, 0], points[:, 1]]
    scan = read_scan(write(tmp_path, ply_bytes(properties, columns, form)))
    np.testing.assert_array_equal(scan.points, points)
    np.testing.assert_array_equal(scan.point_labels, labels)


@pytest.mark.parametrize("form", FORMATS)
def test_other_elements_around_the_vertices(tmp_path, form):
    points = cloud(4)
    order = ">" if form.endswith("big_endian") else "<"
    camera = b"1.5 2\n2.5 3\n" if form == "ascii" else np.array([(1.5, 2), (2.5, 3)], order + "f4").tobytes()
    data = ply_bytes(
        XYZ,
        points.T,
        form,
        before="element camera 2\nproperty float a\nproperty float b\n",
        before_body=camera,
        after="element range_grid 2\nproperty list uchar int vertex_indices\nelement face 0\n",
    )
    np.testing.assert_array_equal(read_scan(write(tmp_path, data)).points, points)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_written_by_trimesh(tmp_path, encoding):
    points = cloud()
    written = trimesh.PointCloud(points, colors=np.full((len(points), 4), 200, dtype=np.uint8))
    (tmp_path / "scan.ply").write_bytes(written.export(file_type="ply", encoding=encoding))
    np.testing.assert_allclose(read_scan(tmp_path / "scan.ply").points, points, atol=1e-7)


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("element vertex 100", "element vertex 101", "truncated"),
        ("element vertex 100", "element vertex 100000000000000", "truncated"),
        ("element vertex 100", "element vertex 0", "no points"),
        ("element vertex 100", "element vertex -1", "line"),
        ("element vertex 100", "element vertex " + "9" * 500, "line"),
        ("element vertex", "element vertices", "no element vertex"),
        ("float z", "float w", "no property z"),
        ("float z", "float y", "twice"),
        ("float z", "quad z", "line 'property quad z'|property z .*not known"),
        ("float z", "float z\nproperty float z", "twice"),
        ("float z", "float z\nproperty list uchar int l", "list"),
        ("ply\n", "poly\n", "not a PLY"),
        ("end_header", "header_ends", "not a PLY"),
        ("1.0\n", "1.0 1.0\n", "line"),
    ],
)
def test_bad_header(tmp_path, form, old, new, message):
    data = ply_bytes(XYZ, cloud().T, form)
    assert old.encode() in data
    with pytest.raises(ScanError, match=rf"scan\.ply: .*{message}"):
        read_scan(write(tmp_path, data.replace(old.encode(), new.encode(), 1)))


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("kept", [0.01, 0.3, 0.9, 0.98])
def test_truncated(tmp_path, form, kept):
    data = ply_bytes(XYZ, cloud().T, form)
    with pytest.raises(ScanError):
        read_scan(write(tmp_path, data[: int(len(data) * kept)]))


def test_header_without_format(tmp_path):
    data = ply_bytes(XYZ, cloud().T).replace(b"format ascii 1.0\n", b"")
    with pytest.raises(ScanError, match="format"):
        read_scan(write(tmp_path, data))


@pytest.mark.parametrize("form", FORMATS)
def test_nothing_finite(tmp_path, form):
    with pytest.raises(ScanError, match="finite"):
        read_scan(write(tmp_path, ply_bytes(XYZ, np.full((3, 5), np.inf), form)))


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_axes_in_capitals(tmp_path, form):
    header = (
        f"ply\nformat {form} 1.0\nelement vertex 2\nproperty float Z\nproperty float X\nproperty float y\n"
        "end_header\n"
    )
    body = b"3 1 2\n6 4 5\n" if form == "ascii" else np.array([3, 1, 2, 6, 4, 5], "<f4").tobytes()
    (tmp_path / "a.ply").write_bytes(header.encode() + body)
    np.testing.assert_array_equal(read_scan(tmp_path / "a.ply").points, [[1, 2, 3], [4, 5, 6]])


def test_small_axes_come_before_capitals(tmp_path):
    header = "ply\nformat ascii 1.0\nelement vertex 1\n" + "".join(
        f"property float {name}\n" for name in "XYZxyz"
    )
    (tmp_path / "a.ply").write_text(header + "end_header\n7 8 9 1 2 3\n")
    np.testing.assert_array_equal(read_scan(tmp_path / "a.ply").points, [[1, 2, 3]])


def test_endless_header(tmp_path):
    (tmp_path / "a.ply").write_text("ply\nformat ascii 1.0\n" + "element a 0\n" * 50_000 + "end_header\n")
    with pytest.raises(ScanError, match=r"a\.ply: .*header does not end"):
        read_scan(tmp_path / "a.ply")
