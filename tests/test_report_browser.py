"""The report in a real browser."""

from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from report_models import HOSTILE, WITHOUT_CONCEPTS, ball, grouped_stimuli, hostile_model, model_of
from report_reader import Reader
from shapeconcepts.report.html import preview, write_report
from shapeconcepts.report.html.time_scale import TimeScale


@pytest.fixture(scope="module")
def thousand(tmp_path_factory) -> Path:
    rows, labels = grouped_stimuli(1000, 12)
    path = tmp_path_factory.mktemp("report") / "thousand.html"
    shown = [preview(ball(seed=i)) for i in range(10)]
    write_report(path, model_of(rows, labels), [shown[i % 10] for i in range(1000)])
    return path


def test_a_thousand_scans_are_soon_there_and_few_are_drawn_at_a_time(browser, thousand):
    reader = Reader(browser, thousand)
    page = reader.page
    assert int(page.evaluate("document.documentElement.dataset.ready")) < 3000
    n_tiles = page.locator("#glance .tile").count()
    assert n_tiles > 1 and page.locator("#concepts article").count() >= n_tiles
    page.evaluate("document.querySelectorAll('#concepts .more, #outside .more').forEach(b => b.click())")
    most = 0
    for y in range(0, page.evaluate("document.documentElement.scrollHeight"), 6000):
        page.evaluate("y => window.scrollTo({ top: y, behavior: 'instant' })", y)
        reader.settle()
        drawn = "[...document.querySelectorAll('canvas')].filter(c => c.width > 0).length"
        most = max(most, page.evaluate(drawn))
    assert page.locator("#concepts canvas.scan, #outside canvas.scan").count() == 1000
    assert 10 < most < 200
    assert page.evaluate("window.contexts") <= 8
    assert reader.complaints == [] and reader.requests == [thousand.as_uri()]


def test_thousands_of_dots_are_drawn_when_they_come_into_sight(browser, tmp_path):
    rows, labels = grouped_stimuli(3000, 6)
    write_report(tmp_path / "r.html", model_of(rows, labels), [None] * 3000)
    reader = Reader(browser, tmp_path / "r.html", 400, 300)
    page, is_drawn = reader.page, "document.querySelector('canvas.timeline').width !== 300"
    assert not page.evaluate(is_drawn)
    page.locator("canvas.timeline").scroll_into_view_if_needed()
    reader.settle()
    assert page.evaluate(is_drawn) and reader.complaints == []


def test_dragging_turns_a_scan_and_clicking_enlarges_it(browser, thousand):
    reader = Reader(browser, thousand)
    page = reader.page
    page.locator("#glance canvas.scan").first.scroll_into_view_if_needed()
    reader.settle()
    before, neighbour = reader.pixels("#glance canvas.scan"), reader.pixels("#glance canvas.scan", 1)
    box = page.locator("#glance canvas.scan").first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y + 10, steps=4)
    page.mouse.up()
    reader.settle()
    assert reader.pixels("#glance canvas.scan") != before
    assert reader.pixels("#glance canvas.scan", 1) == neighbour
    assert not page.evaluate("document.getElementById('viewer').open")
    page.mouse.click(x, y)
    assert page.evaluate("document.getElementById('viewer').open")
    large = reader.pixels("#viewer canvas")
    page.keyboard.press("ArrowRight")
    reader.settle()
    assert reader.pixels("#viewer canvas") != large
    name = page.locator("#viewer .scan-name").inner_text()
    page.keyboard.press("PageDown")
    assert page.locator("#viewer .scan-name").inner_text() != name
    page.keyboard.press("Escape")
    assert not page.evaluate("document.getElementById('viewer').open")
    assert reader.complaints == []


def test_a_concept_is_highlighted_in_every_figure(browser, thousand):
    reader = Reader(browser, thousand)
    page = reader.page
    page.locator("#how").scroll_into_view_if_needed()
    reader.settle()
    figures = ["canvas.map", "canvas.map", "canvas.timeline"]
    plain = [reader.pixels(name, at) for name, at in zip(figures, (0, 1, 0), strict=True)]
    page.locator(".tile-name").nth(1).click()
    page.mouse.move(1, 1)
    reader.settle()
    lit = [reader.pixels(name, at) for name, at in zip(figures, (0, 1, 0), strict=True)]
    assert all(a != b for a, b in zip(plain, lit, strict=True))
    assert page.locator(".tile.is-lit").count() == 1 and page.locator("article.is-lit").count() == 1
    assert page.locator("#selection").is_visible()
    page.keyboard.press("Escape")
    reader.settle()
    assert [reader.pixels(name, at) for name, at in zip(figures, (0, 1, 0), strict=True)] == plain


def test_time_can_be_pulled(browser, thousand):
    reader = Reader(browser, thousand)
    slider, said = reader.page.locator("input[type=range]"), reader.page.locator("output")
    slider.fill("1")
    reader.settle()
    assert "12 classes," in said.inner_text()
    slider.fill("0")
    reader.settle()
    assert "1,000 classes" in said.inner_text()


