"""`shapeconcepts evaluate` as a user types it."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts.cli import app, object_reader
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.segmentation import segment_cache


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, ["evaluate", *map(str, arguments), "--jobs", "1", "--repetitions", "1"])


def write_scans(folder: Path, n_per_category: int, random_state: int = 0) -> Path:
    for scan in shapeconcepts.datasets.simulate(
        n_per_category, categories=["ball", "box", "can"], random_state=random_state
    ):
        path = folder / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    return folder


@pytest.fixture(scope="module")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_scans(tmp_path_factory.mktemp("data") / "scans", 8)


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory):
    """An empty cache, instead of the user's."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segment_cache, "user_cache_folder", lambda: folder / "shapeconcepts")
        yield folder


@pytest.fixture(scope="module")
def everything(scans: Path, tmp_path_factory: pytest.TempPathFactory):
    """All that the command writes, with another data set, a renamed label and a scan that cannot be read."""
    folder = tmp_path_factory.mktemp("out")
    data = shutil.copytree(scans, folder / "mine")
    (data / "can" / "broken.pcd").write_bytes(b"nothing")
    also = write_scans(folder / "theirs", 4, random_state=5)
    (also / "can").rename(also / "cocacola")
    result = run(
        data,
        "--also", also,
        "--rename", "cocacola=can",
        "--report", folder / "report.html",
        "--figures", folder / "figures",
        "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    return folder, result


def test_json_has_every_figure(everything) -> None:
    _, result = everything
    document = json.loads(result.stdout)
    assert document["data_name"] == "mine"
    assert document["labels"] == {"ball": 8, "box": 8, "can": 8}
    assert document["repetitions"] == 1
    assert [one["preset"] for one in document["selections"]] == ["default", "paper"]
    assert set(document["selections"][0]["errors"]) == {"ball", "box", "can"}
    assert len(document["levels"]["levels"]) == 6
    assert set(document["map"]["data_set"]) == {"mine, training", "mine, testing", "theirs"}
    assert set(document["map"]["nearest_region_right"]["theirs"]) == {"ball", "box", "can"}
    assert len(document["baselines"]) == 78
    chosen = [row for row in document["baselines"] if row["grouping"] != "our filtration"]
    assert all(all(row["parameters"]) for row in chosen)
    assert document["command"].startswith("shapeconcepts")


def test_bad_scans_are_skipped_and_named(everything) -> None:
    _, result = everything
    [[_, reason]] = json.loads(result.stdout)["skipped"]
    assert "broken.pcd" in reason
    assert "Skipped 1 of 37 scans:" in result.stderr
    assert "broken.pcd" in result.stderr


def test_report_and_figures_are_written(everything) -> None:
    folder, result = everything
    page = (folder / "report.html").read_text()
    assert page.lstrip().lower().startswith("<!doctype html>")
    assert "Evaluation on mine" in page
    pictures = {path.name for path in (folder / "figures").iterdir()}
    assert {"barcode.png", "barcode.svg", "map.png", "purity.svg", "baselines.png"} <= pictures
    assert f"Wrote {folder / 'report.html'}\nWrote {folder / 'figures'}\n" in result.stderr


def test_tables_for_simulated_objects_and_the_other_preset(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(object_reader, "SIMULATED_PER_CATEGORY", 4)
    result = run("--preset", "paper")
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    assert lines[0].startswith("simulated: 28 objects (amphora 4, ball 4, ")
    starts = [line.strip() for line in lines]
    at = {
        start: next(i for i, line in enumerate(starts) if line.startswith(start))
        for start in (
            "Groups found without labels",
            "shapeconcepts, paper",
            "shapeconcepts, default",
            "the paper, on its own data",
            "Classification error",
            "concepts chosen with labels",
            "the paper, table 1",
            "Number and minimum size",
            "Number of dictionary levels",
            "Generalisation",
        )
    }
    assert list(at.values()) == sorted(at.values())
    of_paper = "4.6 10.4 0.0 2.5 6.5 0.0 4.2 8.8"
    assert " ".join(lines[at["the paper, table 1"]].split()[4:]) == of_paper
    assert "Measured in " in result.stderr


def test_labels_that_are_missing_or_rare(tmp_path: Path, scans: Path) -> None:
    (tmp_path / "flat").mkdir()
    shutil.copy(scans / "can" / "can_0.pcd", tmp_path / "flat" / "thing.pcd")
    result = run(tmp_path / "flat")
    assert result.exit_code == 1
    assert f"Error: {tmp_path / 'flat'}: holds no labelled scans" in result.stderr

    few = shutil.copytree(scans, tmp_path / "few")
    for number in range(3, 8):
        (few / "can" / f"can_{number}.pcd").unlink()
    result = run(few, "--repetitions", 1)
    assert result.exit_code == 0
    assert "only 3 scans have its label 'can', at least 4 are needed" in result.stderr

    result = run(scans / "can", tmp_path / "nowhere")
    assert result.exit_code == 1
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--rename", "cocacola"], "must be OLD=NEW, got 'cocacola'"),
        (["--rename", "tin=can"], "no scan has the label 'tin'"),
        (["--report", "nowhere/report.html"], "the folder nowhere does not exist"),
        (["--figures", "nowhere/figures"], "the folder nowhere does not exist"),
    ],
)
def test_a_wrong_command_line(scans: Path, options: list[str], complaint: str) -> None:
    result = run(scans, *options)
    assert result.exit_code == 2
    assert complaint in " ".join(result.stderr.replace("│", " ").split())
