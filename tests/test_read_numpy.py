"""NPY and NPZ files."""

import io
import zipfile

import numpy as np
import pytest

from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.sources import read_scan

POINTS = np.random.default_rng(0).normal(0, 0.05, (100, 3)) + np.array([0, 0, 0.8])


def npy_bytes(array, **options):
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def npy_with_header(header, body=b"\0" * 240, version=1):
    padded = header.encode() + b"\n"
    return b"\x93NUMPY" + bytes([version, 0]) + len(padded).to_bytes(2 * version, "little") + padded + body


def write(tmp_path, data, name="scan.npy"):
    (tmp_path / name).write_bytes(data)
    return tmp_path / name


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">f4", "f2", "<i4", ">i2", "u1", "<u8", "longdouble"])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("columns", [3, 7])
def test_array(tmp_path, dtype, order, columns):
    array = np.asarray(np.random.default_rng(1).integers(1, 100, (20, columns)), dtype=dtype, order=order)
    scan = read_scan(write(tmp_path, npy_bytes(array)))
    np.testing.assert_array_equal(scan.points, array[:, :3].astype(np.float64))


def test_version_2_header(tmp_path):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, POINTS, version=(2, 0))
    np.testing.assert_array_equal(read_scan(write(tmp_path, stream.getvalue())).points, POINTS)


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_archive(tmp_path, save):
    labels = np.arange(100)
    save(tmp_path / "scan.npz", points=POINTS, viewpoint=[1.0, 2.0, 3.0], labels=labels, other=["text"])
    scan = read_scan(tmp_path / "scan.npz")
    np.testing.assert_array_equal(scan.points, POINTS)
    np.testing.assert_array_equal(scan.viewpoint, [1, 2, 3])
    np.testing.assert_array_equal(scan.point_labels, labels)


def test_archive_with_points_only(tmp_path):
    np.savez(tmp_path / "scan.npz", points=POINTS)
    scan = read_scan(tmp_path / "scan.npz")
    assert scan.point_labels is None
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


def test_archive_with_a_given_origin_is_believed_outside_of_the_cloud_only(tmp_path):
    for offset, expected in (([0.3, 0, 0], [0, 0, 0]), ([0, 0, 0], None)):
        points = np.random.default_rng(0).uniform(-0.1, 0.1, (100, 3)) + offset
        np.savez(tmp_path / "scan.npz", points=points, viewpoint=np.zeros(3))
        viewpoint = read_scan(tmp_path / "scan.npz").viewpoint
        assert (viewpoint is None) if expected is None else (viewpoint == expected).all()


class _Unpickled:
    def __reduce__(self):
        return (pytest.fail, ("a pickle was run",))


