"""The main job on the three shared data sets: what is learned, the model file, the report in a browser.

    python benchmarks/report.py [--keep FOLDER]

For each set, and for all scans together, a model is learned with default parameters, saved, loaded, and its
report written. "usable" is the time from opening the report in a headless Chromium until its figures are
drawn, where Chromium and Playwright are installed. --keep keeps models and reports in a folder.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import shutil
import tempfile
import time
import warnings
from pathlib import Path

from common import SHARED_DATA, command, print_table, scans_in
from shapeconcepts import ShapeConceptModel, load_model, segment
from shapeconcepts.report.html import preview, write_report

SETS = ("osd_learn", "seven_shapes", "restaurant_views")
REPEATS = 5
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


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where to keep models and reports")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    segmented = {name: [segment(scan) for scan in scans_in(parser, SHARED_DATA / name)] for name in SETS}
    segmented["all together"] = [one for objects in segmented.values() for one in objects]
    table = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
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


if __name__ == "__main__":
    main()
