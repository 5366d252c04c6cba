"""Takes the pictures report*.png and concept_tree.png in docs/images from a report that `learn` wrote.

python docs/report_pictures.py REPORT.html   # needs playwright, and a Chromium on the path
"""

import io
import shutil
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).parent / "images"
QUIET = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]


def save(screenshot: bytes, name: str, box: tuple[int, int, int, int] | None = None) -> None:
    """A palette of 256 colours takes less than half of the space."""
    picture = Image.open(io.BytesIO(screenshot)).convert("RGB").crop(box)
    picture.quantize(256, method=Image.Quantize.MEDIANCUT).save(IMAGES / name, optimize=True)


if __name__ == "__main__":
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=QUIET)
        page = browser.new_page(viewport={"width": 1200, "height": 900}, reduced_motion="reduce")
        page.goto(Path(sys.argv[1]).resolve().as_uri())
        page.wait_for_selector("html[data-ready]", state="attached")
        save(page.screenshot(), "report.png")

        # In a picture as tall as the page, controls that stick would cover the figures.
        page.evaluate("document.querySelector('.controls').style.position = 'static'")
        page.locator("#how").scroll_into_view_if_needed()
        top = page.locator("#how").bounding_box()
        first, last = page.locator(".controls").bounding_box(), page.locator("canvas.timeline").bounding_box()
        upper, lower = first["y"] - top["y"] - 8, last["y"] + last["height"] - top["y"] + 8
        save(page.locator("#how").screenshot(), "report_figures.png", (16, int(upper), 1184, int(lower)))
        save(page.locator("svg.granularity").screenshot(), "concept_tree.png")
        browser.close()
