"""The command line as a user types it."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TextIO

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.report.palette import SEGMENT_COLOURS
from shapeconcepts.scan import Scan

COMMAND = Path(sys.executable).with_name("shapeconcepts")


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def run_installed(
    *arguments: object,
    folder: Path,
    stdout: int | TextIO = subprocess.PIPE,
    stderr: int | TextIO = subprocess.PIPE,
) -> subprocess.CompletedProcess[str]:
    """The installed command in a process of its own, as in a script: no terminal, no input."""
    return subprocess.run(
        [COMMAND, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "COLUMNS": "100"},
        stdin=subprocess.DEVNULL,
        stdout=stdout,
        stderr=stderr,
        text=True,
        timeout=300,
    )


def box_corner(seed: int = 0) -> Scan:
    """Three faces of a 12 cm box that meet in the middle of the view, half a metre from the sensor."""
    rng = np.random.default_rng(seed)
    faces = []
    for axis in range(3):
        face = rng.uniform(0, 0.12, (4000, 3))
        face[:, axis] = 0
        faces.append(face)
    corner = np.vstack(faces)
    towards = -np.ones(3) / np.sqrt(3)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    axes = np.stack([right, -np.cross(towards, right), -towards])
    points = corner @ axes.T + [0, 0, 0.5]
    points *= rng.normal(1, 0.001, (len(points), 1))
    return Scan(points, viewpoint=np.zeros(3), point_labels=np.repeat([0, 1, 2], 4000))


@pytest.fixture(scope="session")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two box corners and a file that is no scan, in category folders."""
    folder = tmp_path_factory.mktemp("scans")
    for index in range(2):
        path = folder / "box" / f"box_{index}.pcd"
        path.parent.mkdir(exist_ok=True)
        write_pcd(path, box_corner(index))
    (folder / "junk").mkdir()
    (folder / "junk" / "letter.pcd").write_text("Dear reader, this is no point cloud.\n")
    return folder


def test_a_newcomer_s_first_commands(tmp_path: Path) -> None:
    simulated = run_installed("simulate", "scans", "--n-per-category", 1, folder=tmp_path)
    assert simulated.returncode == 0, simulated.stderr
    assert simulated.stdout == ""
    assert simulated.stderr == "Wrote 7 scans of 7 categories to scans\n"
    assert len(list(tmp_path.glob("scans/*/*.pcd"))) == 7

    segmented = run_installed("segment", "scans", "--image", "sheet.png", folder=tmp_path)
    assert segmented.returncode == 0, segmented.stderr
    assert "Wrote sheet.png" in segmented.stderr
    assert segmented.stdout.split()[:6] == ["scan", "points", "voxels", "segments", "sizes", "neighbours"]
    for name in ("amphora", "ball", "box", "can", "plate", "sack", "teddy"):
        assert f"{name}/{name}_000.pcd" in segmented.stdout
    with Image.open(tmp_path / "sheet.png") as sheet:
        pixels = np.asarray(sheet.convert("RGB"))
    coloured = (pixels.max(axis=2).astype(int) - pixels.min(axis=2) > 60).mean()
    assert 0.1 < coloured < 0.9


def test_help_shows_examples_defaults_and_units() -> None:
    overview = run("--help").output
    assert "segment" in overview
    assert "simulate" in overview
    manual = " ".join(run("segment", "--help").output.split())
    for wanted in ("METRES", "auto", "0.02", "shapeconcepts segment mug.pcd --image mug.png"):
        assert wanted in manual
    assert "shapeconcepts simulate scans" in run("simulate", "--help").output


def test_version() -> None:
    assert run("--version").output == f"shapeconcepts {shapeconcepts.__version__}\n"


