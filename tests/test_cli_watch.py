"""`shapeconcepts watch`: each scan answered and learned from once, whatever ends the command."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
import warnings

import numpy as np
import pytest

from shapeconcepts import ShapeConceptModel, datasets, load_model
from shapeconcepts.io.write_pcd import write_pcd
from test_cli_learn import COMMAND, run

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


@pytest.fixture(scope="module")
def learned(tmp_path_factory):
    path = tmp_path_factory.mktemp("watch") / "m.safetensors"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ShapeConceptModel().fit(datasets.simulate(8, categories=("ball", "teddy"), random_state=0)).save(path)
    return path


@pytest.fixture
def model(learned, tmp_path):
    path = tmp_path / "m.safetensors"
    path.write_bytes(learned.read_bytes())
    return path


def write_scan(folder, number):
    scan = datasets.simulate_scan(("ball", "teddy", "plate")[number % 3], number, random_state=5)
    hidden = folder / f".{number}"
    write_pcd(hidden, scan)
    hidden.rename(folder / f"scan_{number}.pcd")


def answers(text):
    return [json.loads(line) for line in text.splitlines()]


def test_what_is_there_is_answered_once(model, tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    for number in range(4):
        write_scan(folder, number)
    (folder / "broken.pcd").write_text("nothing")
    result = run("watch", folder, "--model", model, "--once")
    assert result.exit_code == 0, result.output
    lines = answers(result.stdout)
    assert sorted(line["scan"] for line in lines) == ["broken.pcd", *(f"scan_{i}.pcd" for i in range(4))]
    assert [line["scan"] for line in lines if "error" in line] == ["broken.pcd"]
    for line in lines:
        if "error" not in line:
            assert 0 < line["p_value"] <= 1
            assert line["novel"] == (line["p_value"] <= 0.05)
            assert (line["concept"] == "unknown") == (line["number"] == line["key"] == -1)
    assert load_model(model).scan_names_[-4:] == [f"scan_{i}.pcd" for i in range(4)]
    # And not again.
    write_scan(folder, 9)
    again = answers(run("watch", folder, "--model", model, "--once").stdout)
    assert [line["scan"] for line in again if "error" not in line] == ["scan_9.pcd"]
    assert len(load_model(model).labels_) == 16 + 5


def test_an_empty_folder_is_none_yet(model, tmp_path):
    (tmp_path / "scans").mkdir()
    before = model.read_bytes()
    assert run("watch", tmp_path / "scans", "--model", model, "--once").exit_code == 0
    assert model.read_bytes() == before


def start(folder, model, output, *options):
    arguments = [COMMAND, "watch", folder, "--model", model, "--every", "0.1", *options]
    return subprocess.Popen(list(map(str, arguments)), stdout=output, stderr=subprocess.PIPE)


def wait_for(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def test_scans_are_answered_as_they_come_and_saved_at_the_end(model, tmp_path):
    folder, output = tmp_path / "scans", tmp_path / "answers"
    folder.mkdir()
    with output.open("wb") as stream:
        process = start(folder, model, stream)
        for number in range(3):
            write_scan(folder, number)
        # One that is being written: half of it is there, and changes between the looks.
        whole = (folder / "scan_0.pcd").read_bytes()
        slow = folder / "slow.pcd"
        for end in np.linspace(0, len(whole), 12).astype(int)[1:]:
            slow.write_bytes(whole[:end])
            time.sleep(0.06)
        wait_for(lambda: len(output.read_text().splitlines()) >= 4)
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 128 + signal.SIGTERM
    lines = answers(output.read_text())
    assert sorted(line["scan"] for line in lines) == [*(f"scan_{i}.pcd" for i in range(3)), "slow.pcd"]
    assert not any("error" in line for line in lines)
    assert sorted(load_model(model).scan_names_[-4:]) == sorted(line["scan"] for line in lines)


def test_kills_lose_nothing_and_count_nothing_twice(model, tmp_path):
    folder, output = tmp_path / "scans", tmp_path / "answers"
    folder.mkdir()
    waits = np.random.default_rng(0).uniform(0.5, 3.5, 4)
    for turn, wait in enumerate(waits):
        with output.open("ab") as stream:
            process = start(folder, model, stream, "--save-every", "2")
            for number in range(4 * turn, 4 * turn + 4):
                write_scan(folder, number)
            time.sleep(wait)
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
        names = load_model(model).scan_names_
        assert len(set(names[16:])) == len(names[16:])
    assert run("watch", folder, "--model", model, "--once").exit_code == 0
    names = load_model(model).scan_names_[16:]
    assert sorted(names) == sorted(f"scan_{number}.pcd" for number in range(16))


def test_other_scans_of_the_same_names_are_other_scans(model, tmp_path):
    folders = tmp_path / "day1", tmp_path / "day2"
    for day, folder in enumerate(folders):
        folder.mkdir()
        for number in range(3):
            scan = datasets.simulate_scan(("ball", "teddy")[number % 2], 10 * day + number, random_state=5)
            write_pcd(folder / f"{number}.pcd", scan)
    for folder in folders:
        assert len(answers(run("watch", folder, "--model", model, "--once").stdout)) == 3
    # And a file that is replaced.
    (folders[0] / "0.pcd").write_bytes((folders[1] / "1.pcd").read_bytes())
    assert len(answers(run("watch", folders[0], "--model", model, "--once").stdout)) == 1
    assert run("watch", folders[1], "--model", model, "--once").stdout == ""
    assert len(load_model(model).labels_) == 16 + 7
