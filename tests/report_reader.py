"""A report as somebody sees it who opens it in a real browser."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"]
QUIET += ["--disable-background-networking", "--disable-component-update", "--disable-sync"]

# Counts every 3-D context that a page asks for.
COUNT_CONTEXTS = """
window.contexts = 0;
const original = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  if (kind !== "2d") window.contexts += 1;
  return original.call(this, kind, ...rest);
};
"""


class Reader:
    """A page, with everything that it complained about and asked the network for.

    It closes the page before it, for which nobody waits any more.
    """

    def __init__(self, browser, path: Path, width: int = 1200, height: int = 900):
        for old in browser.contexts:
            old.close()
        self.page = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce")
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.set_default_timeout(10_000)
        self.page.add_init_script(COUNT_CONTEXTS)
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("html[data-ready]", state="attached")

    def settle(self) -> None:
        """Wait until what was asked for has been drawn: changes are drawn in the next frame."""
        frame = "() => new Promise(done => requestAnimationFrame(() => setTimeout(done, 30)))"
        for _ in range(3):
            self.page.evaluate(frame)

    def pixels(self, selector: str, at: int = 0) -> str:
        return self.page.evaluate(
            "([selector, at]) => document.querySelectorAll(selector)[at].toDataURL()", [selector, at]
        )


def started_browser() -> Iterator[object]:
    """A Chromium; skips the tests that want one where there is none."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    if CHROMIUM is None:
        pytest.skip("needs a Chromium on the path, and there is none")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield browser
        browser.close()
