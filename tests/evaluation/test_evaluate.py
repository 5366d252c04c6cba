"""The whole evaluation as a function."""

import json
import sys
from dataclasses import replace

import pytest
from labelled_scans import segmented_scans

from shapeconcepts.datasets import CATEGORIES
from shapeconcepts.evaluation import PAPER, evaluate
from shapeconcepts.evaluation.json_document import plain_values


def test_the_same_objects_give_the_same_figures() -> None:
    documents = []
    for _ in range(2):
        result = evaluate(segmented_scans(), name="small", repetitions=1, skipped=[("a.pcd", "is empty")])
        document = plain_values(result)
        assert set(document.pop("seconds")) == {
            "description",
            "unsupervised selection",
            "number of levels",
            "supervised selection",
            "generalisation",
            "hidden parts",
            "baselines",
        }
        documents.append(json.dumps(document, allow_nan=False, sort_keys=True))
    assert documents[0] == documents[1]
    first = json.loads(documents[0])
    assert first["n_objects"] == 36
    assert first["labels"] == {"ball": 12, "box": 12, "can": 12}
    assert [one["preset"] for one in first["selections"]] == ["default", "paper"]
    assert first["skipped"] == [["a.pcd", "is empty"]]
    assert first["versions"]["shapeconcepts"]
    # The last class never dies.
    never = [[d for _, d in one["filtration"]["diagram"]].count(None) for one in first["selections"]]
    assert never == [1, 1]


def test_instances_stay_on_one_side(monkeypatch: pytest.MonkeyPatch) -> None:
    module = sys.modules["shapeconcepts.evaluation.evaluate"]
    given = {}

    def stop(*arguments: object, instances: object, **options: object) -> None:
        given["instances"] = instances
        raise RuntimeError("far enough")

    monkeypatch.setattr(module, "stratified_splits", stop)
    instances = [str(i % 4) for i in range(36)]
    with pytest.raises(RuntimeError, match="far enough"):
        evaluate(segmented_scans(), instances=instances)
    assert given["instances"][:2].tolist() == ["ball/0", "ball/1"]
    with pytest.raises(RuntimeError, match="far enough"):
        evaluate(segmented_scans(), instances=[None, *instances[1:]])
    assert given["instances"] is None


def test_missing_and_rare_labels_are_named() -> None:
    scans = list(segmented_scans())
    with pytest.raises(
        ValueError, match=r"mine: every object needs a label .* 1 of 36 have none, such as ball_0"
    ):
        evaluate([replace(scans[0], label=None), *scans[1:]], name="mine")
    with pytest.raises(ValueError, match=r"mine: each label needs at least 4 scans .* but 'can' has 3"):
        evaluate(scans[:27], name="mine")
    with pytest.raises(ValueError, match=r"mine: at least two labels are needed .* only 'ball'"):
        evaluate(scans[:12], name="mine")
    with pytest.raises(ValueError, match=r"mine: at least two labels are needed .* got none"):
        evaluate([], name="mine")
    with pytest.raises(ValueError, match="repetitions must be"):
        evaluate(scans, repetitions=0)


def test_the_papers_tables() -> None:
    assert set(PAPER.unsupervised_errors) == set(PAPER.supervised_errors) == set(CATEGORIES)
    assert PAPER.unsupervised_mean_error == pytest.approx(0.324 / 7)
    assert PAPER.supervised_mean_error == pytest.approx(0.321 / 7)
