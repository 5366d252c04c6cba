"""Files as other programs write them, each of which was once misread, refused or passed over in silence.

Most are two faces of a box, 7,200 points, written by hand the way a program or a data set does.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from shapeconcepts import ScanError, ScanWarning, read_scan, read_scans, segment
from shapeconcepts.cli import app
from shapeconcepts.scan import measured_rows
from shapeconcepts.sources import find_scan_files, iter_scans

GRID = np.stack(np.meshgrid(np.arange(60), np.arange(60)), -1).reshape(-1, 2) * 0.002 - 0.06
BOX = np.vstack([np.c_[GRID, np.full(3600, 0.8)], np.c_[GRID[:, 0], np.full(3600, 0.06), GRID[:, 1] + 0.86]])


def table(rows, separator=" ") -> str:
    return "".join(separator.join(f"{value:.6f}" for value in row) + "\n" for row in rows)


def ply_header(kind="float", encoding="ascii", more="") -> str:
    axes = "".join(f"property {kind} {axis}\n" for axis in "xyz")
    return f"ply\nformat {encoding} 1.0\nelement vertex 7200\n{axes}{more}end_header\n"


def pcd_header(fields, sizes, types, counts, encoding="ascii", viewpoint="") -> str:
    return (
        f"VERSION .7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\nCOUNT {counts}\nWIDTH 7200\nHEIGHT 1\n"
        f"{viewpoint}POINTS 7200\nDATA {encoding}\n"
    )


def write(path: Path, content: str | bytes) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """An empty one, instead of the user's."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def colmap(rows) -> str:
    lines = [
        f"{i + 1} {table([row])[:-1]} 9 9 9 0.5 1 4" + " 2 5 3 6" * (i % 3) for i, row in enumerate(rows)
    ]
    return "\n".join(lines) + "\n"


READ = {
    "colmap.txt": "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n" + colmap(BOX),
    "colmap_as_written.txt": "# 3D point list with one line of data per point:\n"
    "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    "# Number of points: 7200, mean track length: 3.2\n" + colmap(BOX),
    "capitals.pcd": pcd_header("X Y Z", "4 4 4", "F F F", "1 1 1") + table(BOX),
    "rhino.ply": ply_header(encoding="binary_little_endian").replace("\n", "\r").encode()
    + BOX.astype("<f4").tobytes()
    + bytes(4096),
    "rhino_text.ply": (ply_header() + table(BOX)).replace("\n", "\r"),
    "decimal_commas.csv": "x;y;z\n" + table(BOX, ";").replace(".", ","),
    "vertices.obj": "".join("v " + table([row]) for row in BOX),
    "title.txt": "My box\nx y z\n" + table(BOX),
    "latin1.txt": "# gemessen in München\n".encode("latin-1") + table(BOX).encode(),
    "mark.ply": b"\xef\xbb\xbf" + (ply_header() + table(BOX)).encode(),
    "mark.pcd": b"\xef\xbb\xbf" + (pcd_header("x y z", "4 4 4", "F F F", "1 1 1") + table(BOX)).encode(),
    "comment.ply": ply_header().replace("element", "comment the end_header comes later\nelement", 1)
    + table(BOX),
    "box.pts": "7200\n" + table(np.c_[BOX, np.full((7200, 4), 9)]),
    "box.asc": table(BOX),
    "half_a_label.ply": ply_header(more="property float label\n")
    + "".join(table([row])[:-1] + (" nan\n" if i % 2 else " 1\n") for i, row in enumerate(BOX)),
    "words.ply": ply_header(more="property string name\n")
    + "".join(table([row])[:-1] + " mug\n" for row in BOX),
    "words.pcd": pcd_header("x y z label", "4 4 4 4", "F F F F", "1 1 1 1")
    + "".join(table([row])[:-1] + " mug\n" for row in BOX),
    "words.csv": "x,y,z,label\n" + "".join(table([row], ",")[:-1] + ",mug\n" for row in BOX),
}


@pytest.mark.filterwarnings("ignore::shapeconcepts.ScanWarning")
@pytest.mark.parametrize("name", READ)
def test_read(tmp_path, name):
    scan = read_scan(write(tmp_path / name, READ[name]))
    np.testing.assert_allclose(scan.points, BOX, atol=1e-6)
    assert scan.point_labels is None


