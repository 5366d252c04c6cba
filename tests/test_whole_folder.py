"""Folders that appear complete or not at all."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import pytest

from shapeconcepts.interruption import unfinished
from shapeconcepts.io.whole_folder import folder_written_whole

WRITES_FOR_EVER = """
import sys
from pathlib import Path
from shapeconcepts.interruption import end_at_signals
from shapeconcepts.io.whole_folder import folder_written_whole
end_at_signals()
with folder_written_whole(Path(sys.argv[1]), replace=True) as folder:
    for number in range(10**9):
        folder.write(f"{number % 97}/{number}", bytes(1000))
"""


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def test_nothing_is_there_before_the_end(tmp_path: Path) -> None:
    with folder_written_whole(tmp_path / "out") as folder:
        folder.write("a/b", b"1")
        assert not (tmp_path / "out").exists()
    assert files_below(tmp_path) == {"out/a/b": b"1"}
    assert not unfinished


@pytest.mark.parametrize(
    "failure", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError()]
)
def test_a_failure_leaves_what_was_there(tmp_path: Path, failure: BaseException) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/old").write_bytes(b"old")
    with pytest.raises(type(failure)), folder_written_whole(tmp_path / "out", replace=True) as folder:
        folder.write("new", b"new")
        raise failure
    assert files_below(tmp_path) == {"out/old": b"old"}
    assert not unfinished


def test_what_was_there_comes_back_if_there_is_no_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/old").write_bytes(b"old")
    rename = Path.rename

    def refuse(path: Path, target: Path) -> Path:
        if (path / "new").exists():
            raise PermissionError(13, "Permission denied")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(PermissionError), folder_written_whole(tmp_path / "out", replace=True) as folder:
        folder.write("new", b"new")
    assert files_below(tmp_path) == {"out/old": b"old"}


def test_a_folder_that_holds_something_is_replaced_only_if_wanted(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with folder_written_whole(tmp_path / "out") as folder:
        folder.write("first", b"")
    with pytest.raises(FileExistsError, match="out: is there already, and not empty"):
        folder_written_whole(tmp_path / "out").__enter__()
    with folder_written_whole(tmp_path / "out", replace=True) as folder:
        folder.write("second", b"")
    assert list(files_below(tmp_path)) == ["out/second"]


def test_neither_a_file_nor_a_folder_without_a_place(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError, match="is there already, and no folder"):
        folder_written_whole(tmp_path / "file", replace=True).__enter__()
    with pytest.raises(NotADirectoryError, match=r"the folder .*nowhere does not exist"):
        folder_written_whole(tmp_path / "nowhere/out").__enter__()


@pytest.mark.parametrize("place", ["", "/etc/x", "..", "a/../../x", "../x"])
def test_nothing_is_written_outside(tmp_path: Path, place: str) -> None:
    with folder_written_whole(tmp_path / "out") as folder:
        with pytest.raises(ValueError, match="place must be inside the folder"):
            folder.write(place, b"")
        folder.write("x", b"")
        with pytest.raises(FileExistsError):
            folder.write("x", b"")
    assert list(files_below(tmp_path)) == ["out/x"]


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
def test_a_signal_leaves_nothing_half(tmp_path: Path, number: signal.Signals) -> None:
    process = subprocess.Popen([sys.executable, "-c", WRITES_FOR_EVER, tmp_path / "out"])
    deadline = monotonic() + 60
    while len(files_below(tmp_path)) < 200 and monotonic() < deadline:
        sleep(0.05)
    process.send_signal(number)
    process.wait(timeout=60)
    assert not (tmp_path / "out").exists()
    left = [path.name for path in tmp_path.iterdir()]
    # Nobody can clean up after that one.
    assert left == [] or (number == signal.SIGKILL and left[0].startswith(".shapeconcepts-"))
