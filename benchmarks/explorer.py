"""The page of `shapeconcepts explore` in a headless Chromium without a graphics card.

    python benchmarks/explorer.py MODEL [--scans FOLDER] [--repeats N]

From the start of the command, with its kernels compiled, until the address is said and until the page shows
concepts and gallery; from asking for the page until then, while the model is there; frames a second while the
gallery is scrolled through and the slider of granularity is moved; from an edit until another window has it;
and the memory of a page's process. The first start is one without what an earlier one left in the user's
cache; of later starts it is the median. They are of a copy of the model, so that its journal stays as it is.
"""

import os
import shutil
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from common import command, print_table
from report import BROWSER
from shapeconcepts import load_model

SECONDS = 4.0
# Frames that are drawn while something is moved by a step in each of them.
FRAMES_WHILE = """async ([selector, seconds, way]) => {
  const thing = document.querySelector(selector);
  const start = performance.now();
  let frames = 0, longest = 0, last = start;
  while (performance.now() - start < 1000 * seconds) {
    await new Promise(requestAnimationFrame);
    const now = performance.now();
    longest = Math.max(longest, now - last);
    last = now;
    frames += 1;
    if (way === "scroll") thing.scrollTop += 60;
    else {
      thing.value = frames % (Number(thing.max) + 1);
      thing.dispatchEvent(new Event("input", { bubbles: true }));
    }
  }
  return [frames / ((last - start) / 1000), longest];
}"""


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("model", type=Path)
    parser.add_argument("--scans", type=Path)
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    options = parser.parse_args()
    n_scans = len(load_model(options.model).scan_names_)
    found: dict[str, list[float]] = {}
    with TemporaryDirectory() as cache, sync_playwright() as playwright:
        options.model = Path(shutil.copy(options.model, cache))
        # Chromium alone takes a second to start, which is not the page's.
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=list(BROWSER))
        for _ in range(options.repeats):
            for name, value in measured(options, browser, {**os.environ, "XDG_CACHE_HOME": cache}).items():
                found.setdefault(name, []).append(value)
        browser.close()
    rows = [
        [name, f"{values[0]:.2f}", f"{statistics.median(values[1:] or values):.2f}"]
        for name, values in found.items()
    ]
    print_table([f"{n_scans:,} scans", "first start", "later starts"], rows)


def measured(options: Any, browser: Browser, environment: dict[str, str]) -> dict[str, float]:
    """What one start of the command gives."""
    arguments = [sys.executable, "-m", "shapeconcepts", "explore", str(options.model), "--no-browser"]
    if options.scans:
        arguments += ["--scans", str(options.scans)]
    start = time.perf_counter()
    server = subprocess.Popen(
        arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment
    )
    try:
        assert server.stdout is not None
        address = server.stdout.readline().split()[-1]
        found = {"address said, s": time.perf_counter() - start}
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        opened(page, address)
        found["first picture after the command, s"] = time.perf_counter() - start
        again = browser.new_page(viewport={"width": 1440, "height": 900})
        asked = time.perf_counter()
        opened(again, address)
        found["first picture after asking for the page, s"] = time.perf_counter() - asked
        while page.evaluate("fetch('api/state').then((told) => told.json()).then((now) => now.isThinking)"):
            time.sleep(0.2)
        page.evaluate("window.location.hash = 'all'")
        for name, selector, way in (
            ("scrolling", ".gallery-scroller", "scroll"),
            ("slider", "#slider input[type=range]", "slide"),
        ):
            frames, longest = page.evaluate(FRAMES_WHILE, [selector, SECONDS, way])
            found[f"{name}, frames a second"] = frames
            found[f"{name}, longest frame, ms"] = longest
        # The first one waits for the model where the page was there before it.
        seconds_until_seen(page, again)
        found["edit until another window shows it, s"] = seconds_until_seen(page, again)
        found["memory of the page, MB"] = memory_of_pages() / 2
        page.close()
        again.close()
        # What is shown is kept for the next start soon after an edit.
        time.sleep(3)
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait()
    return found


def opened(page: Page, address: str) -> None:
    page.goto(address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=120_000)


def seconds_until_seen(page: Page, other: Page) -> float:
    """From an edit in one window until another one has it, and back to what was before."""
    name = f"seen {time.time()}"
    key = page.evaluate(
        "fetch('api/state').then((answer) => answer.json()).then((state) => state.concepts[0].key)"
    )
    say = """async (edit) => { await fetch('api/edit', { method: 'POST', body: JSON.stringify(edit),
      headers: { 'Content-Type': 'application/json' } }); }"""
    start = time.perf_counter()
    page.evaluate(say, {"kind": "rename", "key": key, "name": name})
    other.wait_for_function("(name) => document.body.textContent.includes(name)", arg=name, timeout=60_000)
    seconds = time.perf_counter() - start
    page.evaluate(say, {"kind": "undo"})
    return seconds


def memory_of_pages() -> float:
    """Memory of the processes that draw pages, in MB, with their parts of what is shared."""
    total = 0
    for folder in Path("/proc").iterdir():
        try:
            if b"--type=renderer" not in (folder / "cmdline").read_bytes():
                continue
            lines = (folder / "smaps_rollup").read_text().splitlines()
        except OSError:
            continue
        total += sum(int(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return total / 1e3


if __name__ == "__main__":
    main()