def test_segment_prints_one_json_document(scans: Path) -> None:
    result = run("segment", scans, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert [scan["name"] for scan in document["scans"]] == ["box/box_0.pcd", "box/box_1.pcd"]
    [skipped] = document["skipped"]
    assert skipped["name"] == "junk/letter.pcd"
    assert "letter.pcd" in skipped["reason"]
    assert "Skipped 1 of 3 scans" in result.stderr
    assert "Traceback" not in result.stderr

    for scan in document["scans"]:
        assert scan["label"] == "box"
        assert scan["viewpoint"] == [0, 0, 0]
        assert scan["n_points"] == 12000
        assert scan["voxel_size"] == 0.005
        assert scan["n_segments"] == len(scan["segments"]) == 3
        assert scan["edges"] == [[0, 1], [0, 2], [1, 2]]
        for index, segment in enumerate(scan["segments"]):
            assert segment["index"] == index
            assert segment["neighbours"] == sorted({0, 1, 2} - {index})
            assert segment["share"] == pytest.approx(segment["n_voxels"] / scan["n_voxels"], abs=1e-6)
            assert segment["share"] == pytest.approx(1 / 3, abs=0.05)
            assert np.linalg.norm(segment["mean_normal"]) == pytest.approx(1, abs=1e-5)
            assert np.dot(segment["mean_normal"], segment["centroid"]) < 0  # faces the sensor at the origin
            np.testing.assert_allclose(segment["centroid"], (0, 0, 0.57), atol=0.06)
        normals = np.array([segment["mean_normal"] for segment in scan["segments"]])
        np.testing.assert_allclose(normals @ normals.T, np.eye(3), atol=0.1)


def test_segment_draws_each_segment_in_its_colour_at_its_place(scans: Path, tmp_path: Path) -> None:
    image = tmp_path / "corner.png"
    result = run("segment", scans / "box" / "box_0.pcd", "--json", "--image", image)
    assert result.exit_code == 0, result.output
    with Image.open(image) as picture:
        pixels = np.asarray(picture.convert("RGB"), dtype=float)
    width = pixels.shape[1]
    points = box_corner().points[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    directions = SEGMENT_COLOURS / np.linalg.norm(SEGMENT_COLOURS, axis=1, keepdims=True)
    [scan] = json.loads(result.stdout)["scans"]
    for segment in scan["segments"]:
        place = (np.array(segment["centroid"][:2]) - (low + high) / 2) / (high - low).max()
        column, row = (width * (0.5 + 0.88 * place)).astype(int)
        assert np.argmax(directions @ pixels[row, column]) == segment["index"]
    assert pixels[5, 5].tolist() == [255, 255, 255]


def test_results_do_not_depend_on_n_jobs(scans: Path, tmp_path: Path) -> None:
    outputs = []
    for n_jobs in (1, 2):
        image = tmp_path / f"{n_jobs}.png"
        result = run("segment", scans / "box", "--json", "--jobs", n_jobs, "--image", image)
        assert result.exit_code == 0, result.stderr
        outputs.append((result.stdout, image.read_bytes()))
    assert outputs[0] == outputs[1]


def test_parameters_reach_the_segmentation(scans: Path) -> None:
    path = scans / "box" / "box_0.pcd"
    result = run("segment", path, "--json", "--voxel-size", 0.01, "--seed-size", 0.03, "--max-segments", 2)
    [scan] = json.loads(result.stdout)["scans"]
    assert scan["voxel_size"] == 0.01
    assert scan["n_voxels"] < 1000
    assert scan["n_segments"] == 2


def test_a_bad_scan_is_skipped_and_reported(scans: Path) -> None:
    result = run("segment", scans)
    assert result.exit_code == 0
    assert "box/box_1.pcd" in result.stdout
    assert "letter.pcd" not in result.stdout
    assert "Skipped 1 of 3 scans" in result.stderr
    assert "letter.pcd: " in result.stderr


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_strict_stops_at_the_first_bad_scan(scans: Path, n_jobs: int) -> None:
    result = run("segment", scans / "junk" / "letter.pcd", scans, "--strict", "--n-jobs", n_jobs)
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr.startswith("Error: ")
    assert "letter.pcd" in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_no_usable_scan_is_a_failure(scans: Path, tmp_path: Path) -> None:
    image = tmp_path / "none.png"
    result = run("segment", scans / "junk", tmp_path / "absent.pcd", "--image", image)
    assert result.exit_code == 1
    assert "Skipped 2 of 2 scans" in result.stderr
    assert "absent.pcd: there is no such file" in result.stderr
    assert not image.exists()
    document = json.loads(run("segment", scans / "junk", "--json").stdout)
    assert document["scans"] == []
    assert len(document["skipped"]) == 1


def test_an_empty_folder_is_named(tmp_path: Path) -> None:
    result = run("segment", tmp_path)
    assert result.exit_code == 1
    assert str(tmp_path) in result.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["segment"], "Missing argument"),
        (["segment", "a.pcd", "--voxel-size", "0"], "--voxel-size"),
        (["segment", "a.pcd", "--voxel-size", "nan"], "--voxel-size"),
        (["segment", "a.pcd", "--voxel-size", "inf"], "--voxel-size"),
        (["segment", "a.pcd", "--seed-size", "-0.02"], "--seed-size"),
        (["segment", "a.pcd", "--seed-size", "nan"], "--seed-size"),
        (["segment", "a.pcd", "--max-segments", "0"], "--max-segments"),
        (["segment", "a.pcd", "--n-jobs", "0"], "--jobs"),
        (["segment", "a.pcd", "--image", "picture.doc"], "picture format"),
        (["segment", "a.pcd", "--image", "no_such_folder/a.png"], "no_such_folder"),
        (["segment", "a.pcd", "--colour"], "--colour"),
        (["segment", "a.png", "--intrinsics", "525,525,320"], "--intrinsics"),
        (["segment", "a.png", "--intrinsics", "525,525,320,240,1"], "got '525,525,320,240,1'"),
        (["segment", "a.png", "--intrinsics", "0,525,320,240"], "FX,FY,CX,CY"),
        (["segment", "a.png", "--intrinsics", "525,525,nan,240"], "--intrinsics"),
        (["segment", "a.png", "--intrinsics", "wide"], "got 'wide'"),
        (["segment", "a.png", "--depth-scale", "0"], "--depth-scale"),
        (["segment", "a.png", "--depth-scale", "nan"], "got nan"),
        (["segment", "a.png", "--mask", "no_such_mask.png"], "no_such_mask.png"),
        (["segment", "a.pcd", "--mask", "."], "is for depth images"),
        (["simulate", "scans", "--n-per-category", "0"], "--n-per-category"),
        (["simulate", "scans", "--categories", "box,car"], "'car'"),
        (["simulate", "scans", "--random-state", "-1"], "--random-state"),
        (["simulate", "scans", "--random-state", "a"], "--random-state"),
        (["simulate", "scans", "--n-per-category", "1.5"], "--n-per-category"),
        (["simulate", "scans", "--categories", "box,"], "unknown category ''"),
        (["learn"], "--model"),
        (["unlearn"], "unlearn"),
    ],
)
def test_usage_errors(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_simulate_writes_what_it_says(tmp_path: Path) -> None:
    folder = tmp_path / "scans"
    result = run("simulate", folder, "--n-per-category", 2, "--categories", "box,can", "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    written = sorted(path for path in folder.rglob("*") if path.is_file())
    assert sorted(Path(file["path"]) for file in document["files"]) == written
    assert [path.relative_to(folder).as_posix() for path in written] == [
        "box/box_000.pcd",
        "box/box_001.pcd",
        "can/can_000.pcd",
        "can/can_001.pcd",
    ]
    scans = shapeconcepts.read_scans(folder)
    assert [scan.label for scan in scans] == ["box", "box", "can", "can"]
    truth = shapeconcepts.datasets.simulate(2, categories=["box", "can"], random_state=0)
    for scan, true, file in zip(scans, truth, document["files"], strict=True):
        np.testing.assert_allclose(scan.points, true.points, atol=1e-6)
        np.testing.assert_array_equal(scan.point_labels, true.point_labels)
        assert file["n_points"] == len(scan)


def test_simulate_overwrites_only_with_force(tmp_path: Path) -> None:
    def simulate(*options: object):
        return run("simulate", tmp_path, "--n-per-category", 1, "--categories", "ball", *options)

    path = tmp_path / "ball" / "ball_000.pcd"
    simulate()
    first = path.read_bytes()
    refused = simulate("--random-state", 1)
    assert refused.exit_code == 1
    assert "ball_000.pcd exists already" in refused.stderr
    assert "--force" in refused.stderr
    assert path.read_bytes() == first
    assert simulate("--random-state", 1, "--force").exit_code == 0
    assert path.read_bytes() != first
    simulate("--force")
    assert path.read_bytes() == first, "the same seed gives the same file"


def test_simulate_into_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ball").write_text("in the way")
    result = run("simulate", tmp_path, "--n-per-category", 1, "--categories", "ball")
    assert result.exit_code == 1
    assert result.stderr.startswith("Error: cannot write to")


def test_an_interrupted_simulation_leaves_whole_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from shapeconcepts import datasets

    simulate_scan = datasets.simulate_scan

    def interrupted(category: str, index: int, **options: int) -> Scan:
        if index == 1:
            raise KeyboardInterrupt
        return simulate_scan(category, index, **options)

    monkeypatch.setattr(datasets, "simulate_scan", interrupted)
    result = run("simulate", tmp_path, "--n-per-category", 3, "--categories", "ball")
    assert result.exit_code != 0
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["ball_000.pcd"]
    assert len(shapeconcepts.read_scan(tmp_path / "ball" / "ball_000.pcd")) > 0


def write_depth(path: Path, shape: tuple[int, int] = (480, 640)) -> Path:
    """A flat wall 0.9 m away, 1.8 m for a camera whose unit is 2 mm."""
    depth = np.zeros(shape, dtype=np.uint16)
    depth[10:110, 20:130] = 900
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(depth).save(path)
    return path


def write_mask(path: Path, n_columns: int) -> Path:
    """The left columns of the wall."""
    mask = np.zeros((480, 640), dtype=np.uint8)
    mask[:, : 20 + n_columns] = 255
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(mask).save(path)
    return path


def test_intrinsics_and_depth_scale_of_a_depth_image(tmp_path: Path) -> None:
    path = write_depth(tmp_path / "depth.png", (120, 160))
    refused = run("segment", path)
    assert refused.exit_code == 1
    assert "intrinsics are needed" in refused.stderr
    result = run("segment", path, "--intrinsics", "300, 300,80,60", "--depth-scale", 0.002, "--json")
    assert result.exit_code == 0, result.stderr
    [scan] = json.loads(result.stdout)["scans"]
    assert scan["n_points"] == 11_000
    [segment] = scan["segments"]
    middle = np.array([(74.5 - 80) / 300, (59.5 - 60) / 300, 1]) * 1.8
    np.testing.assert_allclose(segment["centroid"], middle, atol=0.01)


def test_mask_of_one_depth_image(tmp_path: Path) -> None:
    path = write_depth(tmp_path / "depth.png")
    mask = write_mask(tmp_path / "mask.png", 50)
    result = run("segment", path, "--mask", mask, "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["scans"][0]["n_points"] == 5000


def test_folder_of_depth_images_with_a_folder_of_masks(tmp_path: Path) -> None:
    for index, name in enumerate(("box/1.png", "can/1.png", "can/2.png", "can/3.png")):
        write_depth(tmp_path / "depth" / name)
        if index < 3:
            write_mask(tmp_path / "masks" / name, 40 + 10 * index)
    write_pcd(tmp_path / "depth" / "corner.pcd", box_corner())
    result = run("segment", tmp_path / "depth", "--mask", tmp_path / "masks", "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert {scan["name"]: scan["n_points"] for scan in document["scans"]} == {
        "box/1.png": 4000,
        "can/1.png": 5000,
        "can/2.png": 6000,
        "corner.pcd": 12_000,
    }
    [skipped] = document["skipped"]
    assert skipped["name"] == "can/3.png"
    assert str(tmp_path / "masks" / "can" / "3.png") in skipped["reason"]

    single = run("segment", tmp_path / "depth/can/2.png", "--mask", tmp_path / "masks/can", "--json")
    assert json.loads(single.stdout)["scans"][0]["n_points"] == 6000


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize(
    "arguments",
    [
        ["segment", "box"],
        ["segment", "box", "--json"],
        ["--help"],
        ["--version"],
    ],
)
def test_full_disk(scans: Path, tmp_path: Path, arguments: list[str]) -> None:
    arguments = [str(scans / "box") if argument == "box" else argument for argument in arguments]
    with open("/dev/full", "w") as full:
        result = run_installed(*arguments, folder=tmp_path, stdout=full)
    assert result.returncode == 1
    assert result.stderr == "Error: cannot write the output: No space left on device\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_full_disk_for_messages_too(tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:
        assert run_installed("--help", folder=tmp_path, stdout=full, stderr=full).returncode == 1


@pytest.mark.parametrize("arguments", [["segment", "box", "--json"], ["--help"]])
def test_closed_pipe(scans: Path, tmp_path: Path, arguments: list[str]) -> None:
    arguments = [str(scans / "box") if argument == "box" else argument for argument in arguments]
    reading, writing = os.pipe()
    os.close(reading)
    try:
        result = run_installed(*arguments, folder=tmp_path, stdout=writing)
    finally:
        os.close(writing)
    assert result.returncode == 1
    assert result.stderr == ""


def test_a_picture_that_cannot_be_written_keeps_the_old_one(
    scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Path, target: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    image = tmp_path / "corner.png"
    image.write_bytes(b"the old one")
    monkeypatch.setattr(Path, "replace", full)
    result = run("segment", scans / "box" / "box_0.pcd", "--image", image)
    assert result.exit_code == 1
    assert result.stderr == f"Error: cannot write {image}: No space left on device\n"
    assert "box_0.pcd" in result.stdout
    assert image.read_bytes() == b"the old one"
    assert list(tmp_path.iterdir()) == [image]


def test_an_interrupted_picture_keeps_the_old_one(
    scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(self: Image.Image, file: object, *arguments: object) -> None:
        if isinstance(file, str | Path):
            Path(file).write_bytes(b"half")
        raise KeyboardInterrupt

    image = tmp_path / "corner.png"
    image.write_bytes(b"the old one")
    monkeypatch.setattr(Image.Image, "save", interrupted)
    assert run("segment", scans / "box" / "box_0.pcd", "--image", image).exit_code != 0
    assert image.read_bytes() == b"the old one"


def test_a_picture_replaces_what_its_link_leads_to(scans: Path, tmp_path: Path) -> None:
    image, link = tmp_path / "corner.png", tmp_path / "link.png"
    image.write_bytes(b"the old one")
    link.symlink_to(image)
    assert run("segment", scans / "box" / "box_0.pcd", "--image", link).exit_code == 0
    assert link.is_symlink()
    assert image.read_bytes().startswith(b"\x89PNG")
