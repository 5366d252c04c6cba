"""The report as a file: complete, self-contained, and safe against whatever files are called."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from report_models import HOSTILE, WITHOUT_CONCEPTS, ball, grouped_stimuli, hostile_model, model_of
from shapeconcepts.cli import app
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.report.html import preview, write_report
from shapeconcepts.scan import Scan


class Page(HTMLParser):
    """Elements of a page, with the text of its scripts."""

    def __init__(self, path: Path):
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.texts.append("")

    def handle_data(self, data):
        if self.texts:
            self.texts[-1] += data

    def text_of(self, tag: str) -> list[str]:
        return [text for (name, _), text in zip(self.tags, self.texts, strict=True) if name == tag]

    @property
    def contents(self) -> dict:
        return json.loads(self.text_of("script")[0])


def test_hostile_names_stay_text(tmp_path):
    model = hostile_model()
    unread = [(name, name) for name in HOSTILE]
    reading = dict.fromkeys(HOSTILE, HOSTILE[0])
    title = HOSTILE[0] + HOSTILE[6]
    write_report(tmp_path / "r.html", model, [None] * 40, unread=unread, title=title, reading=reading)
    page = Page(tmp_path / "r.html")
    assert [tag for tag, _ in page.tags].count("script") == 2
    assert [tag for tag, _ in page.tags].count("img") == 0
    contents = page.contents
    assert contents["scans"]["names"] == [name or f"scan {i}" for i, name in enumerate(model.scan_names_)]
    assert contents["unread"] == [list(pair) for pair in unread]
    assert contents["reading"] == [list(pair) for pair in reading.items()]
    assert contents["skipped"] == [[HOSTILE[3], HOSTILE[0]]]
    assert HOSTILE[0] in [concept["name"] for concept in contents["concepts"]]
    assert page.text_of("title")[0].startswith(HOSTILE[0])


def test_nothing_is_fetched(tmp_path):
    rows, labels = grouped_stimuli(30, 3)
    write_report(tmp_path / "r.html", model_of(rows, labels), [preview(ball())] * 30)
    page = Page(tmp_path / "r.html")
    for tag, attributes in page.tags:
        assert "src" not in attributes and tag not in ("iframe", "object", "embed", "base")
        assert attributes.get("href", "data:,") == "data:,"
    policy = next(a["content"] for t, a in page.tags if a.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'") and "unsafe" not in policy
    assert not re.search(r"https?:|url\(|@import|fetch\(|XMLHttp|innerHTML", "".join(page.texts))


def test_contents_say_what_the_model_learned(tmp_path):
    rows, labels = grouped_stimuli(60, 4)
    rows[7] = 0
    model = model_of(rows, labels)
    write_report(tmp_path / "r.html", model, [None if i == 5 else preview(ball(), 20) for i in range(60)])
    contents = Page(tmp_path / "r.html").contents
    by_number = {concept["number"]: concept for concept in contents["concepts"]}
    assert sorted(by_number) == list(range(len(model.concepts_)))
    for number, concept in enumerate(model.concepts_):
        shown = by_number[number]
        assert sorted(shown["members"]) == concept.members.tolist()
        assert shown["members"][0] == concept.medoid
        assert shown["birth"] == pytest.approx(concept.birth, abs=1e-4)
    scores = [concept["score"] for concept in contents["concepts"]]
    assert scores == sorted(scores, reverse=True)
    assert contents["scans"]["vertices"][7] == -1
    assert contents["scans"]["previews"][5] is None and len(contents["scans"]["previews"][0]) <= 160
    assert contents["scans"]["sides"][5] is None
    assert contents["scans"]["sides"][0] == pytest.approx([0.1, 0.1, 0.05], rel=0.03)
    assert contents["reading"] == []
    assert contents["filtration"]["conceptTime"] == 1.0
    n_edges = len(contents["filtration"]["edges"]) + len(contents["filtration"]["edgesBetween"])
    assert sum(contents["filtration"]["stepCounts"]) == n_edges


@pytest.mark.parametrize("kind", WITHOUT_CONCEPTS)
def test_models_without_concepts(tmp_path, kind):
    rows = WITHOUT_CONCEPTS[kind]
    model = model_of(rows)
    assert model.concepts_ == []
    write_report(tmp_path / "r.html", model, [None] * len(rows))
    contents = Page(tmp_path / "r.html").contents
    assert contents["concepts"] == [] and contents["filtration"]["conceptTime"] is None


def test_many_scans_make_a_file_that_can_be_opened(tmp_path, monkeypatch):
    rows, labels = grouped_stimuli(1000, 12)
    one = preview(ball())
    write_report(tmp_path / "r.html", model_of(rows, labels), [one] * 1000)
    assert (tmp_path / "r.html").stat().st_size < 6e6
    # Far more scans get fewer elements each.
    monkeypatch.setattr("shapeconcepts.report.html.contents.LARGEST_PREVIEWS", 600_000)
    write_report(tmp_path / "r.html", model_of(rows, labels), [one] * 1000)
    assert (tmp_path / "r.html").stat().st_size < 1.2e6


def test_same_model_same_bytes(tmp_path):
    rows, labels = grouped_stimuli(50, 4)
    for name in "ab":
        write_report(tmp_path / name, model_of(rows, labels), [preview(ball())] * 50)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_wrong_number_of_previews_leaves_the_old_file(tmp_path):
    (tmp_path / "r.html").write_text("old")
    with pytest.raises(ValueError, match="previews must hold one for each of the 2 training scans, got 3"):
        write_report(tmp_path / "r.html", model_of(np.eye(2)), [None] * 3)
    assert (tmp_path / "r.html").read_text() == "old"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], []),
        (["--units", "auto"], []),
        (["--units", "mm", "--up", "y"], [["--units", "mm"], ["--up", "y"]]),
        (["--no-scenes", "--voxel-size", "0.004"], [["--scenes", "no"], ["--voxel-size", "0.004"]]),
        (
            ["--views", "1", "--depth-scale", "0.0002", "--intrinsics", "500,500,320,240"],
            [["--intrinsics", "500,500,320,240"], ["--depth-scale", "0.0002"], ["--views", "1"]],
        ),
    ],
    ids=["none", "default given", "units", "point clouds", "depth images and meshes"],
)
def test_the_page_tells_how_scans_were_read_where_not_by_default(tmp_path, options, told):
    for i in range(4):
        write_pcd(tmp_path / f"{i}.pcd", Scan(ball(seed=i).points))
    command = ["learn", tmp_path, "--model", tmp_path / "m", "--report", tmp_path / "r.html", "--no-cache"]
    result = CliRunner().invoke(app, [str(argument) for argument in [*command, *options]])
    assert result.exit_code == 0, result.output
    assert Page(tmp_path / "r.html").contents["reading"] == told


def test_the_history_of_a_model_is_told():
    from model_file_examples import described_objects, fitted_model
    from shapeconcepts.report.html.history import history_contents

    model = fitted_model()
    assert history_contents(model) == {"scans": [], "concepts": []}
    sizes = {concept.key: concept.size for concept in model.concepts_}
    model.partial_fit(described_objects(8, seed=3)).consolidate()
    model.partial_fit(described_objects(2, seed=4)).consolidate()
    history = history_contents(model)
    assert history["scans"] == [40, 72, 80]
    for concept in history["concepts"]:
        assert len(concept["sizes"]) == len(concept["events"]) == 3
        assert concept["sizes"][0] == sizes.get(concept["key"], 0)
    now = {concept["key"]: concept["sizes"][-1] for concept in history["concepts"]}
    assert {key: size for key, size in now.items() if size} == {c.key: c.size for c in model.concepts_}
