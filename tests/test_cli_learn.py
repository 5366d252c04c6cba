"""`shapeconcepts learn` as a user types it."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts.cli import app, object_reader, user_caches
from shapeconcepts.cli.object_reader import useful_jobs
from shapeconcepts.io import user_cache_folder as cache_folder_module
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.segmentation import segment_cache
from shapeconcepts.sources.osd import is_labelled_scene

COMMAND = Path(sys.executable).with_name("shapeconcepts")
CATEGORIES = ("ball", "box", "can")
N_PER_CATEGORY = 8


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def write_scans(folder: Path, n_per_category: int = N_PER_CATEGORY) -> Path:
    for scan in shapeconcepts.datasets.simulate(n_per_category, categories=CATEGORIES):
        path = folder / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    return folder


@pytest.fixture(scope="module")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_scans(tmp_path_factory.mktemp("data") / "scans")


@pytest.fixture(autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, instead of the user's."""
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setattr(segment_cache, "user_cache_folder", lambda: folder / "shapeconcepts")
    return folder


def entries(cache: Path) -> list[Path]:
    return sorted(path for path in cache.rglob("*.segments") if path.is_file())


def forbid_segmentation(monkeypatch: pytest.MonkeyPatch) -> None:
    def segment(*arguments: object) -> None:
        raise ScanError("is segmented again")

    monkeypatch.setattr("shapeconcepts.segmentation.Segmenter.segment", segment)