@pytest.mark.parametrize("name", ["half_a_label.ply", "words.pcd", "words.csv"])
def test_a_label_that_cannot_be_read_is_named(tmp_path, name):
    with pytest.warns(ScanWarning, match=rf"{name} has labels that cannot be read"):
        scan = read_scan(write(tmp_path / name, READ[name]))
    assert len(scan.notices) == 1


def test_padding_of_ouster(tmp_path):
    rows = np.zeros(7200, "<f4,<f4,<f4,<u4")
    rows["f0"], rows["f1"], rows["f2"] = BOX.T
    header = pcd_header("x y z _ i _", "4 4 4 1 4 1", "F F F U F U", "1 1 1 0 1 0", "binary")
    scan = read_scan(write(tmp_path / "ouster.pcd", header.encode() + rows.tobytes()))
    np.testing.assert_array_equal(scan.points, BOX.astype("f4"))


def test_capitals_in_numpy_files(tmp_path):
    array = np.zeros(7200, [(axis, "f4") for axis in "XYZ"])
    array["X"], array["Y"], array["Z"] = BOX.T
    np.save(tmp_path / "capitals.npy", array)
    np.savez(tmp_path / "xyz.npz", xyz=BOX, colors=np.zeros((7200, 3)))
    np.testing.assert_array_equal(read_scan(tmp_path / "capitals.npy").points, BOX.astype("f4"))
    np.testing.assert_array_equal(read_scan(tmp_path / "xyz.npz").points, BOX)


@pytest.mark.parametrize("word", ["-nan(ind)", "1.#QNAN", "-1.#IND", "NaN", "nan(0x8000)"])
@pytest.mark.parametrize("name", ["a.txt", "a.csv", "a.ply", "a.pcd"])
def test_what_is_no_number_is_a_missing_point(tmp_path, name, word):
    separator = "," if name.endswith("csv") else " "
    lines = table(BOX, separator).splitlines(keepends=True)
    lines[7] = separator.join([word] * 3) + "\n"
    header = {"a.ply": ply_header(), "a.pcd": pcd_header("x y z", "4 4 4", "F F F", "1 1 1")}.get(name, "")
    points = read_scan(write(tmp_path / name, header + "".join(lines))).points
    assert np.isnan(points[7]).all()
    np.testing.assert_allclose(np.delete(points, 7, axis=0), np.delete(BOX, 7, axis=0), atol=1e-6)


@pytest.mark.parametrize("name", ["a.ply", "a.pcd"])
def test_all_digits_of_a_text_count(tmp_path, name):
    points = np.random.default_rng(0).uniform(500_000, 500_001, (7200, 3))
    header = {"a.ply": ply_header(), "a.pcd": pcd_header("x y z", "4 4 4", "F F F", "1 1 1")}[name]
    text = header + "".join(" ".join(map(repr, row)) + "\n" for row in points.tolist())
    np.testing.assert_array_equal(read_scan(write(tmp_path / name, text)).points, points)


POSITION = np.array([0.5, -0.25, 0.1])
VIEWPOINT_FIELDS = table(np.c_[BOX, np.tile(POSITION, (7200, 1))])
WITH_POSITION = {
    "camera.ply": ply_header(
        more="element camera 1\n" + "".join(f"property float view_p{axis}\n" for axis in "xyz")
    )
    + table(BOX)
    + "0.5 -0.25 0.1\n",
    "comment.ply": ply_header().replace("element", "comment viewpoint 0.5 -0.25 0.1\nelement", 1)
    + table(BOX),
    "comment.xyz": "# sensor position: 0.5, -0.25, 0.1\n" + table(BOX),
    "fields.ply": ply_header(more="".join(f"property float vp_{axis}\n" for axis in "xyz"))
    + VIEWPOINT_FIELDS,
    "fields.pcd": pcd_header("x y z vp_x vp_y vp_z", "4 4 4 4 4 4", "F F F F F F", "1 1 1 1 1 1")
    + VIEWPOINT_FIELDS,
}


@pytest.mark.parametrize("name", WITH_POSITION)
def test_where_the_sensor_stood(tmp_path, name):
    scan = read_scan(write(tmp_path / name, WITH_POSITION[name]))
    np.testing.assert_allclose(scan.viewpoint, POSITION, atol=1e-7)
    np.testing.assert_allclose(scan.points, BOX, atol=1e-6)
    in_feet = read_scan(tmp_path / name, units="ft")
    np.testing.assert_allclose(in_feet.viewpoint, 0.3048 * POSITION, atol=1e-7)


