"""PCD: every encoding and layout, written here and by other writers, and every kind of damage."""

import struct
from pathlib import Path

import lzf
import numpy as np
import pypcd4
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.sources import read_scan

ENCODINGS = ["ascii", "binary", "binary_compressed"]
CODES = {"F": "f", "I": "i", "U": "u"}


def pcd_bytes(fields, columns, encoding="binary", *, width=None, height=1, drop=(), **replaced):
    """A PCD file: fields is a list of (name, type, size, count), columns one array (n, count) for each."""
    n = len(columns[0])
    columns = [
        np.reshape(column, (n, count)).astype(f"<{CODES[kind]}{size}")
        for column, (_, kind, size, count) in zip(columns, fields, strict=True)
    ]
    header = {
        "VERSION": "0.7",
        "FIELDS": " ".join(field[0] for field in fields),
        "SIZE": " ".join(str(field[2]) for field in fields),
        "TYPE": " ".join(field[1] for field in fields),
        "COUNT": " ".join(str(field[3]) for field in fields),
        "WIDTH": str(n if width is None else width),
        "HEIGHT": str(height),
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(n),
        "DATA": encoding,
    }
    header.update({key: str(value) for key, value in replaced.items()})
    text = "# .PCD v0.7 - Point Cloud Data file format\n"
    text += "".join(f"{key} {value}\n" for key, value in header.items() if key not in drop)
    if encoding == "ascii":
        rows = zip(*columns, strict=True)
        body = "".join(" ".join(str(v.item()) for cell in row for v in cell) + "\n" for row in rows).encode()
    elif encoding == "binary":
        body = b"".join(cell.tobytes() for row in zip(*columns, strict=True) for cell in row)
    else:
        body = compressed(b"".join(column.tobytes() for column in columns))
    return text.encode() + body


def compressed(content):
    block = lzf.compress(content, len(content) * 2 + 100)
    return struct.pack("<II", len(block), len(content)) + block


XYZ = [("x", "F", 4, 1), ("y", "F", 4, 1), ("z", "F", 4, 1)]


def cloud(n=200, seed=0):
    """Points in a camera frame, exact in float32."""
    points = np.random.default_rng(seed).normal(0, 0.05, (n, 3)) + np.array([0.1, 0.0, 0.8])
    return points.astype(np.float32).astype(np.float64)


def write(tmp_path, data, name="scan.pcd"):
    path = tmp_path / name
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_plain_cloud(tmp_path, encoding):
    points = cloud()
    scan = read_scan(write(tmp_path, pcd_bytes(XYZ, points.T, encoding)))
    np.testing.assert_array_equal(scan.points, points)
    assert scan.point_labels is None
    assert scan.label is None
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_organised_cloud_with_everything(tmp_path, encoding):
    """Any field order, normals, packed colour, COUNT above 1, padding, label, float64 and missing points."""
    points = cloud(6 * 4) + 1e-12
    points[5] = np.nan
    n = len(points)
    fields = [
        ("label", "U", 2, 1),
        ("z", "F", 8, 1),
        ("_", "U", 1, 3),
        ("rgb", "U", 4, 1),
        ("x", "F", 8, 1),
        ("fpfh", "F", 4, 33),
        ("_", "U", 1, 1),
        ("y", "F", 8, 1),
        ("normal_x", "F", 4, 1),
        ("curvature", "I", 8, 1),
    ]
    labels = np.arange(n) * 2000
    columns = [labels, points[:, 2], np.ones((n, 3)), np.full(n, 2**32 - 1), points[:, 0]]
    columns += [
        np.random.default_rng(1).random((n, 33)),
        np.ones(n),
        points[:, 1],
        np.ones(n),
        np.full(n, -(2**40)),
    ]
    scan = read_scan(write(tmp_path, pcd_bytes(fields, columns, encoding, width=6, height=4)))
    np.testing.assert_array_equal(scan.points, points)
    np.testing.assert_array_equal(scan.point_labels, labels)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    ("kind", "size"), [("F", 4), ("F", 8), ("I", 2), ("I", 4), ("U", 1), ("I", 1), ("I", 8)]
)
def test_coordinates_of_any_type(tmp_path, encoding, kind, size):
    points = np.random.default_rng(2).integers(0, 100, (50, 3)).astype(float)
    fields = [(axis, kind, size, 1) for axis in "xyz"]
    scan = read_scan(write(tmp_path, pcd_bytes(fields, points.T, encoding)))
    np.testing.assert_array_equal(scan.points, points)


