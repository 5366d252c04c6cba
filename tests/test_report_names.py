"""Names and sizes on the page: in little room, too."""

import dataclasses
import re

import pytest

from report_models import ball, grouped_stimuli, model_of
from report_reader import Reader
from shapeconcepts import ShapeConceptModel
from shapeconcepts.report.html import preview, write_report

# Cards out of sight are laid out, too.
LAY_OUT_ALL = (
    "document.querySelectorAll('article').forEach(card => { card.style.contentVisibility = 'visible' })"
)
WIDER_THAN_ITS_PLACE = """name => {
  const range = document.createRange();
  range.selectNodeContents(name);
  return range.getBoundingClientRect().width > name.clientWidth + 1;
}"""


def model_with_long_names(has_labels: bool) -> ShapeConceptModel:
    rows, labels = grouped_stimuli(40, 4)
    names = [f"restaurant_views/cup/very_long_name_of_a_scan_seen_from_view_{i:03}.ply" for i in range(39)]
    model = model_of(rows, labels if has_labels else None, [*names, "short.pcd"])
    for number, concept in enumerate(model.concepts_):
        concept.name = f"objects whose name is far longer than any tile or bar has room for, kind {number}"
    return model


@pytest.mark.parametrize("has_labels", [True, False])
def test_long_names_keep_both_ends_however_wide_the_window_is(browser, tmp_path, has_labels):
    write_report(tmp_path / "r.html", model_with_long_names(has_labels), [preview(ball(), 50)] * 40)
    reader = Reader(browser, tmp_path / "r.html", 1280)
    page = reader.page
    page.evaluate(LAY_OUT_ALL)
    page.locator(".tile-name").first.click()
    shown, selected = {}, {}
    for width in (1280, 420, 1281, 421):
        page.set_viewport_size({"width": width, "height": 900})
        reader.settle()
        selected[width] = page.locator("#selection .one-line").inner_text()
        names = page.locator(".gallery .one-line, .tile .one-line").all()
        shown[width] = [name.inner_text() for name in names]
        for name, text in zip(names, shown[width], strict=True):
            full = name.get_attribute("title")
            first, mark, last = text.partition("…")
            assert full.startswith(first) and full.endswith(last)
            assert bool(mark) == (full != "short.pcd") and (not mark or min(len(first), len(last)) >= 3)
            assert not name.evaluate(WIDER_THAN_ITS_PLACE)
    assert shown[1280] == shown[1281] != shown[420] == shown[421]
    assert re.fullmatch(r"objects whose name.*, kind \d", selected[1281]) and "…" not in selected[1281]
    assert re.fullmatch(r"obj.*….*\d", selected[420])
    assert page.evaluate("document.documentElement.scrollWidth") == 421
    assert reader.complaints == []


def test_long_names_in_the_tree_keep_both_ends(browser, tmp_path):
    model = model_with_long_names(True)
    write_report(tmp_path / "r.html", model, [None] * 40)
    bars = Reader(browser, tmp_path / "r.html").page.locator(".granularity g")
    shown = [text for text in bars.locator("text").all_text_contents() if text.startswith("objects")]
    assert len(shown) == len(model.concepts_) and any("…" in text for text in shown)
    assert all(re.fullmatch(r"objects whose.*for, kind \d, 10 scans, mostly kind \d", text) for text in shown)
    titles = "".join(bars.locator("title").all_text_contents())
    assert all(concept.name in titles for concept in model.concepts_)


@pytest.mark.parametrize(
    ("factor", "told"),
    [
        (1, "10 × 10 × 5.0 cm"),
        (1000, "100 × 100 × 50 m"),
        (0.05, "5.0 × 5.0 × 2.5 mm"),
        (20, "2.0 × 2.0 × 1.0 m"),
        (0, "0 × 0 × 0 mm"),
    ],
)
def test_the_size_stands_below_a_picture_and_shows_wrong_units(browser, tmp_path, factor, told):
    model = model_of(grouped_stimuli(40, 4)[0])
    scan = ball()
    scaled = dataclasses.replace(scan, points=scan.points * factor, voxel_size=0.005 * (factor or 1))
    shown = [preview(scaled, 50)] * 40
    undrawn = next(i for i in range(40) if i not in {concept.medoid for concept in model.concepts_})
    shown[undrawn] = None
    write_report(tmp_path / "r.html", model, shown)
    reader = Reader(browser, tmp_path / "r.html", 420)
    page = reader.page
    page.evaluate(LAY_OUT_ALL)
    sizes = page.locator(".gallery .size, .tile .size").all_inner_texts()
    assert {size.replace("\u00a0", " ") for size in sizes} == {told}
    assert len(sizes) == page.locator(".gallery canvas, .tile canvas").count() == 39 + len(model.concepts_)
    page.locator("#glance canvas.scan").first.click()
    assert told in page.locator("#viewer").inner_text().replace("\u00a0", " ")
    assert page.evaluate("document.documentElement.scrollWidth") == 420
    assert reader.complaints == []
