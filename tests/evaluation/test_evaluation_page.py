"""The page of an evaluation: complete, self-contained, and safe against whatever labels are called."""

import re
import shutil
import subprocess
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import evaluation_examples as examples
import numpy as np
import pytest

from shapeconcepts.evaluation.report import draw_all, write_evaluation
from shapeconcepts.evaluation.report.number_formats import mean_error, median_and_range, percent
from shapeconcepts.evaluation.report.tables import best_cells, table
from shapeconcepts.evaluation.report.verdict import verdict
from shapeconcepts.evaluation.results import ClassificationRow

VOID = {"meta", "link", "br", "img", "hr", "input"}
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


class Page(HTMLParser):
    """Elements of a page, which must be closed in the order in which they were opened."""

    def __init__(self, text: str):
        super().__init__()
        self.text = text
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.tables: list[list[list[str]]] = []
        self.bold: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")

    def handle_startendtag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" in self.open:
            return
        self.words.append(data)
        if {"td", "th"} & set(self.open) and "small" not in self.open:
            self.tables[-1][-1][-1] += data
        if "b" in self.open:
            self.bold.append(data)

    def row(self, name: str, at: int = 0) -> list[str]:
        """The cells of the row with that heading, in the table of that number among those that have one."""
        return [row for one in self.tables for row in one if row and row[0] == name][at][1:]


def page_of(folder: Path, evaluation) -> Page:
    write_evaluation(folder / "e.html", evaluation)
    return Page((folder / "e.html").read_text("utf-8"))


@pytest.fixture(scope="module")
def evaluation():
    return examples.evaluation()


@pytest.fixture(scope="module")
def page(evaluation, tmp_path_factory):
    return page_of(tmp_path_factory.mktemp("page"), evaluation)


def test_every_figure_is_there_once_with_its_caption(page, evaluation):
    figures = draw_all(evaluation)
    cards = [attributes["id"] for tag, attributes in page.tags if tag == "figure"]
    assert sorted(cards) == sorted(f"figure-{name}" for name in figures)
    counts = Counter(tag for tag, _ in page.tags)
    assert counts["svg"] == counts["figcaption"] == len(figures)


