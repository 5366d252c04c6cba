"""One scan that fails in any step: every command goes on with the others and says which it was."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts import descriptors, report
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.report import html
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.segmentation import Segmenter, segment_cache
from shapeconcepts.sources import collection

ERRORS = [MemoryError(), FloatingPointError("overflow"), np.linalg.LinAlgError("singular"), KeyError("x\x1b")]
BAD = "can/can_1.pcd"


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Scans, and a model of them."""
    folder = tmp_path_factory.mktemp("one_bad")
    for scan in shapeconcepts.datasets.simulate(4, categories=("ball", "can")):
        path = folder / "scans" / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    ShapeConceptModel().fit(shapeconcepts.read_scans(folder / "scans")).save(folder / "m")
    return folder


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty cache, instead of the user's."""
    monkeypatch.setattr(segment_cache, "user_cache_folder", lambda: tmp_path / "cache")


def break_step(monkeypatch: pytest.MonkeyPatch, owner: object, step: str, error: Exception) -> None:
    """Let a step fail for one scan, which it finds by its name in what it is given."""
    works: Callable[..., object] = getattr(owner, step)

    def fails(*arguments: object, **options: object) -> object:
        for one in arguments:
            if str(getattr(one, "name", one)).endswith(Path(BAD).name):
                raise error
        return works(*arguments, **options)

    monkeypatch.setattr(owner, step, fails)


STEPS = [(collection, "read_scan_silently"), (Segmenter, "segment"), (descriptors, "describe")]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize(
    ("command", "owner", "step"),
    [
        *[("learn", *one) for one in STEPS],
        *[("respond", *one) for one in STEPS],
        *[("segment", *one) for one in STEPS[:2]],  # it does not describe
    ],
)
def test_the_others_are_worked_on(
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: str,
    owner: object,
    step: str,
    error: Exception,
) -> None:
    break_step(monkeypatch, owner, step, error)
    arguments = {
        "learn": ["learn", "--model", tmp_path / "m", "--report", tmp_path / "m.html", folder / "scans"],
        "respond": ["respond", folder / "m", folder / "scans"],
        "segment": ["segment", folder / "scans"],
    }[command]
    result = run(*arguments, "--jobs", 1)
    assert result.exit_code == 0, result.output
    [line] = re.findall("Skipped 1 of 8 scans:\n  (.*)\n", result.stderr)
    assert "can_1.pcd: " in line
    assert ("more memory" if isinstance(error, MemoryError) else type(error).__name__) in line
    assert "can/can_2.pcd" in (result.stdout if command != "learn" else (tmp_path / "m.html").read_text())
    if command == "learn":
        assert "Learned" in result.stderr and (tmp_path / "m").is_file()