REFUSED = {
    "pointer.ply": ("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "git lfs pull"),
    "counted.txt": (colmap(BOX), "its first column counts 1, 2, 3"),
    "cloud.las": (b"LASF" + bytes(300), r"format \.las is not read: save it as \.ply"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_a_true_reason(tmp_path, name):
    content, reason = REFUSED[name]
    with pytest.raises(ScanError, match=reason):
        read_scan(write(tmp_path / name, content))


@pytest.mark.parametrize("shape", [(480, 640), (480, 640, 1), (3, 48, 64), (100, 33), (3, 50)])
def test_arrays_that_are_no_points(tmp_path, shape):
    array = np.zeros(shape, "f4")
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(ScanError, match=r"\(n, 3\) is expected"):
        read_scan(tmp_path / "a.npy")


@pytest.fixture
def depth() -> np.ndarray:
    image = np.zeros((480, 640), "f4")
    image[200:280, 280:360] = 0.8
    return image


@pytest.mark.parametrize("form", ["array", "millimetres", "one channel", "tiff", "tiff of 16 bits", "png"])
def test_depth_in_other_files(tmp_path, depth, form):
    millimetres = (1000 * depth).round().astype("u2")
    intrinsics = (525.0, 525.0, 319.5, 239.5)
    path = tmp_path / {"tiff": "a.tif", "tiff of 16 bits": "a.tiff", "png": "a.png"}.get(form, "a.npy")
    if path.suffix == ".npy":
        arrays = {"array": depth, "millimetres": millimetres, "one channel": depth[..., None]}
        np.save(path, arrays[form])
    else:
        Image.fromarray(depth if form == "tiff" else millimetres).save(path)
    scan = read_scan(path, intrinsics=intrinsics)
    rows, columns = np.nonzero(depth)
    expected = np.c_[(columns - 319.5) / 525 * 0.8, (rows - 239.5) / 525 * 0.8, np.full(len(rows), 0.8)]
    np.testing.assert_allclose(scan.points, expected, atol=1e-6)
    np.testing.assert_array_equal(scan.viewpoint, 0)
    mask = np.zeros((480, 640), bool)
    mask[:240] = True
    assert len(read_scan(path, intrinsics=intrinsics, mask=mask)) == 40 * 80


def test_the_largest_depth_of_16_bits_is_a_missing_one(tmp_path, depth):
    saturated = np.where(depth > 0, 800, 65535).astype("u2")
    Image.fromarray(saturated).save(tmp_path / "a.png")
    scan = read_scan(tmp_path / "a.png")
    assert len(scan) == 80 * 80 and (scan.points[:, 2] == 0.8).all()


def test_absurd_depths_are_noticed(tmp_path, depth):
    Image.fromarray((depth * 60_000).astype("u2")).save(tmp_path / "a.png")
    with pytest.warns(ScanWarning, match=r"has a median depth of 48 m: the depth scale \(--depth-scale\)"):
        read_scan(tmp_path / "a.png")


def test_labels_that_are_no_scene(tmp_path):
    more = "property int label\n"
    for number in range(3):
        rows = np.c_[BOX, np.where(np.arange(7200) < 3600, 3, 24)]
        text = ply_header(more=more) + "".join(f"{x} {y} {z} {int(label)}\n" for x, y, z, label in rows)
        write(tmp_path / "one" / f"{number}.ply", text)
        write(tmp_path / "scenes" / f"{number}.ply", text.replace(" 3\n", " 20\n").replace(" 24\n", " 1\n"))
    result = run("segment", tmp_path / "one", "--json")
    assert [scan["n_points"] for scan in json.loads(result.stdout)["scans"]] == [7200] * 3
    assert "no-scenes" not in result.stderr
    result = run("segment", tmp_path / "scenes", "--json")
    found = json.loads(result.stdout)["scans"]
    assert [(scan["name"], scan["n_points"]) for scan in found] == [(f"{i}/2", 3600) for i in range(3)]
    assert (
        "3 of 3 scans: 0/2, 1/2, 2/2: is an object of a scene that point labels tell apart" in result.stderr
    )
    result = run("segment", tmp_path / "scenes", "--json", "--no-scenes")
    assert [scan["n_points"] for scan in json.loads(result.stdout)["scans"]] == [7200] * 3


def test_objects_of_scenes_have_the_label_of_their_folder(tmp_path):
    rows = np.c_[BOX, np.where(np.arange(7200) < 3600, 1, 20)]
    text = ply_header(more="property int label\n") + "".join(
        f"{x} {y} {z} {int(label)}\n" for x, y, z, label in rows
    )
    for name in ("mug/learn0.ply", "test/learn33.ply", "kitchen.ply"):
        write(tmp_path / "scans" / name, text)
    for _ in range(2):  # the second time from the cache
        result = run("learn", tmp_path / "scans", "--model", tmp_path / "m", "--json", "--min-size", 2)
        assert result.exit_code == 0, result.stderr
        [concept] = json.loads(result.stdout)["concepts"]
        assert concept["labels"] == {"mug": 1, "can": 1} and concept["n_unlabelled"] == 1
    table_shown = run("info", tmp_path / "m").stdout
    assert "unlabelled 33%" in table_shown


def test_a_closed_surface_is_no_single_view(tmp_path):
    rng = np.random.default_rng(1)
    faces = rng.integers(0, 6, 40000)
    points = rng.uniform(-0.5, 0.5, (40000, 3))
    points[np.arange(40000), faces // 2] = np.where(faces % 2, 0.5, -0.5)
    np.save(tmp_path / "closed.npy", points * [0.1, 0.15, 0.2])
    write(tmp_path / "open.xyz", table(BOX))
    result = run("segment", tmp_path)
    assert "1 of 2 scans: closed.npy is seen from all sides: expected is what a sensor sees" in result.stderr
    assert segment(points * [0.1, 0.15, 0.2]).notices and not segment(BOX).notices


def test_other_units(tmp_path):
    write(tmp_path / "millimetres.xyz", table(1000 * BOX))
    write(tmp_path / "metres.xyz", table(BOX))
    result = run("segment", tmp_path)
    assert "1 of 2 scans: millimetres.xyz has an extent of 199: taken as millimetres" in " ".join(
        result.stderr.split()
    )
    result = run("segment", tmp_path, "--units", "m")
    assert "1 of 2 scans: millimetres.xyz is 202 m across: its coordinates may not be in metres" in " ".join(
        result.stderr.split()
    )
    right = read_scan(tmp_path / "millimetres.xyz", units="mm")
    np.testing.assert_allclose(right.points, BOX, atol=1e-6)
    assert not segment(right).notices
    assert run("segment", tmp_path / "millimetres.xyz", "--units", "mm").stderr == ""
    assert run("segment", tmp_path / "millimetres.xyz", "--units", "furlongs").exit_code == 2
    with pytest.raises(ValueError, match="units must be one of auto, m, cm, mm, in, ft or metres per unit"):
        read_scan(tmp_path / "metres.xyz", units=0)


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_a_mesh_stands_upright_and_in_metres(tmp_path, up):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * [
        100,
        80,
        600,
    ]  # a tall box in millimetres
    faces = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    place, sign = "xyz".index(up[-1]), -1 if up.startswith("-") else 1
    turned = np.roll(corners, place - 2, axis=1)
    turned[:, place] *= sign
    lines = [f"v {x} {y} {z}\n" for x, y, z in turned]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) + "\n" for face in faces]
    path = write(tmp_path / "box.obj", "".join(lines))
    with pytest.raises(ScanError, match="which units tells"):
        read_scan(path, units="m")
    scan = read_scan(path, units="mm", up=up)
    # The image of the sensor stands upright: y is down.
    extent = np.ptp(scan.points, axis=0)
    assert extent[1] > 0.4 and extent[0] < 0.2


def test_copies_of_a_point_count_nowhere():
    rng = np.random.default_rng(0)
    places = rng.uniform(-0.05, 0.05, (94, 2))
    points = np.c_[places, 0.3 + 0.02 * np.sin(40 * places[:, 0])]
    plain = segment(points)
    for copies in (np.repeat(points[:1], 1954, 0), points[rng.integers(0, 94, 1000)]):
        padded = segment(np.vstack([points, copies]))
        assert padded.voxel_size == plain.voxel_size and padded.n_segments == plain.n_segments
        np.testing.assert_array_equal(padded.points, plain.points)
        np.testing.assert_array_equal(padded.segment_labels, plain.segment_labels)
        np.testing.assert_array_equal(padded.point_to_voxel[:94], plain.point_to_voxel)
        assert (padded.point_to_voxel[94:] == -1).all()


def test_missing_points_count_nowhere_however_they_are_written():
    plain = segment(BOX)
    for missing in (np.nan, np.inf, 0.0, -0.0):
        other = segment(np.vstack([BOX, np.full((5000, 3), missing)]))
        np.testing.assert_array_equal(other.points, plain.points)
        np.testing.assert_array_equal(other.segment_labels, plain.segment_labels)
        assert (other.point_to_voxel[7200:] == -1).all()


def test_a_single_point_at_the_origin_is_missing_but_among_others():
    cloud = BOX - BOX[100]
    assert measured_rows(cloud).all()
    assert measured_rows(np.vstack([BOX, [[0, 0, 0]]])).tolist() == [True] * 7200 + [False]
    assert measured_rows(np.vstack([cloud, [[0, 0, 0]]])).sum() == 7199
    assert measured_rows(np.zeros((3, 3))).all() and not measured_rows(np.full((2, 3), np.nan)).any()


TABLES = {
    "calibration.txt": ("525 0 319.5\n0 525 239.5\n0 0 1\n", "is a table of 3 x 3 numbers"),
    "distortion.csv": ("0.1,-0.2,0.001,0.002,0\n", "is a table of 1 x 5 numbers"),
    "poses.txt": ("1 0 0 0.5 0 1 0 0.25 0 0 1 0.125\n" * 30, "is a list of poses"),
    "matrices.txt": ("0 -1 0 0.5 1 0 0 0 0 0 1 0.1 0 0 0 1\n" * 30, "is a list of poses"),
    "trajectory.txt": (
        "# timestamp tx ty tz qx qy qz qw\n" + "".join(f"{i}.5 1 2 3 0 0.6 0 0.8\n" for i in range(30)),
        "is a trajectory",
    ),
    "odometry.csv": ("".join(f"{i},2,3,0,0.6,0,0.8\n" for i in range(0, 60, 2)), "is a list of poses"),
}


def test_tables_beside_scans_are_no_scans(tmp_path):
    write(tmp_path / "box.txt", table(BOX))
    normals = np.tile([0.6, 0.0, 0.8], (7200, 1))
    write(tmp_path / "box_with_normals.txt", table(np.c_[BOX, normals, np.zeros(7200)]))
    for name, (content, _) in TABLES.items():
        write(tmp_path / name, content)
    np.save(tmp_path / "intrinsics.npy", np.eye(3))
    for name in ("scene.las", "scan.e57", "recording.bag"):
        write(tmp_path / name, b"anything")
    scans = {
        file.name: result
        for file, result in zip(find_scan_files(tmp_path), iter_scans(find_scan_files(tmp_path)), strict=True)
    }
    assert {name for name, one in scans.items() if not isinstance(one, ScanError)} == {
        "box.txt",
        "box_with_normals.txt",
    }
    for name, (_, reason) in TABLES.items():
        assert reason in str(scans[name])
    assert "is a table of 3 x 3 numbers" in str(scans["intrinsics.npy"])
    assert "the format .las is not read" in str(scans["scene.las"])
    result = run("segment", tmp_path)
    assert "Skipped 10 of 12 scans" in result.stderr
    # Whoever names a file means it.
    assert len(read_scan(tmp_path / "calibration.txt")) == 3


def test_a_folder_of_other_formats_alone(tmp_path):
    write(tmp_path / "a.laz", b"LASF")
    with pytest.raises(ScanError, match=r"a\.laz: the format \.laz is not read"):
        read_scans(tmp_path)


def test_a_missing_mask_is_named_once(tmp_path, depth):
    Image.fromarray((1000 * depth).astype("u2")).save(tmp_path / "a.png")
    result = run("segment", tmp_path / "a.png", "--mask", tmp_path / "nowhere.png")
    assert result.exit_code == 2
    (tmp_path / "masks").mkdir()
    result = run("learn", tmp_path / "a.png", "--model", tmp_path / "m", "--mask", tmp_path / "masks")
    message = "".join(result.stderr.split())
    assert "thereisnosuchfile" in message and "Errno" not in message
    assert message.count("masks/a.png") == 1


def test_scenes_of_others_keep_their_sensor_and_all_points(tmp_path):
    rng = np.random.default_rng(0)
    points = np.vstack([BOX - [0, 0, 0.8], BOX - [0.3, 0, 0.8]])
    labels = np.repeat([20, 30], 7200)
    table = np.c_[rng.uniform(-0.5, 0.5, (5000, 2)), np.full(5000, 0.1)]
    viewpoint = np.array([0.0, -3.0, 2.0])
    np.savez(
        tmp_path / "scene.npz",
        points=np.vstack([points, table]),
        labels=np.append(labels, np.ones(5000, int)),
        viewpoint=viewpoint,
    )
    found = json.loads(run("segment", tmp_path / "scene.npz", "--json").stdout)["scans"]
    # A point at the very origin would be a missing one.
    assert [scan["n_points"] for scan in found] == [7200, 7200]
    assert all(scan["viewpoint"] == viewpoint.tolist() for scan in found)


def test_masks_of_any_image_format_in_the_same_place(tmp_path, depth):
    (tmp_path / "depth" / "mug").mkdir(parents=True)
    (tmp_path / "masks" / "mug").mkdir(parents=True)
    mask = np.zeros((480, 640), np.uint8)
    mask[:240] = 255
    np.save(tmp_path / "depth/mug/0.npy", depth)
    Image.fromarray(depth).save(tmp_path / "depth/mug/1.tif")
    np.save(tmp_path / "depth/mug/cloud.npy", BOX)
    for name in ("0.png", "1.bmp"):
        Image.fromarray(mask).save(tmp_path / "masks/mug" / name)
    options = {"intrinsics": (525.0, 525.0, 319.5, 239.5), "mask": tmp_path / "masks"}
    scans = read_scans(tmp_path / "depth", strict=True, **options)
    assert [len(scan) for scan in scans] == [3200, 3200, 7200]
    # A file that is named is found by the folders in its path.
    assert len(read_scans(tmp_path / "depth/mug/0.npy", strict=True, **options)[0]) == 3200


def test_labels_of_text_are_one_notice(tmp_path):
    for number in range(12):
        rows = "".join(table([row], ",")[:-1] + f",apple{number}\n" for row in BOX[:50])
        write(tmp_path / f"{number}.csv", "x,y,z,label\n" + rows)
    with pytest.warns(ScanWarning) as said:
        read_scans(tmp_path)
    [message] = {str(one.message) for one in said}
    assert message.startswith("12 of 12 scans: 0.csv has labels that cannot be read")


@pytest.mark.parametrize(
    "text",
    [
        "0 0 1\n0,5 0,25 2\n" * 6,
        "0;0;1\n0,5;0,25;2\n" * 6,
        "x,y,z,label\n" + "0,0,1,3,\n0.5,0.25,2,3,\n" * 6,
        '"x","y","z"\n' + '"0","0","1"\n"0.5","0.25","2"\n' * 6,
        "0 ,0 ,1\n0.5 ,0.25 ,2\n" * 6,
    ],
)
def test_ways_of_spreadsheets(tmp_path, text):
    scan = read_scan(write(tmp_path / "a.csv", text))
    np.testing.assert_array_equal(scan.points, [[0, 0, 1], [0.5, 0.25, 2]] * 6)
    assert (scan.point_labels is None) == ("label" not in text)


@pytest.mark.parametrize("name", ["viewpoint", "sensor_origin", "camera_position"])
def test_positions_in_archives(tmp_path, name):
    np.savez(tmp_path / "a.npz", xyz=BOX, **{name: POSITION})
    np.testing.assert_array_equal(read_scan(tmp_path / "a.npz").viewpoint, POSITION)


def test_positions_in_tables_and_what_is_none(tmp_path):
    text = "x,y,z,vp_x,vp_y,vp_z\n" + table(np.c_[BOX, np.tile(POSITION, (7200, 1))], ",")
    scan = read_scan(write(tmp_path / "a.csv", text))
    np.testing.assert_allclose(scan.viewpoint, POSITION)
    scan = read_scan(write(tmp_path / "b.csv", text.replace(",0.500000,", ",left,")))
    assert len(scan) == 7200
    commas = "# viewpoint 0,1 0,2 3,5\n" + table(BOX, ";").replace(".", ",")
    np.testing.assert_array_equal(read_scan(write(tmp_path / "c.csv", commas)).viewpoint, 0)


def test_a_small_folder_of_texts(tmp_path):
    write(tmp_path / "ten.xyz", table(BOX[:10])[:-1])
    write(tmp_path / "nine.csv", "x,y,z\n" + table(BOX[:9], ","))
    header = "time,x,y,z,qx,qy,qz,qw\n"
    write(tmp_path / "path.csv", header + "".join(f"{i},1,2,{i},0,0.6,0,0.8\n" for i in range(50)))
    scans = read_scans(tmp_path)
    assert [scan.name for scan in scans] == ["ten.xyz"]
    reasons = " ".join(map(str, scans.skipped))
    assert "nine.csv: is a table of 9 x 3 numbers" in reasons and "path.csv: is a trajectory" in reasons