@pytest.mark.parametrize("encoding", list(pypcd4.Encoding)[:3])
def test_written_by_pypcd4(tmp_path, encoding):
    points = cloud().astype(np.float32)
    labels = np.arange(len(points), dtype=np.uint8)
    written = pypcd4.PointCloud.from_points(
        [*points.T, labels], ("x", "y", "z", "label"), (np.float32, np.float32, np.float32, np.uint8)
    )
    written.save(tmp_path / "scan.pcd", encoding)
    scan = read_scan(tmp_path / "scan.pcd")
    np.testing.assert_allclose(scan.points, points, rtol=1e-6)
    np.testing.assert_array_equal(scan.point_labels, labels)


def test_real_files_agree_with_pypcd4(shared_data):
    paths = [
        shared_data / "osd_learn" / "learn33.pcd",
        *sorted(shared_data.glob("seven_shapes/*/*.pcd"))[::50],
        *sorted(shared_data.glob("restaurant_views/*/*.pcd"))[::50],
    ]
    for path in paths:
        scan, other = read_scan(path), pypcd4.PointCloud.from_path(path)
        np.testing.assert_array_equal(scan.points, other.numpy(("x", "y", "z")))
        if "label" in other.fields:
            np.testing.assert_array_equal(scan.point_labels, other.pc_data["label"])
        if path.parts[-3] == "restaurant_views":
            assert scan.viewpoint is None
        else:
            np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


def test_old_header_without_count_viewpoint_and_points(tmp_path):
    points = cloud()
    data = pcd_bytes(XYZ, points.T, "ascii", drop=("VERSION", "COUNT", "VIEWPOINT", "POINTS", "HEIGHT"))
    np.testing.assert_array_equal(read_scan(write(tmp_path, data)).points, points)
    data = pcd_bytes(XYZ, points.T, "ascii", drop=("WIDTH", "HEIGHT")).replace(b"FIELDS", b"COLUMNS")
    np.testing.assert_array_equal(read_scan(write(tmp_path, data)).points, points)


def test_ascii_as_people_write_it(tmp_path):
    data = pcd_bytes(XYZ, cloud(2).T, "ascii", WIDTH=3, POINTS=3)
    header = data[: data.index(b"DATA ascii\n") + len(b"DATA ascii\n")]
    text = header.replace(b"\n", b"\r\n") + b"  0.5\t0   1.25e0\r\n\r\nnan -nan inf\r\n1 2 4\r\n"
    np.testing.assert_array_equal(
        read_scan(write(tmp_path, text)).points, [[0.5, 0, 1.25], [np.nan, np.nan, np.inf], [1, 2, 4]]
    )


def test_float_labels_are_whole_numbers_or_left_out(tmp_path):
    fields = [*XYZ, ("label", "F", 4, 1)]
    data = pcd_bytes(fields, [*cloud(3).T, [0, 7, -1]])
    np.testing.assert_array_equal(read_scan(write(tmp_path, data)).point_labels, [0, 7, -1])
    for label in (0.5, np.nan, 1e30):
        with pytest.warns(
            ScanWarning, match=r"scan\.pcd has labels that cannot be read .*: the points are used without"
        ):
            scan = read_scan(write(tmp_path, pcd_bytes(fields, [*cloud(3).T, [0, 7, label]])))
        assert scan.point_labels is None and len(scan) == 3 and len(scan.notices) == 1