def test_a_picture_of_all_but_one(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    break_step(monkeypatch, report, "draw_segments", ValueError("no"))
    for one, expected in (("scans/can", 0), (f"scans/{BAD}", 1)):
        image = tmp_path / f"{expected}.png"
        result = run("segment", folder / one, "--image", image, "--json", "--jobs", 1)
        assert result.exit_code == expected, result.output
        assert re.search("Could not draw 1 of [14] scans:\n  .*can_1.pcd: cannot be drawn", result.stderr)
        document = json.loads(result.stdout)
        assert len(document["scans"]) == (1 if expected else 4) and document["skipped"] == []
        assert image.exists() == (expected == 0)


def test_a_report_of_all_but_one(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    break_step(monkeypatch, html, "preview", ZeroDivisionError("no"))
    outputs = ("--model", tmp_path / "m", "--report", tmp_path / "m.html")
    result = run("learn", folder / "scans", *outputs, "--jobs", 1)
    assert result.exit_code == 0, result.output
    reason = "can/can_1.pcd: cannot be drawn (ZeroDivisionError: no)"
    assert f"Could not draw 1 of 8 scans:\n  {reason}\n" in result.stderr
    assert BAD in (tmp_path / "m.html").read_text()


def test_a_response_that_fails_is_told_from_the_others(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recognise = ShapeConceptModel.recognise

    def fails(model: ShapeConceptModel, objects: object, unknown_rate: float | None) -> object:
        known = list(objects)  # type: ignore[call-overload]
        if any(one.name == BAD for one in known):
            raise MemoryError
        return recognise(model, known, unknown_rate)

    monkeypatch.setattr(ShapeConceptModel, "recognise", fails)
    result = run("respond", folder / "m", folder / "scans", "--format", "csv", "--jobs", 1)
    assert result.exit_code == 0
    assert len(result.stdout.splitlines()) == 8 and BAD not in result.stdout
    assert f"Skipped 1 of 8 scans:\n  {BAD}: needs more memory" in result.stderr


def test_more_segments_than_can_be_composed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    segment = Segmenter.segment

    def many(segmenter: Segmenter, scan: object) -> object:
        found = segment(segmenter, scan)
        if str(found.name).endswith(BAD):
            object.__setattr__(found, "n_segments", 17)
        return found

    monkeypatch.setattr(Segmenter, "segment", many)
    result = run("respond", folder / "m", folder / "scans", "--jobs", 1)
    assert result.exit_code == 0, result.output
    assert f"{BAD}: has 17 segments, expected at most 16" in result.stderr


@pytest.mark.parametrize(("owner", "step"), STEPS, ids=[step for _, step in STEPS])
def test_explain_says_why_not(
    folder: Path, monkeypatch: pytest.MonkeyPatch, owner: object, step: str
) -> None:
    break_step(monkeypatch, owner, step, ZeroDivisionError("no"))
    result = run("explain", folder / "m", folder / "scans" / BAD)
    assert result.exit_code == 1
    assert re.match(r"Error: .*can_1.pcd: cannot be \w+ \(ZeroDivisionError: no\)\n$", result.stderr)


def test_an_explanation_that_cannot_be_drawn_is_printed(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*arguments: object) -> None:
        raise MemoryError

    monkeypatch.setattr(report, "draw_explanation", fails)
    result = run("explain", folder / "m", folder / "scans" / BAD, "--image", tmp_path / "a.png")
    assert result.exit_code == 1
    assert "stimulus" in result.stdout
    assert "needs more memory than there is to be drawn" in result.stderr


def test_a_sheet_larger_than_memory(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*arguments: object) -> Image.Image:
        raise MemoryError

    monkeypatch.setattr(report, "contact_sheet", fails)
    result = run("segment", folder / "scans" / BAD, "--image", tmp_path / "a.png")
    assert result.exit_code == 1
    assert "Error: cannot write" in result.stderr and "memory" in result.stderr
    assert "can_1.pcd" in result.stdout


@pytest.mark.parametrize("command", ["learn", "segment"])
def test_scans_far_from_all_measure(folder: Path, tmp_path: Path, command: str) -> None:
    scans = tmp_path / "scans"
    scans.mkdir()
    content = (folder / "scans" / BAD).read_bytes()
    for name, z in (("good", b"0"), ("far", b"1e155"), ("farther", b"1e308")):
        viewpoint = b"VIEWPOINT 0 0 %s 1 0 0 0" % z
        (scans / f"{name}.pcd").write_bytes(re.sub(rb"VIEWPOINT[^\n]*", viewpoint, content, count=1))
    (scans / "two.xyz").write_text("0 0 1000000\n-1e-21 5e-33 1000000\n")
    outputs = {"learn": ["--model", tmp_path / "m", "--report", tmp_path / "out"]}
    result = run(command, scans, *outputs.get(command, ["--image", tmp_path / "out.png"]), "--jobs", 1)
    assert result.exit_code == 0, result.output
    assert (tmp_path / ("out" if command == "learn" else "out.png")).is_file()


def test_a_scan_error_stays_as_it_is() -> None:
    with pytest.raises(ScanError, match=r"^as it is$"), scan_errors("a", "read"):
        raise ScanError("as it is")
    with pytest.raises(KeyboardInterrupt), scan_errors("a", "read"):
        raise KeyboardInterrupt