HEADER = "{'descr': '<f8', 'fortran_order': False, 'shape': (%s)}"
BAD_NPY = {
    "pickled": (npy_bytes(np.array([[_Unpickled()] * 3], dtype=object), allow_pickle=True), "object"),
    "strings": (npy_bytes(np.array([["a", "b", "c"]])), "numbers"),
    "complex": (npy_bytes(np.ones((5, 3), dtype=complex)), "numbers"),
    "fields without z": (npy_bytes(np.zeros(5, dtype=[("x", "f4"), ("y", "f4")])), "no field z"),
    "field of text": (npy_bytes(np.zeros(5, dtype=[("x", "f4"), ("y", "f4"), ("z", "S4")])), "field z"),
    "field of vectors": (npy_bytes(np.zeros(5, dtype=[("x", "3f4"), ("y", "f4"), ("z", "f4")])), "field x"),
    "fields of one point": (npy_bytes(np.zeros((), dtype=[(axis, "f4") for axis in "xyz"])), "shape"),
    "fields with objects": (
        npy_bytes(np.zeros(5, dtype=[*((axis, "f4") for axis in "xyz"), ("o", "O")]), allow_pickle=True),
        "numbers",
    ),
    "by column": (npy_bytes(np.ones((3, 50))), r"\(n, 3\) is expected, got \(3, n\)"),
    "two channels": (npy_bytes(np.ones((8, 9, 2))), "shape"),
    "four axes": (npy_bytes(np.ones((2, 8, 9, 3))), "axes"),
    "more axes than numpy has": (npy_with_header(HEADER % ("1, " * 99 + "3")), "axes"),
    "no rows of huge size": (npy_with_header(HEADER % "0, 99999999999999999999999", b""), "NPY"),
    "no rows of many sizes": (npy_with_header(HEADER % f"0, {2**62}, {2**62}", b""), "NPY"),
    "true rows": (npy_with_header(HEADER % "True, 3"), "NPY"),
    "size of more digits than int prints": (npy_with_header(HEADER % ("0x" + "f" * 8000 + ", 3")), "NPY"),
    "flat": (npy_bytes(np.ones(30)), "shape"),
    "two columns": (npy_bytes(np.ones((30, 2))), "shape"),
    "scalar": (npy_bytes(np.array(1.0)), "shape"),
    "no rows": (npy_bytes(np.ones((0, 3))), "no points"),
    "all nan": (npy_bytes(np.full((5, 3), np.nan)), "finite"),
    "truncated": (npy_bytes(POINTS)[:-1], "truncated"),
    "cut header": (npy_bytes(POINTS)[:40], "NPY"),
    "too many rows": (
        npy_with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (11, 3)}"),
        "truncated",
    ),
    "huge shape": (
        npy_with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 3)}"),
        "NPY|truncated",
    ),
    "negative": (
        npy_with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 3)}"),
        "NPY|truncated",
    ),
    "wide items": (
        npy_with_header("{'descr': '<U999999999', 'fortran_order': False, 'shape': (1, 3)}"),
        "NPY|numbers",
    ),
    "huge header": (npy_with_header("{'descr': '<f8'" + " " * 10**6 + "}", version=2), "NPY"),
    "nested header": (npy_with_header("(" * 9000), "NPY"),
    "code": (npy_with_header("__import__('os').abort()"), "NPY"),
    "random": (np.random.default_rng(0).bytes(5000), "NPY"),
    "jpeg": (b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(range(256)), "NPY"),
}


@pytest.mark.parametrize("case", BAD_NPY)
@pytest.mark.filterwarnings("ignore")
def test_bad_array(tmp_path, case):
    data, message = BAD_NPY[case]
    with pytest.raises(ScanError, match=rf"scan\.npy: .*({message})"):
        read_scan(write(tmp_path, data))
    with zipfile.ZipFile(tmp_path / "scan.npz", "w") as archive:
        archive.writestr("points.npy", data)
    with pytest.raises(ScanError, match=rf"scan\.npz: .*({message})"):
        read_scan(tmp_path / "scan.npz")


def zip_bytes(content, method=zipfile.ZIP_DEFLATED):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        archive.writestr("points.npy", content)
    return stream.getvalue()


def two_arrays():
    stream = io.BytesIO()
    np.savez(stream, first=POINTS, second=POINTS)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (zip_bytes(npy_bytes(np.zeros((3_000_000, 3)))), "unpacks from"),
        (zip_bytes(npy_bytes(POINTS), zipfile.ZIP_BZIP2), "compressed in a way"),
        (zip_bytes(npy_bytes(POINTS), zipfile.ZIP_LZMA), "compressed in a way"),
        (zip_bytes(npy_bytes(POINTS))[:-30], "not an NPZ"),
        (two_arrays(), "no array points"),
        (np.random.default_rng(0).bytes(5000), "not an NPZ"),
    ],
    ids=["bomb", "bzip2", "lzma", "truncated", "other name", "random"],
)
def test_bad_archive(tmp_path, data, message):
    with pytest.raises(ScanError, match=rf"scan\.npz: .*{message}"):
        read_scan(write(tmp_path, data, "scan.npz"))


def test_archive_with_a_damaged_member(tmp_path):
    data = bytearray(zip_bytes(npy_bytes(POINTS)))
    data[200:220] = b"\xff" * 20
    with pytest.raises(ScanError, match="damaged"):
        read_scan(write(tmp_path, bytes(data), "scan.npz"))


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"labels": np.arange(99)}, "labels"),
        ({"labels": np.full(100, 0.5)}, "label"),
        ({"labels": np.array(["a"] * 100)}, "numbers"),
        ({"viewpoint": np.zeros(4)}, "viewpoint"),
    ],
)
def test_bad_extras_of_an_archive_are_left_out(tmp_path, arrays, message):
    np.savez(tmp_path / "scan.npz", points=POINTS, **arrays)
    with pytest.warns(ScanWarning, match=rf"scan\.npz has .*{message}.*: the points are used without"):
        scan = read_scan(tmp_path / "scan.npz")
    np.testing.assert_array_equal(scan.points, POINTS)
    assert scan.point_labels is None


