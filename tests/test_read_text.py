"""XYZ, TXT and CSV tables."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan

POINTS = [[0.1, -0.2, 1.0], [0.15, 0.0, 1.1], [0.0, 2.5e-2, 1.2]]


def read(tmp_path, text, name="scan.xyz"):
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_scan(tmp_path / name)


@pytest.mark.parametrize("name", ["scan.xyz", "scan.txt", "scan.csv", "SCAN.XYZ"])
@pytest.mark.parametrize(
    "text",
    [
        "0.1 -0.2 1\n0.15 0 1.1\n0 2.5e-2 1.2\n",
        "0.1 -0.2 1\n0.15 0 1.1\n0 2.5e-2 1.2",
        "  0.1\t-0.2   1\r\n\r\n0.15 0 1.1\r\n 0 2.5e-2 1.2 \r\n\r\n",
        "0.1,-0.2,1\n0.15, 0, 1.1\n0,2.5e-2,1.2\n",
        "0.1;-0.2;1\n0.15;0;1.1\n0;2.5e-2;1.2\n",
        "\ufeffx,y,z\n0.1,-0.2,1\n0.15,0,1.1\n0,2.5e-2,1.2\n",
        "# by someone\n\n// X Y Z\n0.1 -0.2 1\n# in between\n0.15 0 1.1\n0 2.5e-2 1.2\n",
        "3\n0.1 -0.2 1\n0.15 0 1.1\n0 2.5e-2 1.2\n",
        "0.1 -0.2 1 255 0 0\n0.15 0 1.1 255 0 0\n0 2.5e-2 1.2 0 0 9\n",
        "0.1,-0.2,1,mug\n0.15,0,1.1,mug\n0,2.5e-2,1.2,a mug\n",
        'id,"z","X","y"\n0,1,0.1,-0.2\n1,1.1,0.15,0\n2,1.2,0,2.5e-2\n',
        "0,1;-0,2;1\n0,15;0;1,1\n0;2,5e-2;1,2\n",
        "0,1 -0,2 1\n0,15 0 1,1\n0 2,5e-2 1,2\n",
        "My mug\nmeasured on Monday\nx y z\n0.1 -0.2 1\n0.15 0 1.1\n0 2.5e-2 1.2\n",
        "[m] [m] [m]\n0.1 -0.2 1\n0.15 0 1.1\n0 2.5e-2 1.2\n",
    ],
)
def test_ways_to_write_three_points(tmp_path, text, name):
    scan = read(tmp_path, text, name)
    np.testing.assert_array_equal(scan.points, POINTS)
    assert scan.point_labels is None


def test_label_column(tmp_path):
    scan = read(tmp_path, "label x y z\n3 0 0 1\n-4 0 0 2\n")
    np.testing.assert_array_equal(scan.point_labels, [3, -4])
    np.testing.assert_array_equal(scan.points, [[0, 0, 1], [0, 0, 2]])


def test_missing_points_keep_their_rows(tmp_path):
    np.testing.assert_array_equal(read(tmp_path, "nan nan nan\n1 2 3\n").points, [[np.nan] * 3, [1, 2, 3]])


def test_one_point(tmp_path):
    np.testing.assert_array_equal(read(tmp_path, "1 2 3").points, [[1, 2, 3]])


def test_written_by_numpy(tmp_path):
    points = np.random.default_rng(0).normal(size=(50, 3))
    np.savetxt(tmp_path / "scan.xyz", points, fmt="%.8f")
    np.testing.assert_allclose(read_scan(tmp_path / "scan.xyz").points, points, atol=1e-8)
    np.savetxt(tmp_path / "scan.csv", points, delimiter=",", header="x,y,z")
    np.testing.assert_array_equal(read_scan(tmp_path / "scan.csv").points, points)


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3), min_size=1, max_size=20),
    st.sampled_from([" ", ",", ";", "\t", " , "]),
)
def test_floats_survive_exactly(tmp_path_factory, rows, separator):
    text = "\n".join(separator.join(map(repr, row)) for row in rows)
    scan = read(tmp_path_factory.mktemp("text"), text)
    np.testing.assert_array_equal(scan.points, rows)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "empty"),
        (b"\n\n", "no points"),
        (b"# only a comment\n", "no points"),
        (b"1 2\n3 4\n", "2 columns"),
        (b"1 2 3\n4 5 6\n7 8\n", "cannot be read"),
        (b"1 2 3 4\n4 5 6 7\n7 8 9", "truncated"),
        (b"5\n1 2 3\n4 5 6\n", "promises 5"),
        (b"1 2 3\n4 5\n7 8 9\n", "cannot be read"),
        (b"1 2 3\n4 five 6\n7 8 9\n", "cannot be read"),
        (b"1,2,,3\n4,5,,6\n", "cannot be read"),
        (b"nan nan nan\ninf 0 0\n", "finite"),
        (b"Dear all,\nplease find attached\nthe points\n", "no points"),
        (b"1 2 3\n\0\0\0\n4 5 6", "not text"),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(range(256)), "not text"),
        ("1 2 3\n4 5 6\n".encode("utf-16"), "not text"),
        (np.random.default_rng(0).bytes(10_000), "not text"),
    ],
)
def test_bad_text(tmp_path, text, message):
    with pytest.raises(ScanError, match=rf"scan\.xyz: .*{message}"):
        read(tmp_path, text)


@pytest.mark.parametrize(
    "text",
    [
        "a,b,c\n0.1,-0.2,1\n",
        "x,y,height\n0.1,-0.2,1\n",
        '"Red";"Green";"Blue"\n0.1;-0.2;1\n',
        "nx ny nz\n0.1 -0.2 1\n",
        "# by someone\nlongitude latitude\theight label\n0.1 -0.2 1 4\n",
    ],
)
def test_columns_of_other_names_are_no_points(tmp_path, text):
    with pytest.raises(ScanError, match=r"scan\.csv: has no columns x, y and z, only "):
        read(tmp_path, text, "scan.csv")


@pytest.mark.parametrize("title", ["X [m],Y [m],Z [m]", "x_m,y_m,z_m", "points of a mug", "mug"])
def test_other_lines_above_a_table(tmp_path, title):
    np.testing.assert_array_equal(read(tmp_path, f"{title}\n0.1,-0.2,1\n").points, [[0.1, -0.2, 1]])
