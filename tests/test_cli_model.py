"""`shapeconcepts respond`, `explain` and `info` as a user types them."""

import csv
import json
import subprocess
import sys
from collections.abc import Callable, Iterable
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.sparse import csr_matrix
from typer.testing import CliRunner

import shapeconcepts
from shapeconcepts import MotifHierarchyEnsemble
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan

COMMAND = Path(sys.executable).with_name("shapeconcepts")
CATEGORIES = ("ball", "box", "can")


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Training scans, a model of them, and new scans with a letter among them."""
    folder = tmp_path_factory.mktemp("learned")
    training = shapeconcepts.datasets.simulate(8, categories=CATEGORIES)
    for part, scans in (
        ("training", training),
        ("new", shapeconcepts.datasets.simulate(3, categories=CATEGORIES, random_state=5)),
    ):
        for scan in scans:
            path = folder / part / str(scan.label) / f"{scan.name}.pcd"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_pcd(path, scan)
    (folder / "new" / "letter.pcd").write_text("Dear reader, this is no point cloud.\n")
    model = shapeconcepts.ShapeConceptModel().fit(shapeconcepts.read_scans(folder / "training"))
    assert len(model.concepts_) >= 2
    model.save(folder / "m.safetensors")
    return folder


@pytest.fixture
def model_file(folder: Path, tmp_path: Path) -> Path:
    """A copy that a test may change."""
    path = tmp_path / "m.safetensors"
    path.write_bytes((folder / "m.safetensors").read_bytes())
    return path


def expected(folder: Path, model_file: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names, responses and predictions of the new scans by the Python interface."""
    model = shapeconcepts.load_model(model_file)
    with pytest.warns(shapeconcepts.ScanWarning):
        scans = shapeconcepts.read_scans(folder / "new")
    return [scan.name for scan in scans], model.transform(scans), model.predict(scans)


def in_words(number: int) -> str:
    return "unknown" if number < 0 else str(number)


def read_csv(text: str) -> tuple[list[str], list[list[str]]]:
    titles, *rows = csv.reader(StringIO(text))
    return titles, rows


