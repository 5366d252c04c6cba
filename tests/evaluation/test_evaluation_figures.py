"""Figures of an evaluation: all are drawn, whatever the results, and drawn alike every time."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import evaluation_examples as examples
import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from shapeconcepts.evaluation.report import draw_all, save_figures
from shapeconcepts.evaluation.report.annexation_curve import draw_annexation_curve
from shapeconcepts.evaluation.report.barcode import draw_barcode
from shapeconcepts.evaluation.report.baseline_comparison import draw_baseline_comparison
from shapeconcepts.evaluation.report.figure_files import figure_bytes
from shapeconcepts.evaluation.report.label_colours import label_colours, shortened
from shapeconcepts.evaluation.report.levels import draw_levels
from shapeconcepts.evaluation.report.ranked_concepts import draw_ranked_concepts
from shapeconcepts.evaluation.report.region_matrices import draw_labels_within_regions
from shapeconcepts.evaluation.report.selection_surfaces import draw_purity_surface
from shapeconcepts.report.palette import LABEL_COLOURS

ALL = {
    "barcode", "annexations", "concepts", "barcode_paper", "annexations_paper", "concepts_paper", "levels",
    "purity", "error", "purity_error", "map", "labels_in_regions", "regions_of_labels", "baselines",
}  # fmt: skip
LABEL_SETS = {
    "seven": examples.SEVEN,
    "one": ["box"],
    "twenty": examples.TWENTY,
    "long": examples.LONG,
    "hostile": examples.HOSTILE,
}


def texts_of(figure: Figure) -> list[Text]:
    """All texts that are seen, in place."""
    FigureCanvasAgg(figure).draw()
    out_of_view = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in axis.get_major_ticks():
                if not low - 1e-9 <= tick.get_loc() <= high + 1e-9:
                    out_of_view |= {tick.label1, tick.label2}
            if not axes.axison:
                out_of_view.add(axis.label)
    texts = set(figure.findobj(Text)) - out_of_view
    return sorted((one for one in texts if one.get_visible() and one.get_text()), key=Text.get_text)


def words_of(figure: Figure) -> list[str]:
    return [text.get_text() for text in texts_of(figure)]


@pytest.mark.parametrize(("name", "repetitions"), [*((name, 3) for name in LABEL_SETS), ("seven", 1)])
def test_every_figure_is_drawn_and_saved(tmp_path, name, repetitions):
    figures = draw_all(examples.evaluation(LABEL_SETS[name], repetitions))
    assert set(figures) == ALL
    paths = save_figures(figures, tmp_path / "new" / "folder")
    assert {path.name for path in paths} == {f"{one}.{kind}" for one in ALL for kind in ("png", "svg")}
    for one, figure in figures.items():
        assert figure.get_figwidth() in (3.5, 7.0)
        with Image.open(tmp_path / "new" / "folder" / f"{one}.png") as picture:
            assert picture.width == round(200 * figure.get_figwidth())
            assert abs(picture.height - 200 * figure.get_figheight()) <= 1
            assert len(picture.convert("RGB").getcolors(1 << 20)) > 10
        ElementTree.parse(tmp_path / "new" / "folder" / f"{one}.svg")


def test_only_what_there_are_results_for_is_drawn():
    assert set(draw_all(examples.nothing_found())) == {"barcode", "annexations", "concepts"}


@pytest.mark.parametrize("name", LABEL_SETS)
def test_no_text_lies_over_another_or_outside(name):
    for one, figure in draw_all(examples.evaluation(LABEL_SETS[name])).items():
        texts = texts_of(figure)
        # Turned text has no upright box; its neighbours are as far away as the cells of its matrix.
        upright = [text for text in texts if text.get_rotation() != 45 and text.axes is not None]
        boxes = [text.get_window_extent() for text in upright]
        for i, box in enumerate(boxes):
            for other in range(i):
                shared = min(box.x1, boxes[other].x1) - max(box.x0, boxes[other].x0)
                high = min(box.y1, boxes[other].y1) - max(box.y0, boxes[other].y0)
                is_clear = shared < 1 or high < 1.5
                assert is_clear, (one, upright[i].get_text(), upright[other].get_text())
        width, height = figure.bbox.size
        for text in texts:
            box = text.get_window_extent()
            assert box.x0 > -1 and box.y0 > -1 and box.x1 < width + 1 and box.y1 < height + 1, (one, text)


def test_drawing_twice_gives_the_same_bytes():
    first, second = (draw_all(examples.evaluation(repetitions=2)) for _ in range(2))
    for name in ALL:
        assert figure_bytes(first[name], "svg") == figure_bytes(second[name], "svg"), name
        assert figure_bytes(first[name], "png") == figure_bytes(second[name], "png"), name


def test_a_file_does_not_say_when_it_was_made():
    content = figure_bytes(draw_levels(examples.evaluation().levels), "svg")
    assert b"metadata" not in content and b"date" not in content.lower()


def test_settings_of_the_user_are_neither_used_nor_changed():
    plain = figure_bytes(draw_barcode(examples.filtration()), "svg")
    with matplotlib.rc_context(
        {"font.size": 31, "lines.linewidth": 9, "axes.grid": True, "svg.hashsalt": "x"}
    ):
        before = dict(matplotlib.rcParams)
        assert figure_bytes(draw_barcode(examples.filtration()), "svg") == plain
        assert dict(matplotlib.rcParams) == before


def test_pyplot_is_left_alone():
    code = (
        "import sys, shapeconcepts.evaluation.report\n"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_package_does_not_load_matplotlib():
    code = "import sys, shapeconcepts.report, shapeconcepts.cli\nassert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_label_has_one_colour_for_each_of_24_labels():
    colours = label_colours(f"label {i:02}" for i in range(24))
    assert len(set(colours.values())) == 24
    assert colours["label 00"] == pytest.approx(LABEL_COLOURS[0] / 255)
    assert len(set(label_colours(map(str, range(48))).values())) == 48


def test_the_report_of_a_model_has_the_same_label_colours():
    from importlib.resources import files

    script = (files("shapeconcepts.html_page") / "templates" / "colours.js").read_text("utf-8")
    listed = re.search(r"LABEL_COLOURS = \[(.*?)\]", script, re.DOTALL)[1]
    theirs = [to_rgb(colour) for colour in re.findall(r"#\w{6}", listed)]
    np.testing.assert_allclose(theirs, LABEL_COLOURS / 255)


def test_the_barcode_has_a_bar_for_every_class():
    figure = draw_barcode(examples.filtration(20))
    x = np.asarray(figure.axes[0].lines[0].get_xdata())
    bars = x.reshape(-1, 3)
    assert len(bars) == 20 and np.isnan(bars[:, 2]).all()
    deaths = examples.filtration(20).diagram[:, 1]
    np.testing.assert_array_equal(bars[:, 1], np.sort(np.minimum(deaths, 1)))


def test_stopping_times_are_marked_where_they_are():
    filtration = examples.filtration()
    for figure in (draw_barcode(filtration), draw_annexation_curve(filtration)):
        words = words_of(figure)
        assert r"$\epsilon_{max}$ = 0.48" in words and "ours = 0.61" in words
    without = replace(filtration, epsilon_max=None, concept_time=None)
    assert not any("=" in word for word in words_of(draw_barcode(without)))


@pytest.mark.parametrize("times", [(0.5, 0.5), (0.0, 1.0), (0.02, 0.04), (0.99, 0.97), (None, 0.3)])
def test_names_of_stopping_times_never_meet(times):
    figure = draw_annexation_curve(
        replace(examples.filtration(), epsilon_max=times[0], concept_time=times[1])
    )
    names = [text.get_window_extent() for text in texts_of(figure) if " = " in text.get_text()]
    assert len(names) == sum(time is not None for time in times)
    if len(names) == 2:
        assert not names[0].overlaps(names[1])
    for box in names:
        assert box.x0 >= 0 and box.x1 <= figure.bbox.width


def test_bars_of_concepts_have_the_proportions_and_stack_to_one():
    evaluation = examples.evaluation()
    bars = evaluation.selections[0].bars
    figure = draw_ranked_concepts(bars, label_colours(examples.SEVEN))
    shares = figure.axes[0].patches
    assert len(shares) == sum(len(bar.proportions) for bar in bars)
    colours = label_colours(examples.SEVEN)
    for i, bar in enumerate(bars, start=1):
        drawn = [one for one in shares if abs(one.get_x() + one.get_width() / 2 - i) < 1e-9]
        assert sum(one.get_height() for one in drawn) == pytest.approx(1)
        assert {(round(one.get_height(), 9), one.get_facecolor()[:3]) for one in drawn} == {
            (round(share, 9), colours[label]) for label, share in bar.proportions.items()
        }
    assert [str(bar.size) for bar in bars] == [text.get_text() for text in figure.axes[1].texts]


def test_many_concepts_are_drawn():
    bars = examples.bars(examples.SEVEN, 400, np.random.default_rng(0))
    figure = draw_ranked_concepts(bars, label_colours(examples.SEVEN))
    assert not figure.axes[1].texts


def test_empty_cells_of_a_surface_stay_empty():
    supervised = examples.evaluation().supervised
    mesh = draw_purity_surface(supervised).axes[0].collections[0].get_array()
    np.testing.assert_array_equal(np.ma.getmaskarray(mesh), np.isnan(supervised.purity.T))
    np.testing.assert_allclose(mesh.compressed(), 100 * supervised.purity.T[~np.isnan(supervised.purity.T)])


def test_a_surface_that_was_never_reached_says_so():
    supervised = examples.evaluation().supervised
    nowhere = np.full_like(supervised.purity, np.nan)
    empty = replace(supervised, purity=nowhere, error=nowhere, chosen_purity=np.nan, chosen_error=np.nan)
    evaluation = replace(examples.evaluation(repetitions=1), supervised=empty)
    for name in ("purity", "error", "purity_error"):
        assert "no number of concepts was reached" in words_of(draw_all(evaluation)[name])


def test_scores_that_are_no_numbers_leave_gaps():
    evaluation = examples.evaluation(repetitions=1)
    levels = replace(
        evaluation.levels,
        scores=[[examples.NO_GROUPS], *evaluation.levels.scores[1:]],
        errors=[[np.nan], *evaluation.levels.errors[1:]],
    )
    lines = draw_levels(levels).axes[0].lines
    assert np.isnan(lines[0].get_ydata()[0]) and np.isfinite(lines[0].get_ydata()[1:]).all()
    empty = replace(evaluation.baselines[0], scores=[examples.NO_GROUPS])
    figure = draw_baseline_comparison([empty, *evaluation.baselines], evaluation.selections)
    assert figure.axes[0].get_yticklabels()[-1].get_text() == f"{empty.representation}, {empty.grouping}"


def test_baselines_stand_in_the_order_of_their_information():
    evaluation = examples.evaluation()
    axes = draw_baseline_comparison(evaluation.baselines, evaluation.selections).axes[0]
    middles = [float(line.get_xdata()[0]) for line in axes.lines if len(line.get_xdata()) == 1]
    assert middles == sorted(middles, reverse=True)
    expected = np.median([one.adjusted_mutual_information for one in evaluation.selections[0].scores])
    (at,) = [
        i for i, text in enumerate(axes.get_yticklabels()) if text.get_text() == "shapeconcepts, default"
    ]
    assert middles[at] == pytest.approx(expected)
    assert axes.get_yticklabels()[at].get_fontweight() == "bold"


def test_no_more_baselines_than_fit_on_a_page_are_drawn():
    evaluation = examples.evaluation()
    many = [
        replace(evaluation.baselines[0], grouping=f"number {i}", scores=[examples.scores(i / 100)])
        for i in range(60)
    ]
    axes = draw_baseline_comparison(many, evaluation.selections).axes
    names = [text.get_text() for text in axes[0].get_yticklabels()]
    assert names[:2] == ["shapeconcepts, default", "shapeconcepts, paper"]
    assert names[2:] == [f"{many[0].representation}, number {i}" for i in range(59, 35, -1)]
    assert [one.get_title("left") for one in axes] == ["information", "B-cubed F1", "objects explained (%)"]


def test_cells_of_a_matrix_hold_its_numbers():
    result = replace(
        examples.evaluation(["a", "b"]).map, region_of_labels=np.array([[0.998, 0.002], [0.0, 1.0]])
    )
    axes = draw_labels_within_regions(result).axes[0]
    assert {(*text.get_position(), text.get_text()) for text in axes.texts} == {
        (0, 0, "100"), (1, 0, "<1"), (1, 1, "100"),
    }  # fmt: skip


def test_names_are_shortened_in_the_middle():
    assert shortened("can") == "can"
    assert shortened("x" * 24) == "x" * 24
    assert shortened("a" * 20 + "b" * 20) == "a" * 12 + "…" + "b" * 11
    assert shortened("new\nline") == "new line"


def test_names_are_text_and_not_formulas():
    figures = draw_all(examples.evaluation(examples.HOSTILE))
    words = words_of(figures["concepts"])
    assert "$x^2$ & $\\frac{" in words and "_hidden" in words
    assert not any(text.get_parse_math() for text in texts_of(figures["labels_in_regions"]))
