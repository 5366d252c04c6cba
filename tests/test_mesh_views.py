"""Meshes scanned from all around."""

import json

import numpy as np
import pytest
import trimesh
from scipy.spatial.distance import pdist
from typer.testing import CliRunner

from shapeconcepts import ScanError, ScanWarning, datasets, load_model
from shapeconcepts.cli import app
from shapeconcepts.simulation.views import directions_around
from shapeconcepts.sources.mesh_views import mesh_and_count

BOX = trimesh.creation.box((0.2, 0.15, 0.1))


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for kind, mesh in (
        ("box", BOX),
        ("ball", trimesh.creation.icosphere(3, 0.08)),
        ("can", trimesh.creation.cylinder(0.04, 0.14)),
    ):
        (folder / kind).mkdir()
        for size in (1.0, 1.1):
            mesh.copy().apply_scale(size).export(folder / kind / f"{kind}{size}.stl")
    return folder


@pytest.mark.parametrize("n", [1, 2, 3, 8, 24, 200])
def test_directions_are_spread_evenly(n):
    directions = directions_around(n)
    assert directions.shape == (n, 3)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    if n > 2:
        assert np.linalg.norm(directions.mean(axis=0)) < 1 / n
        # Caps of this radius would fill the sphere.
        assert pdist(directions).min() > 0.7 * (4 / n) ** 0.5


def test_views_are_scans_from_these_directions():
    scans = datasets.views(BOX.vertices, BOX.faces, 12, name="b", label="box", noise=False)
    assert [scan.name for scan in scans] == [f"b/view {i} of 12" for i in range(1, 13)]
    assert {scan.label for scan in scans} == {"box"} and {scan.instance for scan in scans} == {"b"}
    expected = datasets.scan_mesh(
        BOX.vertices,
        BOX.faces,
        view_direction=directions_around(12)[4],
        noise=False,
        random_state=np.random.default_rng((0, 4)),
    )
    assert np.array_equal(scans[4].points, expected.points)
    again = datasets.views(BOX.vertices, BOX.faces, 12)
    assert all(
        np.array_equal(a.points, b.points)
        for a, b in zip(again, datasets.views(BOX.vertices, BOX.faces, 12), strict=True)
    )


def test_what_cannot_be_scanned():
    with pytest.raises(ValueError, match="n_views must be an integer of at least 1, got 0"):
        datasets.views(BOX.vertices, BOX.faces, 0)
    with pytest.raises(ScanError, match=r"big: the mesh is .* m across"):
        datasets.views(1000 * BOX.vertices, BOX.faces, 3, name="big")


def test_folders_of_meshes(meshes, tmp_path):
    scans = datasets.load_views(meshes, 5)
    assert len(scans) == 30
    assert scans[7].name == "ball/ball1.1.stl/view 3 of 5"
    assert scans[7].label == "ball" and scans[7].instance == "ball/ball1.1.stl"
    (tmp_path / "broken.stl").write_bytes(b"solid nothing")
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((50, 3)))
    (tmp_path / "sound.stl").write_bytes((meshes / "box" / "box1.0.stl").read_bytes())
    with pytest.warns(ScanWarning, match=r"broken\.stl"):
        found = datasets.load_views(tmp_path, 3)
    assert [scan.name for scan in found] == ["cloud.npy", *(f"sound.stl/view {i} of 3" for i in (1, 2, 3))]
    assert len(found.skipped) == 1


def test_names_of_views():
    assert mesh_and_count("a/b.stl/view 3 of 24") == ("a/b.stl", 24)
    assert mesh_and_count("a/view.stl") is None and mesh_and_count("learn0/2") is None


def test_learn_from_meshes_and_explain_a_scan(meshes, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    run = CliRunner()
    arguments = ["learn", str(meshes), "--model", str(tmp_path / "m"), "--views", "6", "--jobs", "1"]
    for _ in range(2):  # The second time from the cache.
        result = run.invoke(app, [*arguments, "--json"])
        assert result.exit_code == 0, result.output
        assert json.loads(result.stdout)["skipped"] == []
        model = load_model(tmp_path / "m")
        assert model.scan_names_[2] == "ball/ball1.0.stl/view 3 of 6"
        assert model.scan_labels_ == [kind for kind in ("ball", "box", "can") for _ in range(12)]
    scan = datasets.scan_mesh(BOX.vertices, BOX.faces, random_state=3)
    np.savez(tmp_path / "scan.npz", points=scan.points, viewpoint=np.zeros(3))
    explained = ["explain", str(tmp_path / "m"), str(tmp_path / "scan.npz")]
    picture = ["--image", str(tmp_path / "why.png"), "--training-data", str(meshes)]
    result = run.invoke(app, [*explained, *picture])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "why.png").stat().st_size > 10_000
    assert run.invoke(app, [*arguments[:-4], "--views", "0"]).exit_code == 2
