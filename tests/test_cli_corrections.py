"""Edits of a model on the command line: told by `info`, kept by `learn`, set aside where they cannot be."""

from __future__ import annotations

import shutil

import pytest

from shapeconcepts import datasets, load_model
from shapeconcepts.corrections import JournalFile
from shapeconcepts.io.write_pcd import write_pcd
from test_cli_learn import run


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    folder = tmp_path_factory.mktemp("corrected") / "scans"
    return written(datasets.simulate(10, random_state=3, categories=("ball", "plate", "can")), folder)


def written(scans, folder):
    for scan in scans:
        path = folder / scan.label / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    return folder


def some_of(scans, folder, *kinds):
    for kind in kinds:
        shutil.copytree(scans / kind, folder / kind)
    return folder


def correct(path):
    model = load_model(path)
    model.rename(model.concepts_[0], "largest")
    model.move([0, 1], name="two of them")
    model.write_journal(path)
    return model


def test_edits_are_told_kept_by_learning_anew_and_set_aside_for_other_scans(scans, tmp_path):
    path = tmp_path / "m.safetensors"
    run("learn", scans, "--model", path)
    correct(path)
    told = run("info", path)
    assert "two of them" in told.stdout and "2 edits are in force" in told.stderr

    again = run("learn", scans, "--model", path, "--min-size", "4")
    assert "2 edits are in force" in again.stderr
    names = [concept.name for concept in load_model(path).concepts_]
    assert "largest" in names and "two of them" in names

    # Of other scans nothing can be kept; it is not lost either.
    other = written(datasets.simulate(8, random_state=9, categories=("teddy", "box")), tmp_path / "other")
    told = run("learn", other, "--model", path)
    assert "was of another model" in told.stderr and (tmp_path / "m.safetensors.journal.1").is_file()
    assert not JournalFile(path).path.exists()


def test_edits_no_longer_fit_and_are_told(scans, tmp_path):
    path = tmp_path / "m.safetensors"
    run("learn", scans, "--model", path)
    correct(path)
    # The first ones are no longer there.
    told = run("learn", some_of(scans, tmp_path / "some", "plate", "can"), "--model", path)
    assert "of which 1 no longer fit" in told.stderr and "2 of its 2 scans" in told.stderr


def test_an_update_keeps_edits(scans, tmp_path):
    path = tmp_path / "m.safetensors"
    run("learn", some_of(scans, tmp_path / "some", "ball", "plate"), "--model", path)
    correct(path)
    assert "2 edits are in force" in run("learn", scans, "--update", path).stderr
    names = [concept.name for concept in load_model(path).concepts_]
    assert "largest" in names and "two of them" in names


def test_a_damaged_journal_is_told_and_renamed_by_learning_anew(scans, tmp_path):
    path = tmp_path / "m.safetensors"
    run("learn", scans, "--model", path)
    JournalFile(path).path.write_text("nonsense\n")
    refused = run("info", path)
    assert refused.exit_code == 1 and "m.safetensors.journal: line 1" in refused.stderr
    told = run("learn", scans, "--model", path)
    assert "m.safetensors.journal.1 now" in told.stderr