def test_label_that_no_int64_holds(tmp_path):
    data = pcd_bytes([*XYZ, ("label", "U", 8, 1)], [*cloud(2).T, np.array([0, 2**63], dtype=np.uint64)])
    with pytest.warns(ScanWarning, match="labels that cannot be read"):
        assert read_scan(write(tmp_path, data)).point_labels is None


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("kept", [0.3, 0.9, 0.995])
def test_truncated(tmp_path, encoding, kept):
    # Digits missing from the very last number of an ascii file cannot be noticed: 0.995 takes more than that.
    data = pcd_bytes(XYZ, cloud().T, encoding)
    with pytest.raises(ScanError, match=r"scan\.pcd: .*(truncated|cannot be read)"):
        read_scan(write(tmp_path, data[: int(len(data) * kept)]))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"WIDTH": 201, "POINTS": 201}, "truncated|block says"),
        ({"WIDTH": 10**15, "POINTS": 10**15}, "truncated|block says"),
        ({"WIDTH": 10**30, "POINTS": 10**30}, "WIDTH"),
        ({"WIDTH": -200, "POINTS": 200}, "WIDTH"),
        ({"WIDTH": "many"}, "WIDTH"),
        ({"WIDTH": 100, "POINTS": 200}, "POINTS is 200"),
        ({"HEIGHT": 0}, "POINTS is 200"),
        ({"WIDTH": 0, "POINTS": 0}, "no points|block says"),
        ({"TYPE": "F F D"}, "unknown TYPE"),
        ({"SIZE": "4 4 3"}, "unknown TYPE F with SIZE 3"),
        ({"SIZE": "4 4 2"}, "unknown TYPE F with SIZE 2"),
        ({"SIZE": "4 4"}, "3 FIELDS with 2 SIZE"),
        ({"COUNT": "1 1"}, "2 COUNT"),
        ({"COUNT": "1 1 0"}, "COUNT 1, got 0"),
        ({"COUNT": "1 1 2"}, "COUNT 1"),
        ({"COUNT": "1 1 99999999999999"}, "COUNT 1"),
        ({"COUNT": "1 1 -1"}, "COUNT"),
        ({"FIELDS": "x y w"}, "no field z"),
        ({"FIELDS": "x y y"}, "twice"),
        ({"FIELDS": ""}, "no FIELDS"),
        ({"DATA": "base64"}, "DATA"),
        ({"DATA": ""}, "DATA"),
    ],
)
def test_bad_header(tmp_path, encoding, changes, message):
    with pytest.raises(ScanError, match=rf"scan\.pcd: .*({message})"):
        read_scan(write(tmp_path, pcd_bytes(XYZ, cloud().T, encoding, **changes)))


@pytest.mark.parametrize("compressed_by", [-8, -1, 1, 2**31])
@pytest.mark.parametrize("plain_by", [0, -1, 1, 2**31])
def test_compressed_block_that_lies(tmp_path, compressed_by, plain_by):
    data = pcd_bytes(XYZ, cloud().T, "binary_compressed")
    start = data.index(b"binary_compressed\n") + len(b"binary_compressed\n")
    sizes = struct.unpack_from("<II", data, start)
    lie = struct.pack("<II", sizes[0] + compressed_by, sizes[1] + plain_by)
    # What follows the block would be there to be read.
    with pytest.raises(ScanError, match="block"):
        read_scan(write(tmp_path, data[:start] + lie + data[start + 8 :] + b"\0" * 4))


def test_compressed_block_cannot_promise_more_than_lzf_can_hold(tmp_path):
    data = pcd_bytes(XYZ, cloud().T, "binary_compressed", WIDTH=10**8, POINTS=10**8)
    start = data.index(b"binary_compressed\n") + len(b"binary_compressed\n")
    size = struct.unpack_from("<I", data, start)[0]
    data = data[:start] + struct.pack("<II", size, 12 * 10**8) + data[start + 8 :]
    with pytest.raises(ScanError, match="cannot hold"):
        read_scan(write(tmp_path, data))


def test_most_compressible_cloud_is_read(tmp_path):
    """The limit on what a block can hold leaves room for the best case of LZF."""
    points = np.zeros((100_000, 3))
    scan = read_scan(write(tmp_path, pcd_bytes(XYZ, points.T, "binary_compressed")))
    np.testing.assert_array_equal(scan.points, points)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_nothing_finite(tmp_path, encoding):
    with pytest.raises(ScanError, match="finite"):
        read_scan(write(tmp_path, pcd_bytes(XYZ, np.full((3, 5), np.nan), encoding)))


def test_table_that_does_not_fit_the_header(tmp_path):
    header, _, table = pcd_bytes(XYZ, cloud(3).T, "ascii").partition(b"DATA ascii\n")
    with pytest.raises(ScanError, match="4 columns"):
        read_scan(write(tmp_path, header + b"DATA ascii\n" + table.replace(b"\n", b" 1\n")))
    with pytest.raises(ScanError, match="4 columns"):
        read_scan(write(tmp_path, header + b"DATA ascii\n" + table[:-1] + b" 1\n"))


