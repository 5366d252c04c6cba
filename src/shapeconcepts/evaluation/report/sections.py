"""Sections of the page: what is asked, the tables, the figures."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from shapeconcepts.evaluation.paper import PAPER
from shapeconcepts.evaluation.report.captions import captions
from shapeconcepts.evaluation.report.inline_svg import inline_svg
from shapeconcepts.evaluation.report.motif_gain import motif_gain_table, motif_gains
from shapeconcepts.evaluation.report.number_formats import percent
from shapeconcepts.evaluation.report.result_tables import (
    baseline_table,
    error_table,
    headline_table,
    hidden_table,
)
from shapeconcepts.evaluation.report.style import COLUMN_WIDTH
from shapeconcepts.evaluation.report.tables import table
from shapeconcepts.evaluation.report.verdict import verdict

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation, MapResult


@dataclass(frozen=True)
class Section:
    """A part of the page; `parts` are markup."""

    name: str
    title: str
    parts: list[str]

    def markup(self) -> str:
        """The whole section."""
        inside = "\n".join(part for part in self.parts if part)
        heading = f"<h2>{html.escape(self.title)}</h2>"
        return f'<section id="{self.name}" class="narrow">\n{heading}\n{inside}\n</section>'


def sections(evaluation: Evaluation, figures: Mapping[str, Figure]) -> list[Section]:
    """Those that there are results for, in the order of the paper."""
    texts = captions(evaluation)

    def drawn(*names: str) -> str:
        cards = [_card(name, figures[name], *texts[name]) for name in names if name in figures]
        return '<div class="figure-grid">\n' + "\n".join(cards) + "\n</div>" if cards else ""

    def of_preset(number: int) -> str:
        suffix = f"_{evaluation.selections[number].preset}" if number else ""
        return drawn(*(f"{kind}{suffix}" for kind in ("barcode", "annexations", "concepts")))

    made = [
        Section("headline", "Beside the paper", _headline(evaluation)),
        Section("baselines", "Beside the baselines", [*_baselines(evaluation), drawn("baselines")]),
        Section(
            "unsupervised",
            "Concepts without labels",
            [
                _UNSUPERVISED,
                *map(of_preset, range(len(evaluation.selections))),
                "<h3>Classification error by label (the paper’s table 1)</h3>",
                error_table(
                    [(f"ours, {one.preset}", one.errors) for one in evaluation.selections],
                    PAPER.unsupervised_errors,
                ),
            ],
        ),
    ]
    if evaluation.hidden is not None:
        made.append(
            Section("hidden", "Hidden parts and foreign points", [_HIDDEN, hidden_table(evaluation.hidden)])
        )
    if evaluation.levels is not None:
        made.append(Section("levels", "Dictionary levels", [drawn("levels")]))
    if evaluation.supervised is not None:
        errors = error_table([("ours", evaluation.supervised.errors)], PAPER.supervised_errors)
        made.append(
            Section(
                "supervised",
                "Concepts chosen with labels",
                [
                    _SUPERVISED,
                    drawn("purity", "error", "purity_error"),
                    "<h3>Classification error by label (the paper’s table 2)</h3>",
                    errors,
                ],
            )
        )
    if evaluation.map is not None:
        figures_of_map = drawn("map", "labels_in_regions", "regions_of_labels")
        made.append(Section("data-sets", "Across data sets", [figures_of_map, *_regions(evaluation.map)]))
    made.append(Section("made", "How this was made", _made(evaluation)))
    return [one for one in made if any(one.parts)]


_OUR_FEATURES = ("concept responses", "motif stimuli")
_UNSUPERVISED = (
    "<p>The filtration is stopped without looking at a label, and what hangs together then is a concept. "
    "An SVM on the "
    "responses to the concepts is the test of what they are worth as features.</p>"
)
_HIDDEN = (
    "<p>Test objects are recognised as they are, and again with a third to two thirds hidden beyond a "
    "straight border or behind something round, or without some of their segments; and with something "
    "foreign, a fifth of all points: a part of an object of another label, or a table. The right concept is "
    "one "
    "whose most frequent label is the object’s; motifs tell the label of whose training objects an object "
    "reminds most, and histograms the majority label of the five nearest. Shares of errors, medians over "
    "the splits.</p>"
)
_SUPERVISED = (
    "<p>The number and the minimum size of the concepts are chosen by cross-validation with the labels, to "
    "see how "
    "much the choice without labels leaves on the table.</p>"
)


def _headline(evaluation: Evaluation) -> list[str]:
    note = "The paper’s column is of its own scans, ours of those named above."
    if evaluation.repetitions > 1:
        note = (
            f"Median over {evaluation.repetitions} splits, and under it the smallest and the largest; "
            f"errors are means, as in the paper. {note}"
        )
    return [f"<p>{note}</p>", headline_table(evaluation)]


def _baselines(evaluation: Evaluation) -> list[str]:
    parts = []
    if evaluation.baselines:
        note = (
            "The best in each column is bold. A group has at least two objects; explained are the objects "
            "in a group "
            "whose majority label is theirs. Many small groups are pure and explain much, but share little "
            "information "
            "with the labels."
        )
        parts += [
            f"<p><strong>{html.escape(verdict(evaluation))}</strong> {note}</p>",
            baseline_table(evaluation),
        ]
        gains = motif_gains(evaluation)
        if any(gains.values()):
            parts += ["<h3>What the motifs add to whole-object histograms</h3>", motif_gain_table(gains)]
    if evaluation.classifications:
        rows = [(f"concept responses, {one.preset}", one.errors) for one in evaluation.selections]
        rows += [(row.representation, row.errors) for row in evaluation.classifications]
        ours = [i for i, (name, _) in enumerate(rows) if name.startswith(_OUR_FEATURES)]
        parts += [
            "<h3>Classification error by what the SVM is given</h3>",
            error_table(rows, ours=ours),
        ]
    return parts


def _regions(result: MapResult) -> list[str]:
    parts = []
    for title, shares in (
        ("Objects in a region of their own label", result.nearest_region_right),
        ("The same, where only the objects trained on decide on regions", result.nearest_trained_right),
    ):
        if not any(shares.values()):
            continue
        labels = [one for one in result.label_names if any(one in of_set for of_set in shares.values())]
        rows = [[name, *(percent(of_set.get(one)) for one in labels)] for name, of_set in shares.items()]
        parts += [f"<h3>{title}</h3>", table(["data set", *labels], rows)]
    left_out = [f"{count} of {name}" for name, count in result.unplaced.items() if count]
    if left_out:
        parts.append(
            f"<p>Without any stimulus, and so not on the map: {html.escape(', '.join(left_out))}.</p>"
        )
    return parts


def _made(evaluation: Evaluation) -> list[str]:
    parts = [f"<pre>{html.escape(evaluation.command)}</pre>"]
    parts += [
        "<h3>Objects</h3>",
        table(["label", "objects"], [[k, str(n)] for k, n in evaluation.labels.items()]),
    ]
    left_out = [
        [f"training objects without any stimulus, {one.preset}", str(one.unplaced)]
        for one in evaluation.selections
        if one.unplaced
    ]
    left_out += [list(pair) for pair in evaluation.skipped]
    if left_out:
        parts += ["<h3>Left out</h3>", table(["what", "how many, or why"], left_out)]
    if evaluation.seconds:
        seconds = [[name, f"{time:.1f} s"] for name, time in evaluation.seconds.items()]
        parts += ["<h3>Time</h3>", table(["experiment", "time"], seconds)]
    if evaluation.versions:
        parts += [
            "<h3>Versions</h3>",
            table(["library", "version"], [list(pair) for pair in evaluation.versions.items()]),
        ]
    return parts


def _card(name: str, figure: Figure, title: str, caption: str) -> str:
    wide = " is-wide" if figure.get_figwidth() > COLUMN_WIDTH else ""
    return (
        f'<figure class="card{wide}" id="figure-{name}">\n<h3>{html.escape(title)}</h3>\n'
        f"{inline_svg(figure, name, title)}\n<figcaption>{html.escape(caption)}</figcaption>\n</figure>"
    )
