"""Folders, lists of files, labels, and what happens to files that cannot be read."""

import os
import warnings

import numpy as np
import pytest

from shapeconcepts.scan import Scan, ScanError, ScanWarning
from shapeconcepts.sources import ScanList, find_scan_files, iter_scans, read_scan, read_scans, reader

ROWS = [[0, 0, 1], [0.1, 0, 1]] * 6
TEXT = "0 0 1\n0.1 0 1\n" * 6


def make(path, text=TEXT):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_folder_of_category_folders_in_natural_order(tmp_path):
    for name in ("can/view10.xyz", "can/view2.xyz", "box/a/1.xyz", "box/b.txt", "box/B.XYZ", "top.csv"):
        make(tmp_path / name)
    scans = read_scans(tmp_path)
    assert [(scan.name, scan.label) for scan in scans] == [
        ("box/B.XYZ", "box"),
        ("box/a/1.xyz", "box"),
        ("box/b.txt", "box"),
        ("can/view2.xyz", "can"),
        ("can/view10.xyz", "can"),
        ("top.csv", None),
    ]
    assert isinstance(scans, ScanList)
    assert scans.skipped == []
    np.testing.assert_array_equal(scans[0].points, ROWS)


def test_flat_folder_has_no_labels(tmp_path):
    for name in ("10.xyz", "9.xyz", "readme.md", ".hidden.xyz", ".git/1.xyz", "photo.jpg"):
        make(tmp_path / name)
    assert [(scan.name, scan.label) for scan in read_scans(str(tmp_path))] == [
        ("9.xyz", None),
        ("10.xyz", None),
    ]


def test_one_file_and_several(tmp_path):
    a, b = make(tmp_path / "a.xyz"), make(tmp_path / "b.xyz")
    make(tmp_path / "more/can/c.xyz")
    assert [scan.name for scan in read_scans(a)] == [str(a)]
    assert [(scan.name, scan.label) for scan in read_scans([str(b), a, tmp_path / "more"])] == [
        (str(b), None),
        (str(a), None),
        ("can/c.xyz", "can"),
    ]


def test_linked_folders_count_and_circles_end(tmp_path):
    make(tmp_path / "elsewhere/1.xyz")
    make(tmp_path / "data/box/2.xyz")
    os.symlink(tmp_path / "elsewhere", tmp_path / "data/can")
    os.symlink(tmp_path / "data", tmp_path / "data/box/again")
    assert [(scan.name, scan.label) for scan in read_scans(tmp_path / "data")] == [
        ("box/2.xyz", "box"),
        ("can/1.xyz", "can"),
    ]


def test_a_bad_scan_is_reported_and_left_out(tmp_path):
    for i in range(20):
        make(tmp_path / f"{i}.xyz")
    for i in (3, 12, 13, 14):
        make(tmp_path / f"{i}.xyz", "this is no scan\nat all\n")
    with pytest.warns(ScanWarning, match=r"4 of 20 scans are left out: .*3\.xyz: .*\.\.\.") as caught:
        scans = read_scans(tmp_path)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert len(scans) == 16
    assert all(isinstance(error, ScanError) for error in scans.skipped)
    named = [str(error).partition(": ")[0] for error in scans.skipped]
    assert named == [str(tmp_path / f"{i}.xyz") for i in (3, 12, 13, 14)]
    with pytest.raises(ScanError, match=r"/3\.xyz: "):
        read_scans(tmp_path, strict=True)


def test_missing_file_among_others(tmp_path):
    good = make(tmp_path / "good.xyz")
    with pytest.warns(ScanWarning, match=r"ghost\.pcd: there is no such file"):
        scans = read_scans([good, tmp_path / "ghost.pcd"])
    assert len(scans) == 1


def test_nothing_readable_is_an_error(tmp_path):
    with pytest.raises(ScanError, match="no file or folder"):
        read_scans([])
    with pytest.raises(ScanError, match="holds no scans"):
        read_scans(tmp_path)
    with pytest.raises(ScanError, match=r"ghost: there is no such file"):
        read_scans(tmp_path / "ghost")
    make(tmp_path / "1.xyz", "x\n")
    make(tmp_path / "2.xyz", "x\n")
    with pytest.raises(ScanError, match=r"1\.xyz: .*1 other file"):
        read_scans(tmp_path)


