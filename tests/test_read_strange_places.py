"""What stands in the place of a scan, a mask or a folder and is none, or must not be read."""

import errno
import json
import os
import socket
from pathlib import Path

import numpy as np
import pytest
from PIL import EpsImagePlugin, Image
from typer.testing import CliRunner

from shapeconcepts.cli import app
from shapeconcepts.datasets import load_labelled, load_oscd, load_osd, load_washington
from shapeconcepts.io import regular_file
from shapeconcepts.scan import ScanError, ScanWarning
from shapeconcepts.sources import find_scan_files, read_scan, read_scans
from shapeconcepts.sources.reader import SCAN_SUFFIXES

POINTS = "0 0 1\n0.1 0 1\n0 0.1 1\n" * 4
EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 640 480\n%%EndComments\n%%EndProlog\nshowpage\n%%EOF\n"


def write_depth(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    depth = np.zeros((480, 640), dtype=np.uint16)
    depth[200:260, 300:380] = 900
    Image.fromarray(depth).save(path)
    return path


def write_scans(folder: Path, n: int = 1) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for index in range(n):
        (folder / f"{index}.xyz").write_text(POINTS)
    return folder


def put(kind: str, path: Path) -> None:
    """Something that is no regular file."""
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "terminal":
        path.symlink_to("/dev/tty")
    elif kind == "folder":
        path.mkdir()
    else:
        # The name of a socket may have no more than about 100 characters.
        here = Path.cwd()
        os.chdir(path.parent)
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(path.name)
        os.chdir(here)


def forbid(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """A folder that cannot be listed; nothing is forbidden to root."""
    real = os.scandir

    def scandir(path: str | Path):
        if Path(path) == folder:
            raise PermissionError(errno.EACCES, "Permission denied", str(folder))
        return real(path)

    monkeypatch.setattr(os, "scandir", scandir)


KINDS = ["pipe", "device", "terminal", "socket", "folder"]
unix = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes and devices")


@unix
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("suffix", [".xyz", ".png", ".npz", ".glb"])
def test_scan_that_is_no_file(tmp_path, kind, suffix):
    put(kind, tmp_path / f"a{suffix}")
    with pytest.raises(ScanError, match=rf"a\{suffix}: is (not a regular file|a folder)"):
        read_scan(tmp_path / f"a{suffix}")


@unix
@pytest.mark.parametrize("kind", KINDS)
def test_mask_that_is_no_file(tmp_path, kind):
    path = write_depth(tmp_path / "a.png")
    put(kind, tmp_path / "mask.png")
    with pytest.raises(ScanError, match=r"the mask .*mask\.png is (not a regular file|a folder)"):
        read_scan(path, mask=tmp_path / "mask.png")


@unix
def test_commands_do_not_wait_for_a_mask_that_is_a_pipe(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    write_depth(tmp_path / "depth" / "a.png")
    (tmp_path / "masks").mkdir()
    os.mkfifo(tmp_path / "masks" / "a.png")
    for command in (["segment"], ["learn", "--model", tmp_path / "m.safetensors", "--jobs", "1"]):
        arguments = [*command, tmp_path / "depth", "--mask", tmp_path / "masks"]
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        assert result.exit_code == 1
        assert "is not a regular file" in " ".join(result.stderr.split())


@unix
def test_file_that_becomes_a_pipe_before_it_is_opened(tmp_path, monkeypatch):
    (tmp_path / "a.xyz").write_text(POINTS)
    before = os.stat(tmp_path / "a.xyz")
    (tmp_path / "a.xyz").unlink()
    os.mkfifo(tmp_path / "a.xyz")
    monkeypatch.setattr(regular_file.os, "stat", lambda path: before)
    with pytest.raises(ScanError, match="is not a regular file"):
        regular_file.read_regular_file(tmp_path / "a.xyz")


@unix
@pytest.mark.parametrize("ending", ["maskcrop.png", "loc.txt"])
def test_washington_with_a_pipe_beside_a_depth_crop(tmp_path, ending):
    folder = tmp_path / "ball" / "ball_1"
    write_depth(folder / "ball_1_1_1_depthcrop.png")
    write_depth(folder / "ball_1_1_1_maskcrop.png")
    (folder / "ball_1_1_1_loc.txt").write_text("1,1")
    (folder / f"ball_1_1_1_{ending}").unlink()
    os.mkfifo(folder / f"ball_1_1_1_{ending}")
    with pytest.raises(ScanError, match="is not a regular file"):
        load_washington(tmp_path)


@pytest.mark.parametrize("name", ["mask.png", "mask.eps", "mask.jpg", "mask"])
def test_mask_of_postscript_starts_no_program(tmp_path, monkeypatch, name):
    def start(*arguments, **options):
        raise AssertionError("Ghostscript was started")

    monkeypatch.setattr(EpsImagePlugin, "Ghostscript", start)
    path = write_depth(tmp_path / "a.png")
    (tmp_path / name).write_bytes(EPS)
    with Image.open(tmp_path / name) as image:
        assert image.format == "EPS", "Pillow would take it"
    with pytest.raises(ScanError, match="is no image that can be read"):
        read_scan(path, mask=tmp_path / name)


@pytest.mark.parametrize("kind", ["ICO", "PCX", "TGA", "WEBP", "PDF", "SGI"])
def test_mask_of_another_format(tmp_path, kind):
    path = write_depth(tmp_path / "a.png")
    Image.new("RGB", (640, 480), "white").save(tmp_path / "mask.png", format=kind)
    with pytest.raises(ScanError, match="is no image that can be read"):
        read_scan(path, mask=tmp_path / "mask.png")


@pytest.mark.parametrize("kind", ["PNG", "BMP", "GIF", "JPEG", "PPM", "TIFF"])
def test_mask_of_a_format_that_is_meant(tmp_path, kind):
    path = write_depth(tmp_path / "a.png")
    image = Image.new("L", (640, 480), "black")
    image.paste("white", (304, 208, 320, 224))
    image.save(tmp_path / "mask", format=kind)
    assert len(read_scan(path, mask=tmp_path / "mask")) == 16 * 16


@pytest.mark.parametrize("name", ["a" * 300, "a/" * 3000 + "b", "a\0b", "\ud800", "file.xyz/b"])
@pytest.mark.parametrize("suffix", [".xyz", ".png", ""])
def test_names_that_no_file_can_have(tmp_path, name, suffix):
    (tmp_path / "file.xyz").write_text(POINTS)
    with pytest.raises(ScanError):
        read_scan(tmp_path / f"{name}{suffix}")
    write_scans(tmp_path / "scans")
    with pytest.warns(ScanWarning):
        assert len(read_scans([tmp_path / "scans", tmp_path / f"{name}{suffix}"])) == 1
    with pytest.raises(ScanError):
        read_scan(write_depth(tmp_path / "a.png"), mask=tmp_path / f"{name}{suffix}")


@pytest.mark.parametrize("suffix", SCAN_SUFFIXES)
def test_links_in_a_circle(tmp_path, suffix):
    (tmp_path / f"a{suffix}").symlink_to(tmp_path / f"b{suffix}")
    (tmp_path / f"b{suffix}").symlink_to(tmp_path / f"a{suffix}")
    with pytest.raises(ScanError, match=rf"a\{suffix}: cannot be read \(Too many levels"):
        read_scan(tmp_path / f"a{suffix}")


@pytest.mark.parametrize("function", ["stat", "open"])
@pytest.mark.parametrize("code", [errno.EACCES, errno.EIO, errno.ENAMETOOLONG, errno.ESTALE, errno.EMFILE])
def test_what_the_system_refuses(tmp_path, monkeypatch, function, code):
    (tmp_path / "a.xyz").write_text(POINTS)

    def refuse(path, *arguments):
        raise OSError(code, os.strerror(code), path)

    # Not os itself: the test runner opens files, too.
    monkeypatch.setattr(regular_file, "os", _Refusing(function, refuse))
    with pytest.raises(ScanError, match=rf"a\.xyz: cannot be read \({os.strerror(code)}\)"):
        read_scan(tmp_path / "a.xyz")


class _Refusing:
    """The module os with another function."""

    def __init__(self, name, function):
        setattr(self, name, function)

    def __getattr__(self, name):
        return getattr(os, name)


def test_file_larger_than_the_memory(tmp_path):
    with (tmp_path / "a.xyz").open("wb") as file:
        try:
            file.truncate(2**62)
        except OSError:
            file.truncate(2**43)
    with pytest.raises(ScanError, match=r"a\.xyz: (is larger than the memory|cannot be read)"):
        read_scan(tmp_path / "a.xyz")


def test_folder_that_cannot_be_listed_is_skipped(tmp_path, monkeypatch):
    write_scans(tmp_path / "scans" / "box", 2)
    hidden = write_scans(tmp_path / "scans" / "can" / "hidden")
    forbid(monkeypatch, hidden)
    with pytest.warns(ScanWarning, match=r"hidden: cannot be listed \(Permission denied\)"):
        scans = read_scans(tmp_path / "scans")
    assert [scan.name for scan in scans] == ["box/0.xyz", "box/1.xyz"]
    assert [str(error) for error in scans.skipped] == [f"{hidden}: cannot be listed (Permission denied)"]
    with pytest.raises(ScanError, match=r"hidden: cannot be listed"):
        read_scans(tmp_path / "scans", strict=True)


@pytest.mark.parametrize("others", [True, False])
def test_given_folder_that_cannot_be_listed(tmp_path, monkeypatch, others):
    forbid(monkeypatch, write_scans(tmp_path / "hidden"))
    sources = [tmp_path / "hidden", *([write_scans(tmp_path / "open")] if others else [])]
    assert len(find_scan_files(sources)) == len(sources)
    if others:
        with pytest.warns(ScanWarning, match="hidden: cannot be listed"):
            assert len(read_scans(sources)) == 1
    else:
        with pytest.raises(ScanError, match="hidden: cannot be listed"):
            read_scans(sources)


def test_commands_report_a_folder_that_cannot_be_listed(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    write_depth(tmp_path / "scans" / "box" / "a.png")
    forbid(monkeypatch, write_scans(tmp_path / "scans" / "can"))
    result = CliRunner().invoke(app, ["segment", str(tmp_path / "scans"), "--json", "--jobs", "1"])
    document = json.loads(result.stdout)
    assert result.exit_code == 0
    assert len(document["scans"]) == 1
    [skipped] = document["skipped"]
    assert skipped["reason"] == f"{tmp_path / 'scans' / 'can'}: cannot be listed (Permission denied)"
    arguments = ["learn", str(tmp_path / "scans" / "can"), "--model", str(tmp_path / "m.safetensors")]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 1
    assert "cannot be listed (Permission denied)" in " ".join(result.stderr.split())


def cloud(label: str = "") -> str:
    fields = ("x y z label", "4 4 4 4", "F F F U") if label else ("x y z", "4 4 4", "F F F")
    header = "FIELDS {}\nSIZE {}\nTYPE {}\n".format(*fields)
    rows = [f"{i % 5 / 100} {i / 100} 1 {label and (i % 2) * 19 + 1}" for i in range(20)]
    return f"{header}WIDTH 20\nHEIGHT 1\nDATA ascii\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    ("load", "name", "label"),
    [
        (load_oscd, "training/can/1.pcd", ""),
        (load_osd, "learn/learn33.pcd", "1"),
        (load_washington, "ball/ball_1/ball_1_1_1.pcd", ""),
        (load_labelled, "training/can/1.pcd", ""),
        (load_labelled, "train/mug/1.pcd", ""),
        (load_labelled, "learn/learn33.pcd", "1"),
        (load_labelled, "ball/ball_1/ball_1_1_1.pcd", ""),
    ],
)
@pytest.mark.filterwarnings("ignore::shapeconcepts.scan.ScanWarning")
def test_data_sets_with_a_folder_that_cannot_be_listed(tmp_path, monkeypatch, load, name, label):
    path = tmp_path / "data" / name
    path.parent.mkdir(parents=True)
    path.write_text(cloud(label))
    expected = load(tmp_path / "data")
    hidden = write_scans(tmp_path / "data" / "hidden" / "more")
    forbid(monkeypatch, hidden)
    found = load(tmp_path / "data")
    assert [(scan.name, scan.label) for scan in found] == [(scan.name, scan.label) for scan in expected]
    assert [str(error) for error in found.skipped] == [f"{hidden}: cannot be listed (Permission denied)"]