def test_nothing_is_fetched_or_run(page):
    for tag, attributes in page.tags:
        assert tag not in ("script", "img", "iframe", "object", "embed", "base", "form")
        assert not any(name.startswith("on") or name in ("src", "srcset", "action") for name in attributes)
        for name in ("href", "xlink:href"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    assert "default-src 'none'" in page.text
    outside = set(re.findall(r"https?://[^\s\"'<)]+", page.text))
    assert outside <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert "@import" not in page.text


def test_identifiers_are_unique_and_every_reference_has_its_target(page):
    identifiers = Counter(attributes["id"] for _, attributes in page.tags if "id" in attributes)
    assert max(identifiers.values()) == 1
    references = re.findall(r'href="#([^"]+)"', page.text) + re.findall(r"url\(#([^)]+)\)", page.text)
    assert len(references) > 100 and set(references) <= set(identifiers)


def test_ours_stands_beside_the_papers(page, evaluation):
    ours = evaluation.selections[0]
    purity = np.median([one.mean_purity for one in ours.scores])
    assert page.row("mean purity of a concept")[0] == percent(purity)
    assert page.row("mean purity of a concept")[-1] == "86.2 %"
    assert page.row("concepts") == ["34", "22", "36"]
    assert page.row("time of most annexations ε_max") == ["0.48", "0.48", "0.48"]
    assert page.row("time at which concepts are taken")[0] == "0.61"
    supervised = evaluation.supervised
    assert page.row("– cross-validation error") == [percent(supervised.chosen_error), "–", "14.8 %"]
    assert page.row("mean purity of five concepts") == ["52.0 %", "–", "50.0 %"]


def test_errors_with_hidden_and_foreign_parts_stand_beside_each_other(page):
    ours, histograms = page.row("our concepts"), page.row("histograms")
    assert ours[0].startswith("1.0 %") and ours[1].startswith("12.0 %") and ours[2].startswith("23.0 %")
    assert histograms[0].startswith("2.0 %") and histograms[1].startswith("34.0 %")


def test_errors_stand_by_label_beside_the_papers(page, evaluation):
    for at, errors, papers in (
        (
            0,
            evaluation.selections[0].errors,
            ["10.4 %", "0.0 %", "2.5 %", "6.5 %", "0.0 %", "4.2 %", "8.8 %"],
        ),
        (1, evaluation.supervised.errors, ["10.7 %", "0.0 %", "2.4 %", "6.8 %", "0.0 %", "3.3 %", "8.9 %"]),
    ):
        ours = page.row(("ours, default", "ours")[at])
        assert ours[:-1] == [percent(np.mean(errors[label])) for label in examples.SEVEN]
        assert ours[-1] == percent(np.mean(list(errors.values())))
        assert page.row("the paper, on its own data", at) == [*papers, "4.6 %"]


def test_the_papers_mean_is_not_set_beside_other_labels(tmp_path):
    page = page_of(tmp_path, examples.evaluation(["box", "can"], 1))
    assert page.row("the paper, on its own data") == ["2.5 %", "6.5 %", "–"]
    page = page_of(tmp_path, examples.evaluation(["mug"], 1))
    assert not [row for one in page.tables for row in one if row[0] == "the paper, on its own data"]


def test_where_a_baseline_is_better_is_seen(tmp_path, evaluation):
    better = replace(evaluation.baselines[0], scores=[examples.scores(0.99)])
    worse = replace(evaluation.baselines[1], scores=[examples.scores(0.2)])
    losing = replace(evaluation, baselines=[worse, better])
    page = page_of(tmp_path, losing)
    assert verdict(losing) in " ".join(page.words)
    assert page.bold[:6] == page.row(f"{better.representation}, {better.grouping}")[1:7]
    names = [row[0] for row in page.tables[1][1:]]
    assert names[:2] == [f"{better.representation}, {better.grouping}", "shapeconcepts, default"]


def test_parameters_of_baselines_are_told(page, evaluation):
    for row in evaluation.baselines:
        values = ", ".join(str(one["n_clusters"]) for one in row.parameters)
        assert page.row(f"{row.representation}, {row.grouping}")[-1] == f"n_clusters\u00a0=\u00a0{values}"


def test_everything_about_the_run_is_told(page, evaluation):
    text = " ".join(page.words)
    assert evaluation.command in text
    assert page.row("teddy") == ["66"]
    assert page.row("scans/broken.pcd") == ["has no points"]
    assert page.row("training objects without any stimulus, default") == ["3"]
    assert page.row("supervised") == ["75.0 s"] and page.row("numpy") == ["2.1.0"]
    assert "not on the map: 2 of OSD" in text


def test_names_stay_text(tmp_path):
    hostile = examples.HOSTILE
    made = replace(
        examples.evaluation(hostile, 1),
        data_name=hostile[0],
        skipped=[(hostile[3], hostile[0]), ("lone \udcff surrogate", "bad name")],
        versions={hostile[4]: hostile[0]},
        command=f"shapeconcepts evaluate '{hostile[3]}'",
        classifications=[ClassificationRow(hostile[3], {name: [0.1] for name in hostile})],
    )
    page = page_of(tmp_path, made)
    counts = Counter(tag for tag, _ in page.tags)
    assert counts["script"] == counts["img"] == 0
    assert counts["h1"] == counts["title"] == 1
    assert page.row(hostile[3])[0] == "10.0 %"
    assert [row[0] for one in page.tables for row in one].count(hostile[4]) >= 2
    assert f"Evaluation on {hostile[0]}" in page.words


def test_many_labels_are_rows(tmp_path):
    made = examples.evaluation(examples.TWENTY, 1)
    page = page_of(tmp_path, made)
    ours = [percent(one.errors["category c"][0]) for one in made.selections]
    others = [percent(one.errors["category c"][0]) for one in made.classifications]
    assert page.row("category c") == ours + others
    smallest = min(one.errors["category c"][0] for one in (*made.selections, *made.classifications))
    assert percent(smallest) in page.bold


def test_no_concepts_make_a_page(tmp_path):
    page = page_of(tmp_path, examples.nothing_found())
    assert page.row("mean purity of a concept") == ["–", "86.2 %"]
    assert "nan" not in " ".join(page.words)
    links = [attributes["href"] for tag, attributes in page.tags if tag == "a"]
    assert links == ["#headline", "#unsupervised", "#made"]


def test_the_same_results_give_the_same_page(tmp_path):
    for name in "ab":
        write_evaluation(tmp_path / name, examples.evaluation(repetitions=2))
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_page_that_cannot_be_written_says_so(tmp_path):
    with pytest.raises(OSError):
        write_evaluation(tmp_path / "absent" / "e.html", examples.nothing_found())


@pytest.mark.skipif(CHROMIUM is None, reason="needs a Chromium browser")
def test_a_browser_opens_the_page_without_a_complaint(tmp_path):
    write_evaluation(tmp_path / "e.html", examples.evaluation(repetitions=1))
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--v=0"]
    command += [f"--user-data-dir={tmp_path / 'user'}", "--dump-dom", (tmp_path / "e.html").as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.count("<figure") == 14
    assert "CONSOLE" not in done.stderr


def test_best_cells():
    nan = float("nan")
    assert best_cells([[0.5, nan, 0.9], [0.7, nan, 0.9001], [nan, nan, 0.8]]) == [(1, 1), (0, 3), (1, 3)]
    assert best_cells([[0.5], [0.2]], smallest=True) == [(1, 1)]
    assert best_cells([]) == []


def test_a_table_escapes_what_it_is_given():
    made = table(["<a>"], [["<b>", ("<c>", "<d>")]], best=[(0, 1)], ours=[0])
    assert "&lt;a&gt;" in made and "<b>&lt;c&gt;</b><small>&lt;d&gt;</small>" in made and "<a>" not in made


def test_medians_and_means_leave_out_what_is_no_number():
    assert median_and_range([0.5, np.nan, 0.7, 0.6], percent) == ("60.0 %", "50.0–70.0")
    assert median_and_range([0.5], percent) == ("50.0 %", "")
    assert median_and_range([], percent) == ("–", "")
    assert mean_error({"a": [0.0, 0.2], "b": [0.5, np.nan]}) == [0.25, 0.2]
    assert mean_error({}) == []