def classes_on_the_page(model, time):
    """Class of each vertex: between concepts nothing enters there."""
    filtration = model.filtration_
    a, b = filtration.edges_.T
    kept = filtration.times_ <= time
    if filtration.stop == "persistence":
        labels = filtration.labels_[np.argsort(filtration.space_.vertices_)]
        kept &= labels[a] == labels[b]
    n = len(filtration.space_.multiplicities_)
    return connected_components(coo_matrix((np.ones(kept.sum()), (a[kept], b[kept])), (n, n)))[1]


@pytest.mark.parametrize("heat", ["divergence", "geodesic"])
def test_the_slider_runs_along_the_axis(browser, tmp_path, heat):
    rows, labels = grouped_stimuli(60, 4)
    model = model_of(rows, labels, heat=heat)
    write_report(tmp_path / "r.html", model, [None] * 60)
    reader = Reader(browser, tmp_path / "r.html")
    slider, said = reader.page.locator("input[type=range]"), reader.page.locator("output")
    scale = TimeScale.of(model.filtration_)
    for at in (0.3, 0.5, 0.8):
        time = float(scale.times(np.array(at)))
        slider.fill(str(at))
        reader.settle()
        is_short = heat == "divergence" and time < 0.1
        shown = f"{time:.2g}" if is_short else f"{time:.2f}" if heat == "geodesic" else f"{time:.3f}"
        n_classes = len(np.unique(classes_on_the_page(model, time)))
        assert said.inner_text().startswith(f"time {shown}")
        assert f": {n_classes} class" in said.inner_text()
    name = "to the concepts" if heat == "divergence" else "to ε_max"
    reader.page.get_by_role("button", name=name).click()
    reader.settle()
    concept_time = 1.0 if heat == "divergence" else model.filtration_.concept_time_
    assert float(slider.input_value()) == pytest.approx(
        float(scale.positions(np.array(concept_time))), abs=1e-3
    )
    assert f": {len(np.unique(classes_on_the_page(model, concept_time)))} cl" in said.inner_text()
    # Pulled in the figure, the same place is the same time.
    canvas = reader.page.locator("canvas.timeline")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    reader.page.mouse.click(box["x"] + 44 + 0.5 * (box["width"] - 2 - 44 - 14), box["y"] + 60)
    reader.settle()
    assert float(slider.input_value()) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(
    ("heat", "stop"),
    [("divergence", "persistence"), ("divergence", "annexations"), ("geodesic", "annexations")],
)
def test_a_page_says_how_its_time_was_chosen(browser, tmp_path, heat, stop):
    rows, labels = grouped_stimuli(60, 4)
    model = model_of(rows, labels, heat=heat, stop=stop)
    write_report(tmp_path / "r.html", model, [None] * 60)
    reader = Reader(browser, tmp_path / "r.html")
    told = reader.page.evaluate("document.body.innerHTML.split('<script')[0]")
    assert ("ε_max" in told) == ("busiest step" in told) == (stop == "annexations")
    assert ("two concepts if there is a gap" in told) == (stop == "persistence")
    assert ("stay apart; what is left at time 1" in told) == (stop == "persistence")
    assert ("hot middle" in told) == (heat == "geodesic")
    assert ("that of odds" in told) == (heat == "divergence")
    assert ("joins early" in told) is False
    reader.page.locator("input[value=heat]").check()
    reader.settle()
    key = reader.page.locator("fieldset").inner_text()
    assert ("stands apart" in key) == (heat == "divergence")
    assert reader.complaints == []


def test_hostile_names_do_nothing(browser, tmp_path):
    path = tmp_path / "r.html"
    unread = [(name, name) for name in HOSTILE]
    shown, reading = [preview(ball(), 50)] * 40, {"--mask": HOSTILE[0]}
    write_report(path, hostile_model(), shown, unread=unread, title=HOSTILE[0], reading=reading)
    reader = Reader(browser, path)
    page = reader.page
    page.evaluate("document.querySelectorAll('.more').forEach(button => button.click())")
    page.locator("#concepts canvas.scan").first.click()
    assert page.evaluate("window.attacked") is None
    assert page.locator("h1").inner_text() == HOSTILE[0]
    assert page.locator("#left-out th").first.text_content() == HOSTILE[0]
    assert page.locator("#made td").first.text_content() == HOSTILE[0]
    assert page.locator("img").count() == 0
    assert reader.complaints == [] and reader.requests == [path.as_uri()]


@pytest.mark.parametrize("kind", ["one scan", "no stimuli at all", "all different"])
def test_models_without_concepts(browser, tmp_path, kind):
    rows = WITHOUT_CONCEPTS[kind]
    write_report(tmp_path / "r.html", model_of(rows), [preview(ball(), 50)] * len(rows))
    reader = Reader(browser, tmp_path / "r.html")
    assert reader.complaints == []
    assert "No concepts" in reader.page.locator("#glance").inner_text()
    assert reader.page.locator("#outside canvas.scan").count() == len(rows)


def test_without_labels_on_a_phone(browser, tmp_path):
    rows, _ = grouped_stimuli(40, 4)
    names = ["a-very-long-name-without-any-place-to-break-" * 5] * 40
    write_report(tmp_path / "r.html", model_of(rows, None, names), [None] + [preview(ball(), 50)] * 39)
    reader = Reader(browser, tmp_path / "r.html", 375, 700)
    assert reader.complaints == []
    assert reader.page.evaluate("document.documentElement.scrollWidth") == 375
    assert "lifetime" in reader.page.locator("#glance figure").inner_text()
