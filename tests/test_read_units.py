"""Units that files do not tell, and clouds of other worlds: complete, of a lidar, far away, rounded."""

import json
import warnings

import numpy as np
import pytest
from typer.testing import CliRunner

from shapeconcepts import Scan, ScanError, ScanWarning, datasets, read_scan, read_scans, segment
from shapeconcepts.cli import app
from shapeconcepts.preparation.unusual import ALL_SIDES, TOO_FEW
from shapeconcepts.simulation.shapes.box import rounded_box
from shapeconcepts.sources.mesh_views import load_views
from shapeconcepts.sources.units import TAKEN_AS_METRES, TAKEN_AS_MILLIMETRES, unit_of_mesh

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
UTM = np.array([447_123.0, 5_411_234.0, 312.0])


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """An empty one, instead of the user's."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def can() -> Scan:
    """30 cm across, in the frame of a sensor 0.8 m away."""
    return datasets.simulate_scan("can", 3)


def write(path, points, kind="double"):
    """A binary PLY file."""
    axes = "".join(f"property {kind} {axis}\n" for axis in "xyz")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{axes}end_header\n"
    path.write_bytes(header.encode() + points.astype("<f8" if kind == "double" else "<f4").tobytes())
    return path


def read_silently(path, **options) -> Scan:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ScanWarning)
        return read_scan(path, **options)


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def said(result) -> str:
    return " ".join(result.stderr.split())


def segments_of(scan):
    segmented = segment(scan)
    return segmented.point_to_voxel.tolist(), segmented.segment_labels.tolist()


@pytest.mark.parametrize("place", ["sensor", "centred"])
@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_that_is_set_is_that_of_the_file(tmp_path, can, unit, place):
    points = can.points - (can.points.mean(axis=0) if place == "centred" else 0.0)
    scan = read_scan(write(tmp_path / "can.ply", points / UNITS[unit]), units=unit)
    np.testing.assert_allclose(scan.points, points, rtol=1e-12)
    assert (scan.viewpoint is None) == (place == "centred")
    assert scan.notices == () and segment(scan).notices == ()
    assert segments_of(scan) == segments_of(Scan(points, scan.viewpoint))


@pytest.mark.parametrize("kind", ["double", "float"])
@pytest.mark.parametrize("place", ["sensor", "centred"])
def test_millimetres_are_told_by_the_numbers(tmp_path, can, place, kind):
    points = can.points - (can.points.mean(axis=0) if place == "centred" else 0.0)
    path = write(tmp_path / "can.ply", 1000.0 * points, kind)
    with pytest.warns(ScanWarning, match=r"can.ply has an extent of \d{3}: taken as millimetres, .*units m"):
        guessed = read_scan(path)
    assert guessed.points.tobytes() == read_scan(path, units="mm").points.tobytes()
    in_metres = read_scan(write(tmp_path / "metres.ply", points))
    np.testing.assert_allclose(guessed.points, in_metres.points, atol=1e-7)
    assert (guessed.viewpoint is None) == (in_metres.viewpoint is None) == (place == "centred")
    assert segments_of(guessed) == segments_of(in_metres)
    assert segment(guessed).notices == guessed.notices


@pytest.mark.parametrize(("unit", "decimals"), [("mm", 3), ("cm", 2)])
@pytest.mark.parametrize("offset", [np.zeros(3), UTM], ids=["near", "UTM"])
def test_whole_numbers_become_those_of_a_file_in_metres(tmp_path, can, unit, decimals, offset):
    whole = np.rint(10**decimals * (can.points + offset))
    np.savetxt(path := tmp_path / "can.xyz", whole, "%d")
    assert (read_scan(path, units=unit).points == whole / 10**decimals).all()


def test_a_unit_that_is_set_wins(tmp_path, can):
    path = write(tmp_path / "can.ply", 1000.0 * can.points)
    scan = read_scan(path, units="m")
    assert scan.points.tolist() == (1000.0 * can.points).tolist() and scan.notices == ()
    assert any("may not be in metres" in notice for notice in segment(scan).notices)


@pytest.mark.parametrize("unit", ["cm", "in"])
@pytest.mark.parametrize("place", ["sensor", "centred"])
def test_a_unit_in_doubt_stays_metres_and_is_said(tmp_path, can, unit, place):
    points = can.points - (can.points.mean(axis=0) if place == "centred" else 0.0)
    path = write(tmp_path / "can.ply", points / UNITS[unit])
    with pytest.warns(ScanWarning, match=r"can.ply has an extent of [\d.]+: taken as metres, .*--units cm"):
        scan = read_scan(path)
    assert scan.points.tolist() == (points / UNITS[unit]).tolist()
    # Said once.
    assert segment(scan).notices == scan.notices


def extended(extent, spacing, offset=(0.0, 0.0, 0.0)):
    """A wavy sheet of this diagonal, its points this far apart."""
    steps = np.arange(0.0, extent / np.sqrt(2.0), spacing)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    return np.column_stack([x, y, 0.01 * extent * np.sin(9.0 * x / extent)]) - extent / 3.0 + np.array(offset)


@pytest.mark.parametrize(
    ("points", "told"),
    [
        (extended(2.5, 0.02), ""),
        (extended(4.5, 0.05), TAKEN_AS_METRES),
        (extended(15.0, 0.5), TAKEN_AS_METRES),
        (extended(50.0, 0.2), TAKEN_AS_METRES),
        (extended(50.0, 1.5), TAKEN_AS_MILLIMETRES),
        (extended(180.0, 1.5), TAKEN_AS_MILLIMETRES),
        (extended(180.0, 0.5), TAKEN_AS_MILLIMETRES),
        (extended(40.0, 0.1), TAKEN_AS_METRES),
        (extended(500.0, 40.0), TAKEN_AS_METRES),
        (extended(20_000.0, 200.0), TAKEN_AS_METRES),
        (extended(180.0, 1.5, UTM), TAKEN_AS_METRES),
        (extended(50.0, 0.5, (0.0, 0.0, 800.0)), TAKEN_AS_MILLIMETRES),
        (extended(180.0, 1.5, (0.0, 0.0, 20_000.0)), TAKEN_AS_METRES),
        (extended(4.0, 0.02, (0.0, 0.0, 6.0)), ""),
        (extended(4.0, 0.1, (0.0, 0.0, 30.0)), TAKEN_AS_METRES),
        (np.array([[1e300, 0.0, 0.0], [-1e300, 0.0, 0.0]]), ""),
        (np.array([[500.0, 0.0, 0.0]]), ""),
    ],
    ids=[
        "furniture", "car", "lorry", "50 cm in cm, or mm", "5 cm in mm", "18 cm in mm", "dense", "building",
        "terrain", "map", "map far away", "camera 0.8 m away", "sensor 20 m away", "room", "car far away",
        "absurd", "one point",
    ],
)  # fmt: skip
def test_the_evidence(tmp_path, points, told):
    notices = read_silently(write(tmp_path / "a.ply", points)).notices
    assert len(notices) == bool(told)
    assert not told or notices[0].endswith(told)


def test_a_viewpoint_in_the_file_is_evidence_and_in_its_unit(tmp_path):
    points = extended(50.0, 0.5)
    np.savez(tmp_path / "near.npz", points=points, viewpoint=[0.0, 0.0, 70.0])
    np.savez(tmp_path / "far.npz", points=points, viewpoint=[0.0, 0.0, 700.0])
    assert read_silently(tmp_path / "near.npz").viewpoint.tolist() == [0.0, 0.0, 70.0]
    assert read_silently(tmp_path / "far.npz").viewpoint.tolist() == [0.0, 0.0, 0.7]


def test_missing_points_and_copies_are_no_evidence(tmp_path, can):
    points = np.vstack([1000.0 * can.points, np.full((9, 3), np.nan), np.zeros((9, 3))])
    scan = read_silently(write(tmp_path / "can.ply", np.repeat(points, 3, axis=0)))
    assert scan.notices[0].endswith(TAKEN_AS_MILLIMETRES)


def obj(path, scale):
    mesh = rounded_box(np.array([0.15, 0.1, 0.05]), 0.01)
    lines = ["v {} {} {}\n".format(*vertex) for vertex in scale * mesh.vertices]
    path.write_text("".join(lines) + "".join("f {} {} {}\n".format(*face) for face in mesh.faces + 1))
    return path


def test_meshes_in_millimetres(tmp_path):
    in_metres = read_scan(obj(tmp_path / "m.obj", 1.0))
    guessed = read_silently(obj(tmp_path / "mm.obj", 1000.0))
    assert in_metres.notices == () and guessed.notices[0].endswith(TAKEN_AS_MILLIMETRES)
    np.testing.assert_allclose(guessed.points, in_metres.points, atol=2e-3)
    with pytest.warns(ScanWarning, match="taken as millimetres"):
        views = load_views(tmp_path / "mm.obj", 3)
    assert [view.notices for view in views] == [guessed.notices] * 3
    with pytest.raises(ScanError, match="which units tells"):
        read_scan(obj(tmp_path / "cm.obj", 100.0))


@pytest.mark.parametrize(
    ("extent", "metres"), [(1.0, 1.0), (5.0, 1.0), (50.0, 1.0), (180.0, 0.001), (2e4, 1.0), (np.nan, 1.0)]
)
def test_units_of_meshes(extent, metres):
    assert unit_of_mesh(np.array([[0.0, 0.0, 0.0], [extent, 0.0, 0.0]]))[0] == metres
    assert unit_of_mesh(np.full((2, 3), np.nan)) == (1.0, ())


def test_of_a_mixed_folder_one_line_says_how_many(tmp_path, can):
    for number, scale in enumerate([1.0, 1000.0, 1000.0, 1.0 / 0.0254]):
        write(tmp_path / f"{number}.ply", scale * can.points)
    result = run("segment", tmp_path, "--json")
    extents = [scan["voxel_size"] for scan in json.loads(result.stdout)["scans"]]
    assert extents[0] == extents[1] == extents[2] != extents[3]
    assert "Note: 2 of 4 scans: 1.ply, 2.ply: has an extent of " in said(result)
    assert "Note: 1 of 4 scans: 3.ply has an extent of " in said(result)
    # The second time from the cache, and not what was read with another unit.
    again = run("segment", tmp_path, "--json")
    assert (again.stdout, again.stderr) == (result.stdout, result.stderr)
    in_metres = run("segment", tmp_path, "--json", "--units", "m")
    assert "millimetres" not in in_metres.stderr and in_metres.stdout != result.stdout
    assert run("segment", tmp_path, "--units", "auto", "--json").stdout == result.stdout
    with pytest.warns(ScanWarning, match="2 of 4 scans: .* taken as millimetres"):
        assert len(read_scans(tmp_path)) == 4


def surface_of_a_box(n, size, rng):
    """Points spread over all six faces."""
    axes = rng.choice(3, n, p=np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
                      / (size[1] * size[2] + size[0] * size[2] + size[0] * size[1]))  # fmt: skip
    points = rng.uniform(-0.5, 0.5, (n, 3))
    points[np.arange(n), axes] = rng.choice([-0.5, 0.5], n)
    return points * size


@pytest.mark.parametrize("n_points", [2_000, 20_000])
@pytest.mark.parametrize("kind", ["sampled mesh", "hole at the bottom", "ball"])
def test_complete_clouds_are_noticed(tmp_path, n_points, kind):
    rng = np.random.default_rng(0)
    if kind == "ball":
        directions = rng.normal(size=(n_points, 3))
        points = 0.05 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    else:
        points = surface_of_a_box(n_points, np.array([0.1, 0.15, 0.2]), rng)
        # Photogrammetry: nobody saw what the object stands on.
        points = points[points[:, 2] > -0.095] if kind == "hole at the bottom" else points
    scan = read_scan(write(tmp_path / "a.ply", points + 0.0005 * rng.normal(size=points.shape)))
    assert [notice.rpartition(": ")[2] for notice in segment(scan).notices] == [ALL_SIDES]


@pytest.mark.parametrize("known", [True, False], ids=["sensor known", "sensor unknown"])
def test_single_views_are_not_called_complete(known):
    for scan in datasets.simulate(n_per_category=3, random_state=7):
        points = scan.points if known else scan.points - scan.points.mean(axis=0)
        assert segment(Scan(points, scan.viewpoint if known else None)).notices == ()


def test_a_crop_of_a_lidar_is_noticed(tmp_path):
    rng = np.random.default_rng(0)
    # The side and the back of a car 12 m away.
    points = surface_of_a_box(120, np.array([4.2, 1.8, 1.5]), rng)
    seen = points[(points[:, 0] == points[:, 0].min()) | (points[:, 1] == points[:, 1].min())]
    scan = read_silently(write(tmp_path / "car.ply", seen[:60] + np.array([12.0, 2.0, -0.8])))
    notices = segment(scan).notices
    assert notices[0].endswith(TAKEN_AS_METRES)
    assert notices[1] == f"has {len(seen[:60])} points: {TOO_FEW}"
    result = run("segment", tmp_path / "car.ply")
    assert result.exit_code == 0 and "too few to tell its surfaces apart" in said(result)


def test_far_coordinates_lose_nothing_in_double_precision(tmp_path, can):
    points = np.rint(1e4 * can.points) / 1e4
    here = segment(Scan(points - points.mean(axis=0)))
    np.savetxt(tmp_path / "far.xyz", points + UTM, fmt="%.4f")
    for path in (write(tmp_path / "far.ply", points + UTM), tmp_path / "far.xyz"):
        there = segment(read_scan(path))
        assert there.notices == ()
        assert there.segment_labels.tolist() == here.segment_labels.tolist()


@pytest.mark.parametrize("far", [UTM, [4e5, 0.0, 0.0], [0.0, -4e5, 1.0]], ids=["UTM", "x", "y"])
def test_far_coordinates_in_single_precision_are_refused(tmp_path, can, far):
    path = write(tmp_path / "far.ply", can.points + far, "float")
    with pytest.raises(ScanError, match=r"rounded to 0\.(031|5) m, .* subtract an offset before"):
        segment(read_scan(path))


def test_far_coordinates_are_judged_by_what_is_left(tmp_path, can):
    rng = np.random.default_rng(0)
    moved = can.points + np.array([150_000.0, 0.0, 0.0])
    [notice] = segment(read_scan(write(tmp_path / "noticed.ply", moved, "float"))).notices
    assert notice.startswith("has coordinates that are rounded to 0.016 m at an extent of 0.3")
    for name, points, kind in (
        ("near", can.points + np.array([2_000.0, 0.0, 0.0]), "float"),
        ("car", surface_of_a_box(2_000, np.array([2.2, 1.2, 1.0]), rng) + np.array([4e5, 0.0, 0.0]), "float"),
        # A wall may be where single precision has a number.
        ("wall", np.column_stack([np.full(900, 4e5), *rng.uniform(0.0, 0.3, (2, 900))]), "double"),
    ):
        assert not any("rounded" in notice for notice in segment(read_silently(
            write(tmp_path / f"{name}.ply", points, kind))).notices)  # fmt: skip


def test_six_digits_are_too_few_far_away(tmp_path, can):
    np.savetxt(tmp_path / "far.xyz", can.points + UTM, fmt="%.6g")
    result = run("segment", tmp_path / "far.xyz")
    assert result.exit_code == 1 and "or with few digits" in said(result)
