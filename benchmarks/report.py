"""The main job on the three shared data sets: what is learned, the model file, the report in a browser.

    python benchmarks/report.py [--keep FOLDER]
    python benchmarks/report.py --scans N ... [--keep FOLDER]

For each set, and for all scans together, a model is learned with default parameters, saved, loaded, and its
report written. "usable" is the time from opening the report in a headless Chromium until its figures are
drawn, where Chromium and Playwright are installed. --keep keeps models and reports in a folder.

With --scans only the report is measured, of models of so many scans: their stimuli are drawn at random around
40 kinds of very different frequency, one scan in fifty is like no other, and one in a thousand has none; the
pictures are those of a few simulated scans, again and again.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import shutil
import tempfile
import time
import warnings
from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix

from common import SHARED_DATA, command, print_table, scans_in, simulated_scans
from shapeconcepts import ConceptResponse, Filtration, ShapeConceptModel, load_model, segment
from shapeconcepts.report.html import preview, write_report

SETS = ("osd_learn", "seven_shapes", "restaurant_views")
REPEATS = 5
KINDS, OWN_COLUMNS = 40, 12
CATEGORIES = ("box", "can", "ball")
PICTURES_OF_EACH = 4
BROWSER = ("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync")


def milliseconds(function, *arguments) -> float:
    start = time.perf_counter()
    function(*arguments)
    return 1e3 * (time.perf_counter() - start)


def usable_after(report: Path) -> str:
    """Seconds from opening a report until it is drawn; "-" without a browser."""
    chromium = shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return "-"
    if chromium is None:
        return "-"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(BROWSER))
        page = browser.new_page()
        page.goto(report.resolve().as_uri())
        page.wait_for_selector("html[data-ready]", state="attached")
        ready = int(page.evaluate("document.documentElement.dataset.ready"))
        browser.close()
    return f"{ready / 1e3:.2f}"


def random_model(n: int) -> ShapeConceptModel:
    """As much of a model of n scans as a report needs."""
    rng = np.random.default_rng(0)
    kinds = rng.choice(KINDS, n, p=rng.dirichlet(np.full(KINDS, 0.7)))
    kinds[rng.random(n) < 0.02] = -1
    of_kind = np.array([rng.permutation(10 * KINDS)[:OWN_COLUMNS] for _ in range(KINDS)])
    columns = of_kind[kinds]
    columns[kinds < 0] = 10 * KINDS + np.arange(n * OWN_COLUMNS).reshape(n, OWN_COLUMNS)[kinds < 0]
    values = rng.gamma(1.5, size=columns.shape)
    values[rng.random(n) < 0.001] = 0
    starts = np.arange(0, values.size + 1, OWN_COLUMNS)
    stimuli = csr_matrix((values.ravel(), columns.ravel(), starts), (n, 10 * KINDS + n * OWN_COLUMNS))
    stimuli.eliminate_zeros()
    model = ShapeConceptModel()
    model.stimuli_, model.skipped_ = stimuli, {}
    model.history_, model.response_ = (), ConceptResponse()
    model._waiting = []
    model.scan_names_ = [f"kind_{kind}/scan_{i:06}.pcd" for i, kind in enumerate(kinds)]
    model.scan_labels_ = [None if kind < 0 else f"kind_{kind % 12}" for kind in kinds]
    model.filtration_ = Filtration().fit(stimuli)
    model.concepts_, model.labels_ = model.filtration_.concepts_, model.filtration_.labels_
    model.concept_tree_ = model.filtration_.concept_tree_
    return model


def print_many_scans(options: Namespace, folder: Path) -> None:
    """Measure the reports of models of random stimuli."""
    scans = [scan for category in CATEGORIES for scan in simulated_scans(category, PICTURES_OF_EACH, 0)]
    pictures = [preview(segment(scan)) for scan in scans]
    table = []
    for n in options.scans:
        model, report = random_model(n), folder / f"{n}.html"
        writing = milliseconds(write_report, report, model, [pictures[i % len(pictures)] for i in range(n)])
        sizes = [len(model.concepts_), (model.labels_ >= 0).sum(), f"{report.stat().st_size / 1e6:.2f}"]
        table.append([n, *sizes, f"{writing / 1e3:.2f}", usable_after(report)])
    titles = ("scans", "concepts", "scans in one", "report, MB", "written in, s", "usable after, s")
    print_table(titles, table)


def print_shared_sets(parser: ArgumentParser, folder: Path) -> None:
    """Measure what is learned from the shared sets, its file and its report."""
    segmented = {name: [segment(scan) for scan in scans_in(parser, SHARED_DATA / name)] for name in SETS}
    segmented["all together"] = [one for objects in segmented.values() for one in objects]
    table = []
    for name, objects in segmented.items():
        model = ShapeConceptModel().fit(objects)
        file, report = folder / f"{name}.safetensors", folder / f"{name}.html"
        saving = min(milliseconds(model.save, file) for _ in range(REPEATS))
        loading = min(milliseconds(load_model, file) for _ in range(REPEATS))
        writing = milliseconds(write_report, report, model, [preview(one) for one in objects])
        table.append(
            [
                name,
                len(objects),
                len(model.concepts_),
                (model.labels_ >= 0).sum(),
                f"{file.stat().st_size / 1e6:.2f}",
                f"{saving:.0f} / {loading:.0f}",
                f"{report.stat().st_size / 1e6:.2f}",
                f"{writing / 1e3:.2f}",
                usable_after(report),
            ]
        )
    print_table(
        (
            "",
            "scans",
            "concepts",
            "scans in one",
            "model, MB",
            "save / load, ms",
            "report, MB",
            "written in, s",
            "usable after, s",
        ),
        table,
    )


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where to keep models and reports")
    parser.add_argument("--scans", type=int, nargs="+", metavar="N", help="sizes of random models")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        if options.scans:
            print_many_scans(options, folder)
        else:
            print_shared_sets(parser, folder)


if __name__ == "__main__":
    main()
