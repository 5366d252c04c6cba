"""The cook book of the documentation, run as it stands there, on a recording made here."""

import csv
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from recording_examples import BEGIN, SECOND, write
from shapeconcepts import Scan, datasets
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd

PAGE = Path(__file__).parents[1] / "docs" / "scenes.md"
N_FRAMES = 16


def commands():
    [block] = re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return [shlex.split(line, comments=True)[1:] for line in block.splitlines()]


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory):
    """A folder with kitchen.mcap and scene.pcd, in which the commands have been run; and what they said."""
    folder = tmp_path_factory.mktemp("kitchen")
    scenes = datasets.simulate_scenes(N_FRAMES + 1, random_state=5)

    def messages(maker):
        for number, scene in enumerate(scenes[:-1]):
            time = BEGIN + number * SECOND
            yield "/camera/depth/points", time, maker.cloud(scene.points, stamp=time)

    recording = write(folder / "kitchen", "mcap", messages)
    file = recording if recording.is_file() else next(recording.glob("*.mcap"))
    file.rename(folder / "kitchen.mcap")
    write_pcd(folder / "scene.pcd", Scan(scenes[-1].points.reshape(-1, 3), np.zeros(3)))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        patch.setenv("COLUMNS", "200")
        said = []
        for arguments in commands():
            result = CliRunner().invoke(app, arguments)
            assert result.exit_code == 0, result.output
            said.append(result.output)
    return folder, said


def test_a_recording_becomes_objects(kitchen):
    folder, (extracted, *_) = kitchen
    with (folder / "objects" / "objects.tsv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    assert len({row["scene"] for row in rows}) > N_FRAMES // 2 - 3
    assert f"Found {len(rows)} objects in " in extracted
    assert sorted(row["file"] for row in rows) == sorted(
        path.name for path in (folder / "objects").glob("*.pcd")
    )
    assert len(list((folder / "objects").glob("*.jpg"))) == N_FRAMES // 2
    assert all(float(row["time"]) >= BEGIN / SECOND for row in rows)


def test_objects_become_concepts_and_a_new_scene_is_answered(kitchen):
    folder, (_, learned, _, answered, _) = kitchen
    assert "Learned " in learned
    assert (folder / "m.html").stat().st_size > 10_000
    assert "scene/0" in answered
    assert "first" in answered


def test_a_labelled_data_set_comes_out(kitchen):
    folder, _ = kitchen
    clouds = list((folder / "dataset" / "sequences" / "00" / "velodyne").glob("*.bin"))
    objects = list((folder / "objects").glob("*.pcd"))
    assert len(clouds) == len(objects)
    assert "first" in (folder / "dataset" / "semantic-kitti.yaml").read_text(encoding="utf-8")
