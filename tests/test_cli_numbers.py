"""Numbers on the command line that are none, or out of range, are complained about before the work."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from shapeconcepts.cli import app

# A finite positive number is expected; what Python makes of each, which the message says.
NO_LENGTHS = {
    "nan": "nan",
    "-nan": "nan",
    "inf": "inf",
    "-inf": "-inf",
    "1e400": "inf",
    "0": "0.0",
    "-1": "-1.0",
}
NO_COUNTS = ["nan", "1e400", "1.5", "0", "99999999999999999999"]
SEGMENT = ["segment", "a.png"]
LEARN = ["learn", "a.png", "--model", "m"]


def complaint(arguments: list[str], option: str, value: str, folder: Path) -> str:
    """What the command says, in one line."""
    (folder / "a.png").write_bytes(b"no picture")
    result = CliRunner().invoke(app, [*arguments, f"{option}={value}"])
    assert result.exit_code == 2, result.output
    assert not (folder / "m").exists()
    said = " ".join(result.stderr.replace("│", " ").split())
    assert option in said
    return said


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty folder to stand in."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("value", NO_LENGTHS)
@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (SEGMENT, "--voxel-size"),
        (SEGMENT, "--seed-size"),
        (SEGMENT, "--depth-scale"),
        (LEARN, "--voxel-size"),
        (LEARN, "--depth-scale"),
        (["respond", "m", "a.png"], "--depth-scale"),
        (["explain", "m", "a.png"], "--depth-scale"),
    ],
)
def test_lengths(arguments: list[str], option: str, value: str, tmp_path: Path) -> None:
    said = complaint(arguments, option, value, tmp_path)
    assert NO_LENGTHS[value] in said
    assert "> 0" in said or "in the range (0.0, inf)" in said


@pytest.mark.parametrize(
    "value", ["nan,1,1,1", "1,inf,1,1", "1,1,1e400,1", "0,1,1,1", "1,-1,1,1", "1,1,1", "1,1,1,1,1"]
)
def test_cameras(value: str, tmp_path: Path) -> None:
    assert f"got '{value}'" in complaint(SEGMENT, "--intrinsics", value, tmp_path)


@pytest.mark.parametrize("value", NO_COUNTS)
@pytest.mark.parametrize(
    ("arguments", "option"),
    [(SEGMENT, "--max-segments"), (LEARN, "--min-size"), (LEARN, "--levels")],
)
def test_counts(arguments: list[str], option: str, value: str, tmp_path: Path) -> None:
    complaint(arguments, option, value, tmp_path)


@pytest.mark.parametrize("value", NO_COUNTS[:-1])
@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["simulate", "m"], "--n-per-category"),
        (["evaluate"], "--repetitions"),
        (["explain", "m", "a.png"], "--object"),
    ],
)
def test_counts_without_a_largest(arguments: list[str], option: str, value: str, tmp_path: Path) -> None:
    complaint(arguments, option, value, tmp_path)


@pytest.mark.parametrize("value", NO_COUNTS[:4])
@pytest.mark.parametrize("command", [SEGMENT, LEARN, ["respond", "m", "a.png"], ["evaluate"]])
def test_jobs(command: list[str], value: str, tmp_path: Path) -> None:
    complaint(command, "--jobs", value, tmp_path)
