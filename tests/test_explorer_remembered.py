"""What the explorer showed the last time, which never stands in the way of anything."""

import os
from pathlib import Path

import pytest

from shapeconcepts.explorer import remembered
from shapeconcepts.explorer.file_status import file_status
from shapeconcepts.explorer.remembered import Remembered


@pytest.fixture(autouse=True)
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setattr(remembered, "user_cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache" / "explorer"


def test_documents_are_given_back_for_the_same_alone() -> None:
    one = Remembered(["a"])
    one.keep_document("state", "version 1", b"content")
    assert one.document("state", "version 2") is None
    one.close()
    again = Remembered(["a"])
    assert again.document("state", "version 1") == b"content"
    again.keep_document("state", "version 2", b"other")
    assert again.document("state", "version 1") is None and again.document("state", "version 2") == b"other"
    assert Remembered(["b"]).document("state", "version 2") is None


def test_previews_are_given_back_as_long_as_the_file_is_as_it_was(tmp_path: Path) -> None:
    scan = tmp_path / "scan.pcd"
    scan.write_bytes(b"first")
    one = Remembered(["a"])
    one.keep_preview(3, "model", scan, file_status(scan), b"picture")
    assert one.preview(3, "model") == b"picture"
    assert one.preview(4, "model") is None and one.preview(3, "other model") is None
    scan.write_bytes(b"second, and longer")
    assert one.preview(3, "model") is None
    scan.unlink()
    assert one.preview(3, "model") is None


@pytest.mark.parametrize("content", [b"", b"no database", b"SQLite format 3\0" + b"\xff" * 4000])
def test_a_damaged_file_is_made_anew(cache: Path, content: bytes) -> None:
    one = Remembered(["a"])
    one.keep_document("state", "1", b"content")
    one.close()
    [path] = cache.glob("*.sqlite")
    path.write_bytes(content)
    again = Remembered(["a"])
    assert again.document("state", "1") is None
    again.keep_document("state", "1", b"again")
    assert again.document("state", "1") in (b"again", None)


def test_without_a_cache_folder_nothing_is_kept(cache: Path) -> None:
    cache.parent.write_bytes(b"a file")
    one = Remembered(["a"])
    one.keep_document("state", "1", b"content")
    assert one.document("state", "1") is None
    one.close()


def test_the_models_that_nobody_looks_at_are_forgotten(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number, name in enumerate("abc"):
        one = Remembered([name])
        one.keep_document("state", "1", bytes(50_000))
        one.close()
        for path in cache.glob("*.sqlite"):
            if number < 2:
                os.utime(path, (number, number))
    monkeypatch.setattr(remembered, "MOST_BYTES", 150_000)
    Remembered(["d"]).close()
    assert 1 < len(list(cache.glob("*.sqlite"))) < 4
    assert Remembered(["c"]).document("state", "1") is not None