def test_iter_scans_gives_one_result_a_file(tmp_path):
    make(tmp_path / "can/1.xyz")
    make(tmp_path / "can/2.xyz", "")
    make(tmp_path / "can/3.npy", "x")
    files = find_scan_files(tmp_path)
    assert [file.path for file in files] == [tmp_path / f"can/{name}" for name in ("1.xyz", "2.xyz", "3.npy")]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        results = list(iter_scans(files))
    assert [type(result) for result in results] == [Scan, ScanError, ScanError]
    assert results[0].label == "can"


def test_options_reach_the_reader(tmp_path):
    make(tmp_path / "1.xyz")
    assert read_scans(tmp_path)[0].viewpoint is not None
    assert read_scans(tmp_path, viewpoint=None)[0].viewpoint is None
    with pytest.raises(ValueError, match="depth_scale"):
        read_scans(tmp_path, depth_scale=-1)


def test_what_is_no_file(tmp_path):
    with pytest.raises(ScanError, match="folder"):
        read_scan(tmp_path)
    with pytest.raises(ScanError, match=r"ghost\.pcd: there is no such file"):
        read_scan(tmp_path / "ghost.pcd")
    with pytest.raises(ScanError, match=r"a\.jpg: the format \.jpg is not known"):
        read_scan(make(tmp_path / "a.jpg"))
    with pytest.raises(ScanError, match="without a suffix"):
        read_scan(make(tmp_path / "scan"))
    with pytest.raises(ScanError, match=r"a\.pcd: is empty"):
        read_scan(make(tmp_path / "a.pcd", ""))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_pipe_does_not_hang(tmp_path):
    os.mkfifo(tmp_path / "pipe.pcd")
    with pytest.raises(ScanError, match="regular file"):
        read_scan(tmp_path / "pipe.pcd")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="nothing is forbidden to root")
def test_forbidden_file(tmp_path):
    make(tmp_path / "a.xyz").chmod(0)
    with pytest.raises(ScanError, match=r"a\.xyz: cannot be read"):
        read_scan(tmp_path / "a.xyz")


def test_shared_folders(shared_data):
    for folder, n, n_labels in (("seven_shapes", 462, 7), ("restaurant_views", 480, 8)):
        scans = read_scans(shared_data / folder)
        assert len(scans) == n
        assert len({scan.label for scan in scans}) == n_labels
        known = [scan.viewpoint is not None for scan in scans]
        assert all(known) if folder == "seven_shapes" else not any(known)


def test_a_hole_in_a_reader_costs_one_file(tmp_path, monkeypatch):
    make(tmp_path / "1.xyz")
    make(tmp_path / "2.off")
    hole = ZeroDivisionError("nobody thought of it")

    def read(data):
        raise hole

    monkeypatch.setitem(reader._READERS, ".off", read)
    with pytest.warns(ScanWarning, match=r"2\.off: .*ZeroDivisionError: nobody thought of it"):
        scans = read_scans(tmp_path)
    assert len(scans) == 1
    assert scans.skipped[0].__cause__ is hole


def test_a_file_that_needs_too_much_memory_is_skipped(tmp_path, monkeypatch):
    def read(data):
        raise MemoryError

    make(tmp_path / "1.xyz")
    make(tmp_path / "2.off")
    monkeypatch.setitem(reader._READERS, ".off", read)
    with pytest.warns(ScanWarning, match=r"2\.off: needs more memory than there is to be read"):
        assert len(read_scans(tmp_path)) == 1


def test_an_interrupt_passes(tmp_path, monkeypatch):
    def read(data):
        raise KeyboardInterrupt

    monkeypatch.setitem(reader._READERS, ".off", read)
    with pytest.raises(KeyboardInterrupt):
        read_scans(make(tmp_path / "1.off"))
