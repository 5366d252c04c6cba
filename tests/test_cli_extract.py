"""`shapeconcepts extract`, and `--extract` of the commands that take scans."""

import csv
import json

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from recording_examples import clouds, write
from shapeconcepts import Scan, datasets, read_scan, read_scans, read_scene
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd


@pytest.fixture(scope="module")
def scenes(tmp_path_factory):
    """Two scenes as files, one of them in a folder that is a label, and one that is none."""
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "kitchen").mkdir()
    for index, path in enumerate((folder / "one.npy", folder / "kitchen" / "two.npy")):
        np.save(path, datasets.simulate_scene(index, random_state=3).points.astype(np.float32))
    return folder


def run(*arguments):
    return CliRunner().invoke(app, ["extract", *map(str, arguments)])


def rows_of(folder):
    with (folder / "objects.tsv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def test_objects_pictures_and_an_index_are_written(scenes, tmp_path):
    out = tmp_path / "objects"
    result = run(scenes, out, "--jobs", 1)
    assert result.exit_code == 0, result.output
    rows = rows_of(out)
    assert len(rows) > 4
    for row in rows:
        scan = read_scan(out / row["file"])
        assert len(scan) == int(row["points"])
        assert np.array_equal(scan.viewpoint, (0, 0, 0))
    assert {row["file"].split("/")[0] for row in rows if "/" in row["file"]} == {"kitchen"}
    assert Image.open(out / "one.jpg").size == (640, 480)
    assert Image.open(out / "kitchen" / "two.jpg").size == (640, 480)


def test_the_number_of_jobs_changes_nothing(scenes, tmp_path):
    for jobs in (1, 2):
        assert run(scenes, tmp_path / str(jobs), "--jobs", jobs, "--no-pictures").exit_code == 0
    files = [sorted(path.relative_to(tmp_path / n) for path in (tmp_path / n).rglob("*.*")) for n in "12"]
    assert files[0] == files[1]
    assert all(
        (tmp_path / "1" / path).read_bytes() == (tmp_path / "2" / path).read_bytes() for path in files[0]
    )


def test_json_holds_what_the_index_holds(scenes, tmp_path):
    result = run(scenes / "one.npy", tmp_path / "objects", "--json")
    told = json.loads(result.stdout)
    assert [one["file"] for one in told["objects"]] == [row["file"] for row in rows_of(tmp_path / "objects")]
    assert told["scenes"] == 1
    assert told["skipped"] == []


def test_one_bad_scene_among_others_is_skipped(scenes, tmp_path):
    bad = tmp_path / "bad.npy"
    bad.write_bytes(b"nothing")
    bare = tmp_path / "bare.npy"
    np.save(
        bare, np.stack([*np.meshgrid(np.arange(80) / 100, np.arange(80) / 100), np.ones((80, 80))], axis=-1)
    )
    result = run(bad, bare, scenes / "one.npy", tmp_path / "objects")
    assert result.exit_code == 0, result.output
    assert "bad.npy" in result.output
    assert f"Nothing stands on anything that can be seen in {bare}" in result.output
    assert len(rows_of(tmp_path / "objects")) > 0


def test_nothing_found_is_an_error(tmp_path):
    ball = np.random.default_rng(0).normal(size=(2000, 3))
    np.save(tmp_path / "ball.npy", 0.1 * ball / np.linalg.norm(ball, axis=1, keepdims=True) + (0, 0, 1))
    result = run(tmp_path / "ball.npy", tmp_path / "objects")
    assert result.exit_code == 1
    assert "no object was found" in result.output


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["{scenes}"], "needs a scene or a recording, and a folder to write to"),
        (["{scenes}", "{scenes}"], "is not empty: --force writes into it"),
        (["{scenes}", "{out}", "--topic", "/x"], "is for recordings, and there is none"),
        (["{scenes}", "{out}", "--every", "2"], "is for recordings, and there is none"),
        (["{scenes}", "{scenes}/one.npy"], "must be a folder"),
    ],
)
def test_a_wrong_command_line_is_told(scenes, tmp_path, arguments, told):
    result = run(*(one.format(scenes=scenes, out=tmp_path / "out") for one in arguments))
    assert result.exit_code == 2
    assert told in " ".join(result.output.replace("│", " ").split())


def test_a_choice_of_topics_is_listed(tmp_path):
    def messages(maker):
        yield from clouds(1, "/left/points")(maker)
        yield from clouds(1, "/right/points")(maker)

    recording = write(tmp_path / "two", "bag", messages)
    result = run(recording, tmp_path / "objects")
    assert result.exit_code == 1
    assert "/left/points" in result.output
    assert "/right/points" in result.output


@pytest.mark.parametrize("suffix", [".pcd", ".npy", ".png"])
def test_files_with_an_image_stay_organised(tmp_path, suffix):
    scene = datasets.simulate_scene(0, random_state=3)
    path = tmp_path / f"scene{suffix}"
    if suffix == ".npy":
        np.save(path, scene.points)
    elif suffix == ".png":
        depth = np.nan_to_num(1000 * scene.points[..., 2]).round().astype(np.uint16)
        Image.fromarray(depth).save(path)
    else:
        write_pcd(path, Scan(scene.points.reshape(-1, 3), np.zeros(3)))
        header, body = path.read_bytes().split(b"DATA", 1)
        header = header.replace(b"WIDTH 307200", b"WIDTH 640").replace(b"HEIGHT 1\n", b"HEIGHT 480\n")
        path.write_bytes(header + b"DATA" + body)
    read = read_scene(path)
    assert read.points.shape == (480, 640, 3)
    assert np.allclose(read.points, scene.points, atol=3e-3, equal_nan=True)
    assert read.name == "scene"


def test_commands_take_scenes_directly(scenes, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    model = tmp_path / "m.safetensors"
    learned = CliRunner().invoke(app, ["learn", "--extract", str(scenes), "--model", str(model), "--json"])
    assert learned.exit_code == 0, learned.output
    assert run(scenes, tmp_path / "objects").exit_code == 0
    answered = CliRunner().invoke(
        app, ["respond", str(model), "--extract", str(scenes / "one.npy"), "--format", "jsonl"]
    )
    names = [json.loads(line)["scan"] for line in answered.stdout.splitlines()]
    own = [row for row in rows_of(tmp_path / "objects") if "/" not in row["file"]]
    assert names == [f"one/{row['number']}" for row in own]


def test_objects_of_a_labelled_scene_are_whole_scans(tmp_path):
    scene = datasets.simulate_scene(0, random_state=3)
    labels = scene.point_labels.ravel()
    write_pcd(tmp_path / "one.pcd", Scan(scene.points.reshape(-1, 3), np.zeros(3), point_labels=labels))
    assert run(tmp_path / "one.pcd", tmp_path / "objects").exit_code == 0
    written = read_scans(tmp_path / "objects")
    assert sorted(scan.name for scan in written) == sorted(
        row["file"] for row in rows_of(tmp_path / "objects")
    )
    assert all(scan.point_labels is None for scan in written)
    assert not written.skipped