def test_learn_as_typed(scans: Path, tmp_path: Path) -> None:
    result = subprocess.run(
        [COMMAND, "learn", scans, "--model", "m.safetensors", "--report", "report.html"],
        cwd=tmp_path,
        env={**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "HOME": str(tmp_path)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.split()[:5] == ["concept", "scans", "labels", "typical", "scan"]
    assert "Wrote m.safetensors\nWrote report.html\n" in result.stderr
    assert "Traceback" not in result.stderr
    assert (tmp_path / "report.html").read_text().lstrip().lower().startswith("<!doctype html>")

    model = shapeconcepts.load_model(tmp_path / "m.safetensors")
    truth = shapeconcepts.ShapeConceptModel().fit(shapeconcepts.read_scans(scans))
    assert model.scan_names_ == truth.scan_names_
    assert model.scan_labels_ == truth.scan_labels_ == [c for c in CATEGORIES for _ in range(N_PER_CATEGORY)]
    np.testing.assert_array_equal(model.labels_, truth.labels_)
    np.testing.assert_array_equal(model.stimuli_.toarray(), truth.stimuli_.toarray())
    assert len(truth.concepts_) >= 2
    for concept in truth.concepts_:
        assert truth.scan_names_[concept.medoid] in result.stdout


def test_json_says_what_the_model_holds(scans: Path, tmp_path: Path) -> None:
    path = tmp_path / "m.safetensors"
    result = run("learn", scans, "--model", path, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    model = shapeconcepts.load_model(path)
    assert document["n_scans"] == len(model.scan_names_) == 24
    assert document["epsilon_max"] == model.filtration_.epsilon_max_
    assert document["concept_time"] == model.filtration_.concept_time_
    assert document["skipped"] == []
    assert len(document["concepts"]) == len(model.concepts_)
    for number, (said, concept) in enumerate(zip(document["concepts"], model.concepts_, strict=True)):
        assert said["number"] == number
        assert said["size"] == concept.size == sum(said["labels"].values())
        assert said["members"] == [model.scan_names_[i] for i in concept.members]
        assert said["lifetime"] == concept.lifetime
    in_none = [model.scan_names_[i] for i in np.flatnonzero(model.labels_ < 0)]
    assert document["in_no_concept"] == in_none


def test_parameters_reach_the_model(scans: Path, tmp_path: Path) -> None:
    path = tmp_path / "m.safetensors"
    options = [
        "--preset",
        "paper",
        "--min-size",
        4,
        "--levels",
        3,
        "--voxel-size",
        0.008,
    ]
    assert run("learn", scans, "--model", path, *options).exit_code == 0
    parameters = plain_parameters(shapeconcepts.load_model(path))
    expected = {
        "filtration__min_concept_size": 4,
        "ensemble__dictionary__n_levels": 3,
        "segmenter__voxel_size": 0.008,
    }
    assert parameters == plain_parameters(shapeconcepts.ShapeConceptModel.preset("paper", **expected))
    assert parameters["descriptor"] == "fpfh"
    document = json.loads(run("info", path, "--json").stdout)
    assert document["parameters"].items() >= expected.items()


def test_size_counts_where_it_shall(scans: Path, tmp_path: Path) -> None:
    path = tmp_path / "m.safetensors"
    assert run("learn", scans, "--model", path, "--scale", "metric").exit_code == 0
    assert shapeconcepts.load_model(path).descriptor == "surflet+fpfh+curvature+distance"
    one = str(scans / "can" / "can_0.pcd")
    assert run("respond", path, one).exit_code == 0


def plain_parameters(model: shapeconcepts.ShapeConceptModel) -> dict[str, object]:
    """Of all stages, but no stages."""
    return {name: value for name, value in model.get_params().items() if not hasattr(value, "get_params")} | {
        "segmenter": None
    }


@pytest.mark.parametrize(
    ("option", "value", "parameter"),
    [
        ("--min-size", 1, "'min_concept_size' parameter of Filtration must be an int"),
        ("--levels", 0, "'n_levels' parameter of SegmentDictionary must be an int"),
        ("--levels", 17, "'n_levels' parameter of SegmentDictionary must be an int"),
        ("--voxel-size", "nan", "'voxel_size' parameter of Segmenter must be a float"),
        ("--voxel-size", 0, "'voxel_size' parameter of Segmenter must be a float"),
    ],
)
def test_ranges_are_those_of_the_stages(
    option: str, value: object, parameter: str, scans: Path, tmp_path: Path
) -> None:
    result = run("learn", scans, "--model", tmp_path / "m", option, value)
    assert result.exit_code == 2
    said = " ".join(result.stderr.replace("│", " ").split())
    assert f"Invalid value for {option}: The {parameter}" in said


def test_without_data_it_learns_from_simulated_scans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(object_reader, "SIMULATED_PER_CATEGORY", 3)
    result = run("learn", "--model", tmp_path / "m.safetensors", "--json", "--jobs", 1)
    assert result.exit_code == 0, result.stderr
    model = shapeconcepts.load_model(tmp_path / "m.safetensors")
    truth = shapeconcepts.ShapeConceptModel().fit(shapeconcepts.datasets.simulate(3))
    assert model.scan_names_ == truth.scan_names_
    np.testing.assert_array_equal(model.stimuli_.toarray(), truth.stimuli_.toarray())


def test_a_bad_scan_is_skipped_and_reported(scans: Path, tmp_path: Path) -> None:
    letter = tmp_path / "letter.pcd"
    letter.write_text("Dear reader, this is no point cloud.\n")
    point = tmp_path / "point.xyz"
    point.write_text("0 0 1\n")
    path = tmp_path / "m.safetensors"
    result = run("learn", letter, point, scans, "--model", path, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    names = [one["name"] for one in document["skipped"]]
    assert names[0] == str(letter)
    assert f"Skipped {len(names)} of 26 scans:\n  {letter}: " in result.stderr
    assert document["n_scans"] == 26 - len(names)

    path.unlink()
    strict = run("learn", letter, scans, "--model", path, "--strict")
    assert strict.exit_code == 1
    assert strict.stderr.startswith(f"Error: {letter}: ")
    assert len(strict.stderr.splitlines()) == 1
    assert not path.exists()


def test_no_usable_scan_is_a_failure(tmp_path: Path) -> None:
    result = run("learn", tmp_path / "absent.pcd", "--model", tmp_path / "m.safetensors")
    assert result.exit_code == 1
    assert "absent.pcd: there is no such file" in result.stderr
    assert result.stderr.endswith("Error: none of the scans can be used\n")
    assert list(tmp_path.iterdir()) == []


def test_too_few_scans_make_a_model_without_concepts(scans: Path, tmp_path: Path) -> None:
    path = tmp_path / "m.safetensors"
    result = run("learn", scans / "can" / "can_0.pcd", "--model", path)
    assert result.exit_code == 0
    assert "1 scans, no concept" in result.stderr
    assert shapeconcepts.load_model(path).concepts_ == []


def test_a_second_run_does_not_segment_again(
    scans: Path, tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = tmp_path / "first.safetensors", tmp_path / "second.safetensors"
    assert run("learn", scans, "--model", first).exit_code == 0
    assert len(entries(cache)) == 24
    forbid_segmentation(monkeypatch)
    assert run("learn", scans, "--model", second, "--strict").exit_code == 0
    assert first.read_bytes() == second.read_bytes()
    other = run("learn", scans, "--model", second, "--strict", "--descriptor", "fpfh", "--min-size", 2)
    assert other.exit_code == 0, other.stderr
    for option in (["--no-cache"], ["--voxel-size", 0.01]):
        again = run("learn", scans, "--model", second, "--strict", *option)
        assert again.exit_code == 1
        assert "is segmented again" in again.stderr


def test_the_cache_goes_by_the_content_of_a_file(
    tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_scans(tmp_path / "scans", 2)
    assert run("learn", folder, "--model", tmp_path / "m").exit_code == 0
    moved = folder.rename(tmp_path / "moved")
    (moved / "can").rename(moved / "tin")
    changed = moved / "tin" / "can_1.pcd"
    write_pcd(changed, Scan(shapeconcepts.read_scan(changed).points[:-1], name="changed"))
    forbid_segmentation(monkeypatch)
    document = json.loads(run("learn", moved, "--model", tmp_path / "m", "--json").stdout)
    assert [one["name"] for one in document["skipped"]] == ["tin/can_1.pcd"]
    model = shapeconcepts.load_model(tmp_path / "m")
    assert model.scan_names_ == [
        "ball/ball_0.pcd", "ball/ball_1.pcd", "box/box_0.pcd", "box/box_1.pcd", "tin/can_0.pcd"
    ]  # fmt: skip
    assert model.scan_labels_ == ["ball", "ball", "box", "box", "tin"]


@pytest.mark.parametrize("damage", ["empty", "half", "flipped", "foreign", "pickle"])
def test_a_damaged_entry_is_made_anew(tmp_path: Path, cache: Path, damage: str) -> None:
    folder = write_scans(tmp_path / "scans", 1)
    first, second = tmp_path / "first", tmp_path / "second"
    run("learn", folder, "--model", first)
    whole = [path.read_bytes() for path in entries(cache)]
    for path, content in zip(entries(cache), whole, strict=True):
        middle = len(content) // 3
        if damage == "pickle":
            with path.open("wb") as file:
                np.savez(file, n_objects=np.array([print], dtype=object))
        else:
            path.write_bytes(
                {
                    "empty": b"",
                    "half": content[: len(content) // 2],
                    "flipped": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
                    "foreign": b"Dear reader",
                }[damage]
            )
    result = run("learn", folder, "--model", second)
    assert result.exit_code == 0
    assert "cache" not in result.stderr
    assert first.read_bytes() == second.read_bytes()
    assert [path.read_bytes() for path in entries(cache)] == whole


def test_a_cache_that_cannot_be_written_is_noted_once(scans: Path, tmp_path: Path, cache: Path) -> None:
    (cache / "shapeconcepts").write_text("a file in the way")
    result = run("learn", scans, "--model", tmp_path / "m")
    assert result.exit_code == 0
    assert result.stderr.count("Note: segments are not kept for the next time") == 1
    assert (tmp_path / "m").exists()


def test_no_cache_leaves_nothing_behind(scans: Path, tmp_path: Path, cache: Path) -> None:
    assert run("learn", scans / "can", "--model", tmp_path / "m", "--no-cache").exit_code == 0
    assert entries(cache) == []


@pytest.mark.skipif(sys.platform != "linux", reason="the place is another one on other systems")
def test_cache_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.undo()
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert segment_cache.user_cache_folder() == tmp_path / "xdg" / "shapeconcepts"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert segment_cache.user_cache_folder() == tmp_path / ".cache" / "shapeconcepts"


@pytest.mark.parametrize("unknown", [Path("~/.cache/shapeconcepts"), RuntimeError("no home")])
def test_no_cache_folder_without_a_home(
    monkeypatch: pytest.MonkeyPatch, unknown: Path | RuntimeError
) -> None:
    """Versions of platformdirs answer differently."""
    monkeypatch.undo()

    def user_cache_path(*arguments: object, **options: object) -> Path:
        if isinstance(unknown, Path):
            return unknown
        raise unknown

    monkeypatch.setattr(cache_folder_module, "user_cache_path", user_cache_path)
    with pytest.raises(OSError, match=r"~/\.cache|no home"):
        segment_cache.user_cache_folder()
    assert user_caches.user_cache() is None


def test_results_do_not_depend_on_jobs(scans: Path, tmp_path: Path) -> None:
    letter = tmp_path / "letter.pcd"
    letter.write_text("Dear reader, this is no point cloud.\n")
    outputs = []
    for jobs in (1, 2):
        model, report = tmp_path / f"{jobs}.safetensors", tmp_path / f"{jobs}.html"
        result = run(
            "learn", letter, scans, "--model", model, "--report", report, "--no-cache", "--jobs", jobs
        )
        assert result.exit_code == 0, result.stderr
        outputs.append((model.read_bytes(), report.read_bytes(), result.stdout))
    assert outputs[0] == outputs[1]


def test_processes_are_started_only_where_they_pay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("joblib.effective_n_jobs", lambda jobs: 8)
    assert useful_jobs(-1, 10) == 1
    assert useful_jobs(-1, 40) == 2
    assert useful_jobs(-1, 5000) == 8
    assert useful_jobs(4, 10) == 4
    assert useful_jobs(4, 2) == 2


def scene() -> Scan:
    """A table, two simulated objects on it, and stray invalid points, as in a labelled scene."""
    objects = [shapeconcepts.datasets.simulate(1, categories=[name])[0] for name in ("box", "can")]
    table = np.random.default_rng(0).uniform((-0.5, 0.2, 0.8), (0.5, 0.2, 1.4), (2000, 3))
    points = [np.zeros((5, 3)), table, objects[0].points, objects[1].points]
    labels = [np.repeat([0, 1], [5, 2000]), np.full(len(points[2]), 20), np.full(len(points[3]), 31)]
    return Scan(np.concatenate(points), point_labels=np.concatenate(labels))


def test_objects_of_labelled_scenes(tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    for name in ("learn1.pcd", "learn35.pcd", "kitchen.pcd"):
        write_pcd(folder / name, scene())
    document = json.loads(run("learn", folder, "--model", tmp_path / "m", "--json").stdout)
    assert document["skipped"] == []
    model = shapeconcepts.load_model(tmp_path / "m")
    assert model.scan_names_ == [
        "kitchen/2", "kitchen/3", "learn1/2", "learn1/3", "learn35/2", "learn35/3"
    ]  # fmt: skip
    assert model.scan_labels_ == [None, None, "box", "box", "can", "can"]

    forbid_segmentation(monkeypatch)
    assert run("learn", folder, "--model", tmp_path / "again", "--strict").exit_code == 0
    assert (tmp_path / "m").read_bytes() == (tmp_path / "again").read_bytes()
    whole = run("learn", folder, "--model", tmp_path / "m", "--no-scenes", "--strict")
    assert "is segmented again" in whole.stderr


def test_scenes_on_demand(scans: Path, tmp_path: Path) -> None:
    result = run("learn", scans / "can" / "can_0.pcd", "--model", tmp_path / "m", "--scenes")
    assert result.exit_code == 1
    assert "holds no labelled object" in result.stderr


@pytest.mark.parametrize(
    ("labels", "expected"),
    [
        (None, False),
        ([0, 1, 20, 30, 31], True),
        ([1, 25], True),
        ([0, 1, 2, 3], False),
        ([0, 20, 30], False),
        ([0, 1, 12, 20], False),
        ([0, 0], False),
    ],
)
def test_what_a_labelled_scene_is(labels: list[int] | None, expected: bool) -> None:
    assert is_labelled_scene(None if labels is None else np.array(labels)) is expected


def test_real_scenes(shared_data: Path, tmp_path: Path) -> None:
    result = run("learn", shared_data / "osd_learn", "--model", tmp_path / "m", "--json")
    assert result.exit_code == 0, result.stderr
    model = shapeconcepts.load_model(tmp_path / "m")
    assert model.scan_labels_.count("box") == model.scan_labels_.count("can") == 38
    crops = shapeconcepts.datasets.load_osd(shared_data / "osd_learn")
    assert model.scan_names_ == [crop.name for crop in crops]
    assert len(json.loads(result.stdout)["concepts"]) >= 2


def test_an_interruption_keeps_the_cache_and_writes_nothing(
    scans: Path, tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    segment = shapeconcepts.Segmenter.segment
    calls = []

    def interrupted(*arguments: Any) -> object:
        calls.append(arguments)
        if len(calls) == 6:
            raise KeyboardInterrupt
        return segment(*arguments)

    monkeypatch.setattr("shapeconcepts.segmentation.Segmenter.segment", interrupted)
    path = tmp_path / "m"
    path.write_text("the old one")
    result = run("learn", scans, "--model", path, "--report", tmp_path / "r.html")
    assert result.exit_code == 130
    assert result.stderr == "Interrupted; the segments that were found are kept for the next time\n"
    assert result.stdout == ""
    assert path.read_text() == "the old one"
    assert [one.name for one in tmp_path.iterdir()] == ["m"]
    assert len(entries(cache)) == 5


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_while_several_processes_work(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    process = subprocess.Popen(
        [COMMAND, "learn", "--model", "m", "--jobs", "2"],
        cwd=tmp_path,
        env={**os.environ, "XDG_CACHE_HOME": str(cache), "HOME": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and process.poll() is None and len(list(cache.rglob("*.segments"))) < 3:
        time.sleep(0.05)
    # As a terminal does it: to all of them.
    os.killpg(process.pid, signal.SIGINT)
    stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 130
    assert stdout == ""
    assert stderr == "Interrupted; the segments that were found are kept for the next time\n"
    assert not (tmp_path / "m").exists()
    assert {path.suffix for path in cache.rglob("*") if path.is_file()} <= {".segments", ".descriptions"}


def test_outputs_are_checked_before_the_work(scans: Path, tmp_path: Path) -> None:
    model, report = tmp_path / "m", tmp_path / "r.html"
    for options, code, message in (
        (["--model", tmp_path], 2, "is a folder"),
        (["--model", tmp_path / "none" / "m"], 2, "does not exist"),
        (["--model", model, "--report", tmp_path / "none" / "r.html"], 2, "does not exist"),
        (["--model", model, "--report", model], 2, "another file than --model"),
        (["--model", "/proc/m"], 1, "Error: cannot write /proc/m"),
        (["--model", model, "--report", "/proc/r.html"], 1, "Error: cannot write /proc/r.html"),
    ):
        if "/proc" in message and not Path("/proc").is_dir():
            continue
        result = run("learn", scans, *options)
        assert result.exit_code == code, options
        assert message in " ".join(result.stderr.replace("│", "").split())
        assert not model.exists()
        assert not report.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="files of POSIX")
@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (["--model", "/dev/null"], "not a regular file"),
        (["--model", "m", "--report", "/dev/null"], "not a regular file"),
        (["--model", "pipe"], "not a regular file"),
        (["--model", "socket"], "not a regular file"),
        (["--model", "m", "--report", "pipe"], "not a regular file"),
        (["--model", "link to pipe"], "not a regular file"),
        (["--model", "m", "--report", "link to m"], "another file than --model"),
        (["--model", "link to m", "--report", "./m"], "another file than --model"),
        (["--model", "m", "--report", "second name of m"], "another file than --model"),
        (["--model", "m/m"], "does not exist"),
        (["--model", "x" * 300], "cannot write x"),
    ],
)
def test_what_cannot_be_replaced_is_said_before_the_work(
    outputs: list[str], message: str, scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    forbid_segmentation(monkeypatch)
    Path("m").write_text("the old one")
    os.mkfifo("pipe")
    with socket.socket(socket.AF_UNIX) as one:
        one.bind("socket")
    Path("link to pipe").symlink_to("pipe")
    Path("link to m").symlink_to("m")
    Path("second name of m").hardlink_to("m")
    before = sorted(os.listdir())
    result = run("learn", scans, *outputs)
    assert result.exit_code in (1, 2)
    assert isinstance(result.exception, SystemExit)
    assert message in " ".join(result.stderr.replace("│", "").split())
    assert sorted(os.listdir()) == before
    assert Path("m").read_text() == "the old one"


@pytest.mark.parametrize("option", ["respond", "explain", "segment", "evaluate"])
def test_other_commands_say_it_before_the_work_too(
    option: str, scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    forbid_segmentation(monkeypatch)
    os.mkfifo("pipe.png")
    scan = next(scans.rglob("*.pcd"))
    command = {
        "respond": ["respond", "none", scan, "--output", "pipe.png"],
        "explain": ["explain", "none", scan, "--image", "pipe.png"],
        "segment": ["segment", scan, "--image", "pipe.png"],
        "evaluate": ["evaluate", scans, "--report", "pipe.png"],
    }[option]
    result = run(*command)
    assert result.exit_code == 2
    assert "not a regular file" in " ".join(result.stderr.replace("│", "").split())


def test_both_files_stay_if_the_report_fails(
    scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(28, "No space left on device")

    model, report = tmp_path / "m", tmp_path / "r.html"
    model.write_text("the old one")
    monkeypatch.setattr("shapeconcepts.report.html.write_report", full)
    result = run("learn", scans, "--model", model, "--report", report)
    assert result.exit_code == 1
    assert result.stderr == f"Error: cannot write {model} and {report}: No space left on device\n"
    assert model.read_text() == "the old one"
    assert list(tmp_path.iterdir()) == [model]


@pytest.mark.parametrize(
    "arguments",
    [
        ["learn", "--model", "m", "--preset", "best"],
        ["learn", "--model", "m", "--min-size", "1"],
        ["learn", "--model", "m", "--levels", "0"],
        ["learn", "--model", "m", "--levels", "40"],
        ["learn", "--model", "m", "--bandwidth", "0"],
        ["learn", "--model", "m", "--descriptor", "shot"],
        ["learn", "--model", "m", "--descriptor", "fpfh", "--scale", "metric"],
        ["learn", "--model", "m", "--preset", "paper", "--scale", "metric"],
        ["learn", "--model", "m", "--jobs", "0"],
        ["learn", "--model", "m", "--voxel-size", "nan"],
    ],
)
def test_usage_errors(arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert arguments[-2] in result.stderr
    assert list(tmp_path.iterdir()) == []