@pytest.mark.parametrize("shape", ["(0, 99999999999999999999999)", "(True, 3)", "(-1, 3)"])
def test_absurd_shapes_are_refused(tmp_path, shape):
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    path = tmp_path / "absurd.npy"
    path.write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    with pytest.raises(ScanError, match=r"absurd\.npy"):
        read_scan(path)


def test_organised_arrays_are_taken_row_by_row(tmp_path):
    points = np.full((48, 64, 3), np.nan)
    points[10:30, 20:40] = np.random.default_rng(0).uniform(0, 0.1, (20, 20, 3))
    labels = np.arange(48 * 64).reshape(48, 64)
    np.save(tmp_path / "organised.npy", points)
    np.savez_compressed(tmp_path / "organised.npz", points=points, labels=labels)
    np.testing.assert_array_equal(read_scan(tmp_path / "organised.npy").points, points.reshape(-1, 3))
    scan = read_scan(tmp_path / "organised.npz")
    np.testing.assert_array_equal(scan.points, points.reshape(-1, 3))
    np.testing.assert_array_equal(scan.point_labels, labels.reshape(-1))


def test_frame_of_a_depth_camera_that_is_mostly_empty_is_no_bomb(tmp_path):
    points = np.full((480, 640, 3), np.nan)
    points[200:260, 300:360] = np.random.default_rng(0).uniform(0, 0.1, (60, 60, 3))
    np.savez_compressed(tmp_path / "frame.npz", points=points)
    assert len(read_scan(tmp_path / "frame.npz")) == 480 * 640


def test_only_array_of_an_archive_needs_no_name(tmp_path):
    points = np.random.default_rng(0).uniform(0, 0.1, (50, 3))
    np.savez(tmp_path / "unnamed.npz", points)
    np.testing.assert_array_equal(read_scan(tmp_path / "unnamed.npz").points, points)


def test_transposed_array_is_refused(tmp_path):
    np.save(tmp_path / "transposed.npy", np.zeros((3, 4000)))
    with pytest.raises(ScanError, match=r"\(3, 4000\), \(n, 3\) is expected"):
        read_scan(tmp_path / "transposed.npy")


@pytest.mark.parametrize("shape", [(20,), (4, 5)])
@pytest.mark.parametrize("label", ["label", "labels", None])
def test_structured_array(tmp_path, shape, label):
    fields = [("z", ">f4"), ("name", "S3"), ("x", "<f8"), ("y", "<i2")]
    array = np.zeros(shape, dtype=[*fields, (label, "u1")] if label else fields)
    values = np.random.default_rng(3).integers(1, 100, (3, 20))
    for axis, column in zip("xyz", values, strict=True):
        array[axis] = column.reshape(shape)
    if label:
        array[label] = np.arange(20).reshape(shape)
    np.savez(tmp_path / "scan.npz", points=array)
    for path in (write(tmp_path, npy_bytes(array)), tmp_path / "scan.npz"):
        scan = read_scan(path)
        np.testing.assert_array_equal(scan.points, values.T)
        if label:
            np.testing.assert_array_equal(scan.point_labels, range(20))
        else:
            assert scan.point_labels is None


def test_structured_viewpoint(tmp_path):
    np.savez(tmp_path / "scan.npz", points=POINTS, viewpoint=np.zeros(3, dtype=[("x", "f4")]))
    with pytest.warns(ScanWarning, match="viewpoint must be 3 numbers"):
        read_scan(tmp_path / "scan.npz")


def test_bytes_that_unpack_to_many_points(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", points=np.ones((3_000_000, 3), np.uint8))
    with pytest.raises(ScanError, match=r"a\.npz: unpacks from \d+ bytes to 9000128 with 3000000 points"):
        read_scan(tmp_path / "a.npz")
