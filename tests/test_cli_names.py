"""The command line where files, labels and concepts are called what nobody would call them."""

import csv
import json
import os
import sys
from io import BytesIO, StringIO, TextIOWrapper
from pathlib import Path

import pytest
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts.cli import app, response_formats
from shapeconcepts.cli.terminal import busy, print_table, progress, say_skipped, table_text
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import ScanError
from shapeconcepts.segmentation import segment_cache

# As bytes: what Linux allows in a name, that is all but a slash and zero.
NAMES = [
    b"\xff\xfe.pcd",
    b"clipboard\x1b]52;c;aGk=\x07.pcd",
    b"line\nWrote other.pcd",
    b"over\rwritten.pcd",
    "turned\u202egnp \u200b.pcd".encode(),
    "one byte\x9b31m.pcd".encode(),
    b"[red]markup[bold] :warning: %s {0}.pcd",
    "K\u00e4se \u8336.pcd".encode(),
]
LABELS = [b"lab\xffel", b"\x1b[31m\n[red]"]
ENCODINGS = ["utf-8", "latin-1", "ascii"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Scans of such names in folders of such names, one of which is none, and a model of them."""
    folder = tmp_path_factory.mktemp("names")
    scans = iter(shapeconcepts.datasets.simulate(len(NAMES), categories=("box", "can")))
    for label in LABELS:
        place = folder / "scans" / os.fsdecode(label)
        place.mkdir(parents=True)
        for name in NAMES:
            write_pcd(place / os.fsdecode(name), next(scans))
    bad = os.fsdecode(LABELS[0] + b"/bad\x1b[2J\xff\n.pcd")
    (folder / "scans" / bad).write_text("\x1b[31m\n")
    outputs = ("--model", folder / "m", "--report", folder / "m.html")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segment_cache, "user_cache_folder", lambda: folder / "cache")
        learned = run("utf-8", "learn", folder / "scans", *outputs)
    assert learned.exit_code == 0, learned.output
    check(learned, "utf-8")
    return folder


def run(encoding: str, *arguments: object):
    """The command in this process, with an output that holds nothing but what its encoding has."""
    return CliRunner(charset=encoding).invoke(app, [str(argument) for argument in arguments])


def check(result, encoding: str) -> None:
    """Nothing on either stream does anything but show."""
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    for stream in (result.stdout_bytes, result.stderr_bytes):
        assert all(line.isprintable() for line in stream.decode(encoding).split("\n"))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    "arguments",
    [
        ["segment", "scans"],
        ["segment", "scans", "--json"],
        ["info", "m"],
        ["info", "m", "--json"],
        ["respond", "m", "scans"],
        ["respond", "m", "scans", "--format", "jsonl"],
        ["explain", "m", os.fsdecode(b"scans/" + LABELS[0] + b"/" + NAMES[0]), "--image", "why.png"],
        ["explain", "m", os.fsdecode(b"scans/" + LABELS[1] + b"/" + NAMES[1]), "--json"],
    ],
    ids=" ".join,
)
def test_output_is_printable_and_encodable(
    folder: Path, arguments: list[str], encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    result = run(encoding, *arguments)
    assert result.exit_code == 0, result.output
    check(result, encoding)


def test_names_in_json_find_their_files(folder: Path) -> None:
    segmented = json.loads(run("ascii", "segment", folder / "scans", "--json").stdout)
    names = [one["name"] for one in segmented["scans"] + segmented["skipped"]]
    assert len(set(names)) == len(LABELS) * len(NAMES) + 1
    assert all((folder / "scans" / name).is_file() for name in names)
    assert {one["label"] for one in segmented["scans"]} == set(map(os.fsdecode, LABELS))
    lines = run("ascii", "respond", folder / "m", folder / "scans", "--format", "jsonl").stdout.splitlines()
    assert {json.loads(line)["scan"] for line in lines} < set(names)
    written = json.loads(run("ascii", "info", folder / "m", "--json").stdout)
    assert {name for one in written["concepts"] for name in one["members"]} <= set(names)


@pytest.mark.parametrize("to_file", [False, True])
def test_csv_holds_every_name(folder: Path, tmp_path: Path, to_file: bool) -> None:
    output = ["--output", tmp_path / "responses.csv"] if to_file else []
    result = run("utf-8", "respond", folder / "m", folder / "scans", "--format", "csv", *output)
    assert result.exit_code == 0, result.stderr
    content = (tmp_path / "responses.csv").read_bytes() if to_file else result.stdout_bytes
    rows = list(csv.DictReader(StringIO(content.decode("utf-8"), newline="")))
    assert len(rows) == len(LABELS) * len(NAMES)
    expected = {os.fsdecode(name).replace("\udcff\udcfe", "\\udcff\\udcfe") for name in NAMES}
    assert {row["scan"].rpartition("/")[2] for row in rows} == expected


def test_csv_does_nothing_to_a_terminal(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(response_formats, "is_terminal", lambda stream: True)
    result = run("utf-8", "respond", folder / "m", folder / "scans", "--format", "csv")
    check(result, "utf-8")


def test_tables_go_to_files_in_utf_8(folder: Path, tmp_path: Path) -> None:
    result = run("ascii", "respond", folder / "m", folder / "scans", "--output", tmp_path / "table")
    assert result.exit_code == 0, result.stderr
    content = (tmp_path / "table").read_bytes().decode("utf-8")
    assert "─" in content and "茶" in content and "\\udcff" in content


def test_reports_are_utf_8(folder: Path) -> None:
    (folder / "m.html").read_bytes().decode("utf-8")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["\x1b[31m\n"], "\\x1b[31m\\n"),
        (["--\x1b[31m"], "--\\x1b[31m"),
        (["segment", "--\x1b[31m"], "--\\x1b[31m"),
        (["segment", "a", "--voxel-size", "\x1b[31m[/]"], "--voxel-size"),
        (["segment", "a", "--intrinsics", "\x1b[31m[/]\udcff"], "--intrinsics"),
        (["segment", "a", "--mask", "\x1b[31m[/]\udcff"], "--mask"),
        (["segment", "\x1b[31m[/]\udcff"], "\\x1b[31m[/]\\udcff"),
        (["learn", "--model", "\x1b[31m\udcff[red]/m"], "\\x1b[31m\\udcff[red]"),
        (["info", "\x1b]0;\x07\udcff"], "\\x1b]0;\\x07\\udcff"),
        (["simulate", "a", "--categories", "\x1b[31m\n"], "--categories"),
        (["evaluate", "--rename", "\x1b[31m\n"], "--rename"),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_errors_are_printable(
    arguments: list[str], named: str, encoding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(encoding, *arguments)
    assert result.exit_code in (1, 2)
    check(result, encoding)
    assert named in result.stderr


def test_a_model_from_elsewhere_is_quoted_printable(tmp_path: Path) -> None:
    description = json.dumps({"format": 999, "written_by": "\x1b]52;c;aGk=\x07\n\udcff"})
    header = json.dumps({"__metadata__": {"shapeconcepts": description}}).encode()
    (tmp_path / "m").write_bytes(len(header).to_bytes(8, "little") + header)
    result = run("utf-8", "info", tmp_path / "m")
    assert result.exit_code == 1
    check(result, "utf-8")
    assert "\\x1b]52;c;aGk=\\x07\\n\\udcff" in result.stderr


def test_a_header_is_quoted_printable(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(b"ply\nformat ascii 1.0\nelement \x1b[31mvertex\x9b\xff 1\nend_header\n")
    result = run("utf-8", "segment", tmp_path / "a.ply")
    assert result.exit_code == 1
    check(result, "utf-8")


class Terminal(TextIOWrapper):
    """Takes all that is written as a terminal does."""

    def __init__(self, encoding: str) -> None:
        super().__init__(BytesIO(), encoding=encoding, errors="backslashreplace", write_through=True)

    def isatty(self) -> bool:
        return True

    @property
    def text(self) -> str:
        return self.buffer.getvalue().decode(self.encoding)  # type: ignore[attr-defined]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_signs_of_life_take_names_as_they_are(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", Terminal(encoding))
    name = "[red]a[/] \x1b]0;b\x07 \udcff [/]"
    assert list(progress("ab", 2, name)) == ["a", "b"]
    with busy(name):
        pass
    assert sys.stderr.text.count("[red]a[/] \\x1b]0;b\\x07 \\udcff [/]") >= 2
    assert "\x1b]0" not in sys.stderr.text


def test_tables_at_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(sys, "stdout", Terminal("utf-8"))
    print_table(["[b]t[/]", "\x1b[2J"], [["[/]", ":warning:\n\x07"], ["\x1b]52;c;aGk=\x07", "\x9b31m"]])
    for shown in ("[b]t[/]", "\\x1b[2J", "[/]", ":warning:\\n\\x07", "\\x1b]52;c;aGk=\\x07", "\\x9b31m"):
        assert shown in sys.stdout.text
    for raw in ("\x1b[2J", "\x1b]", "\x07", "\x9b"):
        assert raw not in sys.stdout.text


def test_columns_stay_columns_where_characters_are_escaped() -> None:
    lines = table_text(["a", "b"], [["茶", "x"], ["-", "x"]], "ascii").splitlines()
    lines[1:] = [line for line in lines if "x" in line]
    assert lines[1].index("x") == lines[2].index("x")
    assert table_text(["a"], [["b"]], "latin-1").isascii()


def test_messages_about_a_scan_name_it_once(capsys: pytest.CaptureFixture[str]) -> None:
    say_skipped([("a\n.pcd", str(ScanError("folder/a\n.pcd: is empty")))], 2)
    assert capsys.readouterr().err == "Skipped 1 of 2 scans:\n  folder/a\\n.pcd: is empty\n"