@pytest.mark.parametrize(
    "data",
    [
        b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(range(256)) * 50,
        b"Dear all,\nplease find attached\n" * 100,
        np.random.default_rng(0).bytes(20_000),
        b"FIELDS x y z\n" + b"A" * 200_000,
        b"\n" * 1000,
        b"\x1c\n",
    ],
    ids=["jpeg", "text", "random", "long line", "blank", "blank to str only"],
)
def test_not_a_pcd_file(tmp_path, data):
    with pytest.raises(ScanError, match=r"scan\.pcd: is not a PCD file"):
        read_scan(write(tmp_path, data))


@settings(max_examples=60, deadline=None)
@given(
    st.integers(1, 40),
    st.sampled_from(ENCODINGS),
    st.permutations(["x", "y", "z", "label", "rgb", "extra"]),
    st.lists(st.sampled_from([("F", 4), ("F", 8)]), min_size=3, max_size=3),
    st.integers(0, 2**32 - 1),
)
def test_any_layout(tmp_path_factory, n, encoding, order, types, seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(n, 3)).astype(np.float32).astype(np.float64)
    labels = rng.integers(-100, 100, n)
    layout = {
        **{
            axis: (kind, size, 1, points[:, i])
            for i, (axis, (kind, size)) in enumerate(zip("xyz", types, strict=True))
        },
        "label": ("I", 4, 1, labels),
        "rgb": ("U", 4, 1, rng.integers(0, 2**32, n)),
        "extra": ("U", 1, 5, rng.integers(0, 255, (n, 5))),
    }
    fields = [(name, *layout[name][:3]) for name in order]
    path = write(
        tmp_path_factory.mktemp("pcd"), pcd_bytes(fields, [layout[name][3] for name in order], encoding)
    )
    scan = read_scan(path)
    np.testing.assert_array_equal(scan.points, points)
    np.testing.assert_array_equal(scan.point_labels, labels)


def test_name_is_the_path(tmp_path, monkeypatch):
    write(tmp_path, pcd_bytes(XYZ, cloud().T))
    monkeypatch.chdir(tmp_path)
    assert read_scan("scan.pcd").name == "scan.pcd"
    assert read_scan(Path("scan.pcd")).name == "scan.pcd"


@pytest.mark.parametrize("count", ["1 1 1", "1 1 999999999999999999"])
def test_empty_binary_file_holds_no_points(tmp_path, count):
    path = tmp_path / "empty.pcd"
    path.write_text(
        f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT {count}\nWIDTH 0\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 0\nDATA binary\n"
    )
    with pytest.raises(ScanError, match=r"empty\.pcd"):
        read_scan(path)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
@pytest.mark.parametrize("count", [1, 999999999999999999])
def test_no_points_and_no_body(tmp_path, encoding, count):
    """Padding of any size is promised for nothing."""
    header = (
        f"VERSION 0.7\nFIELDS x y z _\nSIZE 4 4 4 8\nTYPE F F F F\nCOUNT 1 1 1 {count}\n"
        f"WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA {encoding}\n"
    )
    with pytest.raises(ScanError, match=r"scan\.pcd: holds no points"):
        read_scan(write(tmp_path, header.encode()))


@pytest.mark.parametrize("change", [str.upper, str.title, str.lower])
@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_header_in_capitals_and_small_letters(tmp_path, change, encoding):
    lines = ["SIZE 4 4 4", "TYPE F F F", "WIDTH 2", "HEIGHT 1", "POINTS 2", f"DATA {encoding}"]
    body = b"1 2 3\n4 5 6\n" if encoding == "ascii" else np.arange(1, 7, dtype="<f4").tobytes()
    header = "FIELDS x y z\n" + "".join(f"{change(line)}\n" for line in lines)
    (tmp_path / "a.pcd").write_bytes(header.encode() + body)
    np.testing.assert_array_equal(read_scan(tmp_path / "a.pcd").points, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize("viewpoint", ["0 0", "a b c"])
def test_a_viewpoint_that_cannot_be_read_is_left_out(tmp_path, viewpoint):
    path = write(tmp_path, pcd_bytes(XYZ, cloud().T, "ascii", VIEWPOINT=viewpoint))
    with pytest.warns(ScanWarning, match="VIEWPOINT must begin with 3 numbers"):
        np.testing.assert_array_equal(read_scan(path).points, cloud())
