"""Files that are written together: all or none."""

import os
from pathlib import Path

import pytest

from shapeconcepts.interruption import unfinished
from shapeconcepts.io.atomic_write import write_atomically, written_together


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    return tmp_path / "first", tmp_path / "second"


def content_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_none_appears_before_all_are_written(pair: tuple[Path, Path]) -> None:
    first, second = pair
    first.write_bytes(b"old")
    with written_together():
        write_atomically(first, b"new")
        assert first.read_bytes() == b"old"
        write_atomically(second, b"new")
        assert not second.exists()
    assert content_of(first.parent) == {"first": b"new", "second": b"new"}
    assert not unfinished


@pytest.mark.parametrize(
    "failure", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError()]
)
@pytest.mark.parametrize("was_there", [True, False])
def test_none_changes_if_the_second_cannot_be_written(
    pair: tuple[Path, Path], was_there: bool, failure: BaseException
) -> None:
    first, _ = pair
    if was_there:
        first.write_bytes(b"old")
    with pytest.raises(type(failure)), written_together():
        write_atomically(first, b"new")
        raise failure
    assert content_of(first.parent) == ({"first": b"old"} if was_there else {})
    assert not unfinished


@pytest.mark.parametrize("was_there", [True, False])
@pytest.mark.parametrize("second_names", [True, False])
def test_the_first_is_given_back_if_the_second_finds_no_place(
    pair: tuple[Path, Path], was_there: bool, second_names: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = pair
    if was_there:
        first.write_bytes(b"old")
        first.chmod(0o640)

    def refuse(*arguments: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    if not second_names:
        monkeypatch.setattr(Path, "hardlink_to", refuse)
    with pytest.raises(OSError), written_together():
        write_atomically(first, b"new")
        write_atomically(second, b"new")
        # As late as can be: after it was looked at.
        second.mkdir()
        (second / "in the way").touch()
    assert content_of(first.parent) == ({"first": b"old"} if was_there else {})
    assert sorted(os.listdir(first.parent)) == (["first"] if was_there else []) + ["second"]
    if was_there:
        assert first.stat().st_mode & 0o777 == 0o640
    assert not unfinished


def test_links_lead_to_what_is_written(pair: tuple[Path, Path]) -> None:
    first, second = pair
    second.symlink_to("not there yet")
    with written_together():
        write_atomically(first, b"new")
        write_atomically(second, b"new")
    assert second.is_symlink()
    assert content_of(first.parent) == {"first": b"new", "second": b"new", "not there yet": b"new"}