def test_respond_as_typed(folder: Path, tmp_path: Path) -> None:
    result = subprocess.run(
        [COMMAND, "respond", folder / "m.safetensors", folder / "new", "--format", "csv"],
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert result.returncode == 0, result.stderr
    names, responses, predictions = expected(folder, folder / "m.safetensors")
    titles, rows = read_csv(result.stdout)
    assert titles == [
        "scan",
        "label",
        "concept",
        "p_value",
        *(f"concept{k}" for k in range(responses.shape[1])),
    ]
    assert [row[0] for row in rows] == names
    assert [row[1] for row in rows] == [name.split("/")[0] for name in names]
    assert [row[2] for row in rows] == list(map(in_words, predictions))
    values = np.array([[float(value or "nan") for value in row[4:]] for row in rows])
    np.testing.assert_array_equal(values, responses)
    assert all(0 < float(row[3]) <= 1 for row in rows)
    assert result.stderr.startswith("Skipped 1 of 10 scans:\n")
    assert "letter.pcd" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_json_lines(folder: Path) -> None:
    result = run("respond", folder / "m.safetensors", folder / "new", "--format", "jsonl")
    names, responses, predictions = expected(folder, folder / "m.safetensors")
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [line["scan"] for line in lines] == names
    assert [line["number"] for line in lines] == predictions.tolist()
    assert [line["concept"] for line in lines] == list(map(in_words, predictions))
    values = [[np.nan if v is None else v for v in line["responses"].values()] for line in lines]
    np.testing.assert_array_equal(values, responses)


def test_the_table_holds_the_same(folder: Path, tmp_path: Path) -> None:
    result = run("respond", folder / "m.safetensors", folder / "new")
    assert result.exit_code == 0
    names, responses, predictions = expected(folder, folder / "m.safetensors")
    rows = [line.split() for line in result.stdout.splitlines() if ".pcd" in line]
    assert [row[0] for row in rows] == names
    assert [row[2] for row in rows] == list(map(in_words, predictions))
    for row, values in zip(rows, responses, strict=True):
        assert row[4:] == [f"{value:.3g}" for value in values if value == value]
    written = run("respond", folder / "m.safetensors", folder / "new", "--output", tmp_path / "table.txt")
    assert written.stdout == ""
    assert (tmp_path / "table.txt").read_text() == result.stdout


def test_a_table_of_many_concepts_shows_the_nearest(
    folder: Path, model_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shapeconcepts.cli.response_formats._MOST_COLUMNS", 1)
    monkeypatch.setattr("shapeconcepts.cli.response_formats._NEAREST", 1)
    run("info", model_file, "--name", "0=round things")
    result = run("respond", model_file, folder / "new")
    _, responses, _ = expected(folder, model_file)
    rows = [line for line in result.stdout.splitlines() if ".pcd" in line]
    for row, values in zip(rows, responses, strict=True):
        if not np.isnan(values).any():
            nearest = int(values.argmin())
            name = "round things" if nearest == 0 else f"concept{nearest}"
            assert row.rstrip().endswith(f"{name} {values[nearest]:.3g}")


def test_a_scan_without_a_stimulus_is_unknown(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(self: MotifHierarchyEnsemble, scans: Iterable[object]) -> csr_matrix:
        return csr_matrix((len(list(scans)), len(self.columns_)))

    monkeypatch.setattr(MotifHierarchyEnsemble, "transform", nothing)
    arguments = ("respond", folder / "m.safetensors", folder / "new" / "can" / "can_0.pcd")
    line = json.loads(run(*arguments, "--format", "jsonl").stdout)
    assert line["number"] == -1
    assert line["concept"] == "unknown"
    assert set(line["responses"].values()) == {None}
    _, [row] = read_csv(run(*arguments, "--format", "csv").stdout)
    assert row[2] == "unknown"
    assert set(row[4:]) == {""}
    assert run(*arguments).stdout.split()[-2] == "unknown"


def test_output_goes_to_a_file_whole_or_not_at_all(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "responses.csv"
    arguments = ("respond", folder / "m.safetensors", folder / "new", "--format", "csv")
    result = run(*arguments, "--output", output)
    assert result.stdout == ""
    assert f"Wrote {output}" in result.stderr
    assert output.read_text() == run(*arguments).stdout

    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    before = output.read_bytes()
    monkeypatch.setattr("shapeconcepts.cli.respond_command._responses", interrupted)
    stopped = run(*arguments, "--output", output)
    assert stopped.exit_code == 130
    assert stopped.stderr == "Interrupted\n"
    assert output.read_bytes() == before
    assert list(tmp_path.iterdir()) == [output]


def test_responses_do_not_depend_on_jobs(folder: Path) -> None:
    arguments = ("respond", folder / "m.safetensors", folder / "new", "--format", "jsonl")
    assert run(*arguments, "--jobs", 2).stdout == run(*arguments, "--jobs", 1).stdout


def test_strict_responses_stop_at_the_first_bad_scan(folder: Path) -> None:
    letter = folder / "new" / "letter.pcd"
    result = run("respond", folder / "m.safetensors", letter, folder / "new", "--strict")
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr.startswith(f"Error: {letter}")
    assert len(result.stderr.splitlines()) == 1


def test_no_response_is_a_failure(folder: Path) -> None:
    result = run("respond", folder / "m.safetensors", folder / "new" / "letter.pcd")
    assert result.exit_code == 1
    assert "Skipped 1 of 1 scans" in result.stderr


def test_parquet_needs_a_file_and_pyarrow(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ("respond", folder / "m.safetensors", folder / "new", "--format", "parquet")
    assert run(*arguments).exit_code == 2
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = run(*arguments, "--output", tmp_path / "r.parquet")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: parquet needs the package pyarrow, which is not installed: pip install pyarrow\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_parquet(folder: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")
    output = tmp_path / "r.parquet"
    result = run(
        "respond", folder / "m.safetensors", folder / "new", "--format", "parquet", "--output", output
    )
    assert result.exit_code == 0, result.stderr
    names, responses, predictions = expected(folder, folder / "m.safetensors")
    columns = parquet.read_table(BytesIO(output.read_bytes())).to_pydict()
    assert columns["scan"] == names
    assert columns["concept"] == list(map(in_words, predictions))
    for k, column in enumerate(responses.T):
        values = [np.nan if value is None else value for value in columns[f"concept{k}"]]
        np.testing.assert_array_equal(values, column)


def test_explain(folder: Path) -> None:
    scan = folder / "new" / "can" / "can_0.pcd"
    result = run("explain", folder / "m.safetensors", scan, "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    model = shapeconcepts.load_model(folder / "m.safetensors")
    explanation = model.explain(shapeconcepts.read_scan(scan))
    assert document["number"] == model.predict([shapeconcepts.read_scan(scan)])[0]
    assert [motif["name"] for motif in document["motifs"]] == [motif.name for motif in explanation.motifs]
    first, truth = document["motifs"][0], explanation.motifs[0]
    assert first["stimulus"] == truth.stimulus
    assert [one["scan"] for one in first["closest"]] == [one.object_name for one in truth.closest]

    text = run("explain", folder / "m.safetensors", scan).stdout
    assert text.startswith(f"{scan}: ")
    assert truth.closest[0].object_name in text
    assert "\nIts only surface reminds of training scans:" in text
    box = folder / "new" / "box" / "box_0.pcd"
    explanation = model.explain(shapeconcepts.read_scan(box))
    assert explanation.n_constellations > 1
    text = run("explain", folder / "m.safetensors", box).stdout
    assert f"\n{len(explanation.motifs)} of its {explanation.n_constellations} combinations of " in text


def test_explanation_as_a_picture(folder: Path, tmp_path: Path) -> None:
    scan = folder / "new" / "can" / "can_0.pcd"
    pictures = []
    for name, options in (("names", []), ("scans", ["--training-data", folder / "training"])):
        image = tmp_path / f"{name}.png"
        result = run("explain", folder / "m.safetensors", scan, "--image", image, *options)
        assert result.exit_code == 0, result.stderr
        assert f"Wrote {image}" in result.stderr
        with Image.open(image) as picture:
            pictures.append(np.asarray(picture.convert("RGB"), dtype=int))
    blue = [(picture[..., 2] - picture[..., 0] > 60).mean() for picture in pictures]
    assert blue[1] > blue[0] + 0.01, "prototypes are drawn in blue"
    other = run(
        "explain", folder / "m.safetensors", scan, "--image", image, "--training-data", folder / "new"
    )
    assert other.exit_code == 1
    assert "which the model was learned from, is not there" in other.stderr


def test_explain_an_object_of_a_scene(folder: Path, tmp_path: Path) -> None:
    can, box = shapeconcepts.datasets.simulate(1, categories=["can", "box"], random_state=5)
    labels = np.repeat([1, 20, 31], [50, len(can), len(box)])
    points = np.concatenate([np.ones((50, 3)), can.points, box.points])
    path = tmp_path / "learn3.pcd"
    write_pcd(path, Scan(points, point_labels=labels))
    undecided = run("explain", folder / "m.safetensors", path)
    assert undecided.exit_code == 1
    assert undecided.stderr.endswith("choose one of its objects with --object: 2, 3\n")
    document = json.loads(run("explain", folder / "m.safetensors", path, "--object", 3, "--json").stdout)
    assert document["scan"] == "learn3/3"
    missing = run("explain", folder / "m.safetensors", path, "--object", 4)
    assert missing.exit_code == 1
    single = run("explain", folder / "m.safetensors", folder / "new/can/can_0.pcd", "--object", 2)
    assert "--object is for scenes" in single.stderr


def test_info(folder: Path) -> None:
    model = shapeconcepts.load_model(folder / "m.safetensors")
    result = run("info", folder / "m.safetensors")
    assert result.exit_code == 0
    assert "24 scans" in result.stdout and f"; {model.stimuli_.shape[1]} prototypes\n" in result.stdout
    assert "descriptor surflet" in result.stdout
    for concept in model.concepts_:
        assert model.scan_names_[concept.medoid] in result.stdout
    document = json.loads(run("info", folder / "m.safetensors", "--json").stdout)
    assert [one["size"] for one in document["concepts"]] == [concept.size for concept in model.concepts_]
    assert document["parameters"]["ensemble__bandwidth"] == 0.1


def test_concepts_get_names(folder: Path, model_file: Path) -> None:
    result = run("info", model_file, "--name", "0=tin cans", "--name", "1 = b=1")
    assert result.exit_code == 0, result.stderr
    assert "tin cans" in result.stdout
    model = shapeconcepts.load_model(model_file)
    assert [concept.name for concept in model.concepts_][:2] == ["tin cans", "b=1"]
    titles, rows = read_csv(run("respond", model_file, folder / "training", "--format", "csv").stdout)
    assert titles[4:6] == ["tin cans", "b=1"]
    _, numbers = read_csv(
        run("respond", folder / "m.safetensors", folder / "training", "--format", "csv").stdout
    )
    called = {"0": "tin cans", "1": "b=1"}
    assert [row[2] for row in rows] == [called.get(row[2], row[2]) for row in numbers]
    assert run("info", model_file, "--name", "0=").exit_code == 0
    assert shapeconcepts.load_model(model_file).concepts_[0].name == ""


@pytest.mark.parametrize(
    "names", [["99=a"], ["a=b"], ["0"], ["-1=a"], ["0=7"], ["0=unknown"], ["0=a", "1=a"], ["0=a\nb"]]
)
def test_names_that_mean_nothing(model_file: Path, names: list[str]) -> None:
    before = model_file.read_bytes()
    result = run("info", model_file, *(part for name in names for part in ("--name", name)))
    assert result.exit_code == 2
    assert "--name" in result.stderr
    assert model_file.read_bytes() == before


def truncated(content: bytes) -> bytes:
    return content[: len(content) // 2]


@pytest.mark.parametrize("command", [["info"], ["respond", "scan.pcd"], ["explain", "scan.pcd"]])
@pytest.mark.parametrize("damage", [truncated, lambda _: b"", lambda _: b"Dear reader, no model.", None])
def test_a_bad_model_file(
    folder: Path,
    tmp_path: Path,
    command: list[str],
    damage: Callable[[bytes], bytes] | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "bad.safetensors"
    if damage is not None:
        path.write_bytes(damage((folder / "m.safetensors").read_bytes()))
    write_pcd(tmp_path / "scan.pcd", shapeconcepts.datasets.simulate(1, categories=["can"])[0])
    result = run(command[0], path, *command[1:])
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr.startswith("Error: ")
    assert "bad.safetensors" in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["respond", "m"], "Missing argument"),
        (["respond", "m", "a.pcd", "--format", "xml"], "--format"),
        (["respond", "m", "a.pcd", "--output", "none/r.csv"], "does not exist"),
        (["respond", "m", "a.pcd", "--jobs", "0"], "--jobs"),
        (["explain", "m"], "Missing argument"),
        (["explain", "m", "."], "is a folder"),
        (["explain", "m", "a.pcd", "--image", "a.doc"], "picture format"),
        (["explain", "m", "a.pcd", "--training-data", "."], "add --image"),
        (["info"], "Missing argument"),
    ],
)
def test_usage_errors(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.replace("│", "").split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["learn", "respond", "explain", "info"])
def test_every_command_explains_itself(command: str) -> None:
    manual = " ".join(run(command, "--help").output.split())
    assert f"shapeconcepts {command} " in manual
    assert "Examples" in manual
