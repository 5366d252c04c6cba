"""`shapeconcepts doctor` as a user types it."""

import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from shapeconcepts.cli import app, doctor_command

FINE = "pass"


def run():
    return CliRunner().invoke(app, ["doctor"])


def test_it_tells_folders_versions_and_that_kernels_run() -> None:
    result = run()
    assert result.exit_code == 0, result.output
    told = " ".join(result.stdout.split())
    for said in (
        "numba 0.",
        sys.executable,
        "segments",
        " 0 damaged",
        "numba compiles yes",
        "kernels run yes",
    ):
        assert said in told, said
    assert result.stderr == ""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where kernels are kept, of which none has to be compiled."""
    monkeypatch.setattr(doctor_command, "_kernel_folders", lambda: [tmp_path])
    monkeypatch.setattr(doctor_command, "_COMPILE", FINE)
    monkeypatch.setattr(doctor_command, "_SEGMENT", FINE)
    return tmp_path


def test_damaged_files_are_named(folder: Path) -> None:
    (folder / "kernels.one-1.py311.checked.nbi").write_bytes(b"damaged")
    (folder / "kernels.one-1.py311.checked.1.nbc").write_bytes(b"")
    result = run()
    assert result.exit_code == 1
    assert "2 files, 2 damaged" in result.stdout
    assert "kernels.one-1.py311.checked.nbi" in result.stderr


def test_kernels_that_crash_are_told_with_the_way_out(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_command, "_SEGMENT", "import os; os.kill(os.getpid(), 9)")
    result = run()
    assert result.exit_code == 1
    assert "no: ended by signal 9" in result.stdout
    assert "delete the folders of kernels" in result.stderr
    assert "NUMBA_CACHE_DIR" in result.stderr


def test_a_compiler_that_fails_is_told_by_its_last_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor_command, "_COMPILE", "raise OSError('no LLVM here')")
    result = run()
    assert result.exit_code == 1
    assert "no: OSError: no LLVM here" in result.stdout
    assert "pip install" in result.stderr


def test_a_folder_that_cannot_be_written_is_told(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere = Path("/proc/none") if Path("/proc").is_dir() else Path("/dev/null/none")
    monkeypatch.setattr(doctor_command, "_kernel_folders", lambda: [nowhere])
    result = run()
    assert result.exit_code == 1
    assert "not writable" in result.stdout
    assert "NUMBA_CACHE_DIR" in result.stderr


def test_no_folder_for_kernels_is_told(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    monkeypatch.setattr(doctor_command, "_kernel_folders", lambda: [])
    result = run()
    assert result.exit_code == 1
    assert "kept nowhere" in result.stdout
    assert "NUMBA_CACHE_DIR" in result.stderr
