"""`export`: the scans of a model, with their concepts, as data sets that others read."""

import csv
import json
import os
import weakref
from collections import Counter
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import shapeconcepts as sc
from shapeconcepts import Scan, ScanError, ShapeConceptModel
from shapeconcepts.cli import app
from shapeconcepts.export import LAYOUTS, export_scans
from shapeconcepts.io.whole_folder import FolderInMaking
from shapeconcepts.io.write_pcd import write_pcd

FOLDERS = [layout for layout in LAYOUTS if layout not in ("csv", "parquet")]
FAR = np.array([400_000.0, 5_000_000.0, 100.0])


def run(*arguments: object):
    """The command in this process."""
    return CliRunner().invoke(app, ["export", *(str(argument) for argument in arguments)])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Scans, one of them far away, and a model of them of which one concept has a name."""
    folder = tmp_path_factory.mktemp("export")
    for scan in sc.datasets.simulate(6, categories=("ball", "box", "can")):
        path = folder / "scans" / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    one = sc.datasets.simulate_scan("ball", 7)
    np.savez(folder / "scans/ball/far.npz", points=one.points + FAR)
    model = ShapeConceptModel().fit(sc.read_scans(folder / "scans"))
    assert len(model.concepts_) >= 2
    model.concepts_[0].name = "../Kanten / edges\x1b"
    model.save(folder / "m.safetensors")
    return folder


@pytest.fixture(scope="module")
def model(folder: Path) -> ShapeConceptModel:
    return sc.load_model(folder / "m.safetensors")


def index_of(out: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(StringIO((out / "index.csv").read_text(encoding="utf-8"))))


def content_of(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def check_rows(rows: list[dict[str, str]], model: ShapeConceptModel) -> None:
    """A row each, as the model has them, the most typical ones first."""
    row_of = {name: row for row, name in enumerate(model.scan_names_)}
    assert sorted(one["name"] for one in rows) == sorted(model.scan_names_)
    responses = model.response_.transform(model.stimuli_)
    order = [(int(one["concept"]) % (len(model.concepts_) + 1), int(one["rank"] or 0)) for one in rows]
    assert order == sorted(order)
    for one in rows:
        row, number = row_of[one["name"]], int(one["concept"])
        assert number == model.labels_[row] and one["label"] == model.scan_labels_[row]
        assert 0 < float(one["p_value"]) <= 1
        if number < 0:
            assert (one["key"], one["class"], one["rank"], one["response"]) == ("-1", "none", "", "")
            continue
        concept = model.concepts_[number]
        assert int(one["key"]) == concept.key and one["concept_name"] == concept.name
        assert float(one["response"]) == responses[row, number]
        assert (one["is_medoid"] == "true") == (row == concept.medoid) == (one["rank"] == "0")


def test_p_values_of_training_scans_are_their_ranks(model: ShapeConceptModel) -> None:
    p_values, distances = model.training_p_values(), model.novelty_.distances
    assert p_values is not None
    expected = [(distances >= one).sum() / len(distances) for one in distances]
    np.testing.assert_array_equal(p_values, expected)


def test_folders_hold_the_files_themselves(folder: Path, model: ShapeConceptModel, tmp_path: Path) -> None:
    exported = export_scans(model, tmp_path / "out", scans=folder / "scans")
    rows = index_of(tmp_path / "out")
    assert exported.n_written == len(rows) == len(model.scan_names_)
    assert exported.missing == exported.skipped == ()
    check_rows(rows, model)
    for one in rows:
        copied = tmp_path / "out" / one["file"]
        assert copied.read_bytes() == (folder / "scans" / one["name"]).read_bytes()
        assert one["origin_x"] == "0.0"
    files = set(content_of(tmp_path / "out")) - {"index.csv"}
    assert files == {one["file"] for one in rows}
    first = sorted(name for name in files if name.startswith("_Kanten _ edges_/"))[0]
    assert first.startswith("_Kanten _ edges_/000_")
    assert first.endswith(model.scan_names_[model.concepts_[0].medoid].rpartition("/")[2])


@pytest.mark.parametrize("layout", FOLDERS)
def test_each_layout_is_the_same_to_the_last_bit(
    folder: Path, model: ShapeConceptModel, tmp_path: Path, layout: str
) -> None:
    for name in ("first", "second"):
        export_scans(model, tmp_path / name, layout, scans=folder / "scans")
    check_rows(index_of(tmp_path / "first"), model)
    assert content_of(tmp_path / "first") == content_of(tmp_path / "second")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["first", "second"]


def test_a_table_needs_no_scans(folder: Path, model: ShapeConceptModel, tmp_path: Path) -> None:
    exported = export_scans(model, tmp_path / "scans.csv", "csv")
    rows = list(csv.DictReader((tmp_path / "scans.csv").open(encoding="utf-8", newline="")))
    check_rows(rows, model)
    assert exported.n_written == len(rows) and exported.missing == ()
    assert {one["path"] for one in rows} == {""}
    export_scans(model, tmp_path / "scans.csv", "csv", scans=folder / "scans", force=True)
    rows = list(csv.DictReader((tmp_path / "scans.csv").open(encoding="utf-8", newline="")))
    assert all(Path(one["path"]) == folder / "scans" / one["name"] for one in rows)


def test_parquet_is_the_same_table(model: ShapeConceptModel, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    export_scans(model, tmp_path / "scans.parquet", "parquet")
    export_scans(model, tmp_path / "scans.csv", "csv")
    table = parquet.read_table(tmp_path / "scans.parquet").to_pylist()
    rows = list(csv.DictReader((tmp_path / "scans.csv").open(encoding="utf-8", newline="")))
    assert [{key: as_text(value) for key, value in one.items()} for one in table] == rows


def as_text(value: object) -> str:
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


def test_semantic_kitti_as_its_kit_reads_it(folder: Path, model: ShapeConceptModel, tmp_path: Path) -> None:
    export_scans(model, tmp_path / "out", "semantic-kitti", scans=folder / "scans")
    rows, sequence = index_of(tmp_path / "out"), tmp_path / "out/sequences/00"
    frames = sorted(path.stem for path in (sequence / "velodyne").iterdir())
    assert frames == [f"{number:06d}" for number in range(len(rows))]
    for one in rows:
        points = np.fromfile(tmp_path / "out" / one["file"], np.float32).reshape(-1, 4)
        labels = np.fromfile(sequence / "labels" / f"{Path(one['file']).stem}.label", np.uint32)
        assert len(points) == len(labels) and not points[:, 3].any()
        key = int(one["key"])
        assert np.unique(labels & 0xFFFF).tolist() == [key + 1]
        assert np.unique(labels >> 16).tolist() == [int(key >= 0)]
        scan = sc.read_scan(folder / "scans" / one["name"])
        origin = [float(one[f"origin_{axis}"]) for axis in "xyz"]
        np.testing.assert_allclose(points[:, :3] + origin, scan.points, atol=1e-4)
    text = (tmp_path / "out/semantic-kitti.yaml").read_text(encoding="utf-8")
    assert '  1: "../Kanten / edges\\U0000001b"\n' in text


def test_label_cloud_has_a_box_around_each_scan(
    folder: Path, model: ShapeConceptModel, tmp_path: Path
) -> None:
    export_scans(model, tmp_path / "out", "labelcloud", scans=folder / "scans")
    classes = json.loads((tmp_path / "out/labels/_classes.json").read_text())
    assert {one["id"]: one["name"] for one in classes["classes"]} == {
        0: "none",
        **{one.key + 1: one.name or f"concept{number}" for number, one in enumerate(model.concepts_)},
    }
    for one in index_of(tmp_path / "out"):
        cloud = tmp_path / "out" / one["file"]
        label = json.loads((tmp_path / "out/labels" / f"{cloud.stem}.json").read_text())
        assert label["folder"] == "pointclouds" and label["filename"] == cloud.name
        [box] = label["objects"]
        assert box["name"] == one["class"] and box["rotations"]["x"] == box["rotations"]["y"] == 0
        points = sc.read_scan(cloud).points - [box["centroid"][axis] for axis in "xyz"]
        yaw = box["rotations"]["z"]
        turned = points @ np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        half = np.array([box["dimensions"][edge] for edge in ("length", "width", "height")]) / 2
        assert (np.abs(turned) <= half + 1e-6).all()
        np.testing.assert_allclose(np.abs(turned).max(axis=0), half, atol=1e-5)


def test_fiftyone_has_a_sample_and_a_scene_each(
    folder: Path, model: ShapeConceptModel, tmp_path: Path
) -> None:
    export_scans(model, tmp_path / "out", "fiftyone", scans=folder / "scans")
    samples = json.loads((tmp_path / "out/samples.json").read_text())["samples"]
    fields = {
        one["db_field"] for one in json.loads((tmp_path / "out/metadata.json").read_text())["sample_fields"]
    }
    for one, row in zip(samples, index_of(tmp_path / "out"), strict=True):
        assert set(one) <= fields
        assert one["filepath"] == row["file"] and one["concept"]["label"] == row["class"]
        assert one["p_value"] == float(row["p_value"]) and 0 < one["_rand"] < 1
        scene = json.loads((tmp_path / "out" / row["file"]).read_text())
        assert (tmp_path / "out/data" / scene["children"][0]["pcdPath"]).is_file()


def test_a_recording_for_rerun_can_be_read_again(
    folder: Path, model: ShapeConceptModel, tmp_path: Path
) -> None:
    pytest.importorskip("rerun")
    chunk = pytest.importorskip("rerun.chunk")
    exported = export_scans(model, None, scans=folder / "scans", rerun=tmp_path / "scans.rrd")
    assert exported.n_written == len(model.scan_names_)
    assert [path.name for path in tmp_path.iterdir()] == ["scans.rrd"]
    n_rows: Counter[str] = Counter()
    for one in chunk.RrdReader(tmp_path / "scans.rrd").stream():
        n_rows[one.entity_path] += one.num_rows
    assert n_rows["/scan/segments"] == n_rows["/concept"] == n_rows["/p-value"] == len(model.scan_names_)
    assert n_rows["/responses/concept1"] > 0


def test_what_is_not_installed_is_said(
    folder: Path, model: ShapeConceptModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shapeconcepts.export.checks.find_spec", lambda module: None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "shapeconcepts\[parquet\]"'):
        export_scans(model, tmp_path / "out.parquet", "parquet")
    result = run(folder / "m.safetensors", "--rerun", tmp_path / "a.rrd", "--scans", folder / "scans")
    assert result.exit_code == 1 and 'pip install "shapeconcepts[rerun]"' in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_what_is_missing_or_bad_is_told(folder: Path, model: ShapeConceptModel, tmp_path: Path) -> None:
    for name in model.scan_names_[1:]:
        (tmp_path / "scans" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "scans" / name).write_bytes((folder / "scans" / name).read_bytes())
    (tmp_path / "scans" / model.scan_names_[2]).write_text("Dear reader\n")
    arguments = (folder / "m.safetensors", tmp_path / "out", "--scans", tmp_path / "scans", "--json")
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["n_written"] == len(model.scan_names_) - 2 == len(index_of(tmp_path / "out"))
    assert document["missing"] == [model.scan_names_[0]]
    assert [one["name"] for one in document["skipped"]] == [model.scan_names_[2]]
    assert sum(one["n_written"] for one in document["concepts"]) == document["n_written"]
    assert f"Not found, by their names, 1 of {len(model.scan_names_)} scans:" in result.stderr
    assert "Skipped 1 of" in result.stderr


def test_scans_in_memory_are_found_by_their_names(
    model: ShapeConceptModel, folder: Path, tmp_path: Path
) -> None:
    scans = list(sc.read_scans(folder / "scans"))
    exported = export_scans(model, tmp_path / "out", scans=scans[1:])
    assert exported.missing == (scans[0].name,)
    for one in index_of(tmp_path / "out"):
        assert one["file"].endswith(".pcd")
        original = next(scan for scan in scans if scan.name == one["name"])
        origin = [float(one[f"origin_{axis}"]) for axis in "xyz"]
        read = sc.read_scan(tmp_path / "out" / one["file"]).points + origin
        np.testing.assert_allclose(read, original.points, atol=1e-4)
    with pytest.raises(ValueError, match="scans must be paths or Scans, got some of each"):
        export_scans(model, tmp_path / "again", scans=[scans[0], folder])  # type: ignore[list-item]


def test_the_end_of_a_path_is_a_name_too(model: ShapeConceptModel, folder: Path, tmp_path: Path) -> None:
    exported = export_scans(model, tmp_path / "out", scans=[folder / "scans/ball", folder / "scans/can"])
    assert Counter(name.partition("/")[0] for name in exported.missing) == {"box": 6}
    assert exported.n_written == len(model.scan_names_) - 6


def test_scans_are_not_in_memory_together(
    model: ShapeConceptModel, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    alive: weakref.WeakSet[Scan] = weakref.WeakSet()
    most = 0
    made = Scan.__post_init__

    def count(scan: Scan) -> None:
        nonlocal most
        made(scan)
        alive.add(scan)
        most = max(most, len(alive))

    monkeypatch.setattr(Scan, "__post_init__", count)
    export_scans(model, tmp_path / "out", "labelcloud", scans=folder / "scans")
    assert 0 < most < 8


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_full_disk_ends_it_and_leaves_nothing(
    folder: Path, tmp_path: Path, layout: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if layout == "parquet":
        pytest.importorskip("pyarrow")
    write, written = FolderInMaking.write, []

    def refuse(folder: FolderInMaking, place: str, content: bytes) -> None:
        written.append(place)
        if len(written) > 5:
            raise OSError(28, "No space left on device")
        write(folder, place, content)

    monkeypatch.setattr(FolderInMaking, "write", refuse)
    monkeypatch.setattr("shapeconcepts.io.atomic_write.os.fsync", lambda file: refuse(*[None] * 3))  # type: ignore[arg-type]
    written += ["full"] * 5 * (layout in ("csv", "parquet"))
    result = run(folder / "m.safetensors", tmp_path / "out", "--layout", layout, "--scans", folder / "scans")
    assert result.exit_code == 1
    assert f"cannot write {tmp_path / 'out'}: No space left on device" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_is_replaced_only_with_force(
    folder: Path, model: ShapeConceptModel, tmp_path: Path
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/mine").touch()
    arguments = (folder / "m.safetensors", tmp_path / "out", "--scans", folder / "scans")
    result = run(*arguments)
    assert result.exit_code == 1 and "is there already, and not empty: --force replaces it" in result.stderr
    assert content_of(tmp_path / "out") == {"mine": b""}
    assert run(*arguments, "--force").exit_code == 0
    assert "mine" not in content_of(tmp_path / "out")
    (tmp_path / "scans.csv").write_text("mine")
    arguments = (folder / "m.safetensors", tmp_path / "scans.csv", "--layout", "csv")
    result = run(*arguments)
    assert result.exit_code == 1 and "scans.csv: is there already: --force replaces it" in result.stderr
    assert run(*arguments, "--force").exit_code == 0


def test_force_replaces_nothing_that_is_needed(
    folder: Path, model: ShapeConceptModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = content_of(folder)
    with pytest.raises(ValueError, match="out must not hold the scans"):
        export_scans(model, folder / "scans", scans=folder / "scans", force=True)
    result = run(folder / "m.safetensors", folder, "--scans", folder / "scans", "--force")
    assert result.exit_code == 2 and "must not hold the model" in result.stderr.replace("\n", " ")
    (tmp_path / "here/below").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here/below")
    with pytest.raises(ValueError, match="out must not be the folder that one is in"):
        export_scans(model, tmp_path / "here", scans=folder / "scans", force=True)
    assert content_of(folder) == before


def test_mistakes_are_named(folder: Path, model: ShapeConceptModel, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"layout must be one of 'folders', .*, got 'zip'"):
        export_scans(model, tmp_path / "out", "zip")
    with pytest.raises(ValueError, match="out must be a path where rerun is None"):
        export_scans(model, None)
    with pytest.raises(ScanError, match="none of 19 scans of the model is there: say where they are"):
        export_scans(model, tmp_path / "out")
    with pytest.raises(NotADirectoryError, match="nowhere does not exist"):
        export_scans(model, tmp_path / "nowhere/out", scans=folder / "scans")
    with pytest.raises(IsADirectoryError, match="is a folder, the layout csv is a file"):
        export_scans(model, tmp_path, "csv")
    result = run(folder / "m.safetensors", tmp_path / "out")
    assert result.exit_code == 2 and "folders needs the scans" in result.stderr
    assert run(folder / "m.safetensors").exit_code == 2
    os.mkdir(tmp_path / "others")
    write_pcd(tmp_path / "others/a.pcd", Scan(np.eye(3)))
    result = run(folder / "m.safetensors", tmp_path / "out", "--scans", tmp_path / "others")
    assert result.exit_code == 1 and "none of 19 scans of the model is there" in result.stderr
    assert not (tmp_path / "out").exists()
