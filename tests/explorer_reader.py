"""An explorer as somebody uses it: the command in a process of its own, and a page in a real browser."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.request import Request, urlopen

from shapeconcepts.explorer.server import ExplorerServer
from shapeconcepts.explorer.session import Session
from shapeconcepts.explorer.telling import Telling


@contextmanager
def explored(model: Path, *places: Path) -> Iterator[str]:
    """Address of an explorer that runs meanwhile."""
    command = [sys.executable, "-m", "shapeconcepts", "explore", str(model), "--no-browser", "--no-cache"]
    command += [argument for place in places for argument in ("--scans", str(place))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process.stdout.readline().strip()
        finally:
            process.kill()


@contextmanager
def window_on(browser, session: Session) -> Iterator["Window"]:
    """A window on a session, whose model need not be read yet."""
    telling = Telling(session, remember=False)
    server = ExplorerServer(telling)
    server.start()
    try:
        window = Window(browser, server.address)
        window.page.goto(window.address)
        window.page.wait_for_selector("html[data-ready]", state="attached")
        yield window
        window.close()
    finally:
        session.close()
        server.stop()
        telling.close()


class Window:
    """A page of an explorer, with everything that it complained about and asked for."""

    def __init__(self, browser, address: str, width: int = 1440, height: int = 900, scheme: str = "light"):
        self.address = address
        self.context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme=scheme, reduced_motion="reduce"
        )
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        # Chromium tells of each answer that says that the model is still being read.
        self.page.on("console", lambda message: "503" in message.text or self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.set_default_timeout(15_000)

    def open(self) -> "Window":
        self.page.goto(self.address)
        self.page.wait_for_selector("html[data-ready]", state="attached", timeout=60_000)
        # What comes first tells of the model's outline.
        self.page.wait_for_function(
            "() => !document.body.dataset.model.startsWith('outline')", timeout=60_000
        )
        return self

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def state(self) -> dict:
        """What the server holds, which is what counts."""
        return json.loads(urlopen(f"{self.address}api/state").read())

    def edit(self, **document: object) -> dict:
        """An edit that comes from elsewhere."""
        body, headers = json.dumps(document).encode(), {"Content-Type": "application/json"}
        return json.loads(urlopen(Request(f"{self.address}api/edit", body, headers)).read())

    def edits(self) -> list[str]:
        """Kinds of the edits that are in force."""
        return [edit["kind"] for edit in self.state()["journal"] if not edit["undone"]]

    def made(self, n: int) -> dict:
        """The state once so many edits are in force, of which the page tells, and no dialog is open."""
        self.page.wait_for_function(
            "n => Number(document.body.dataset.edits) === n && !document.getElementById('dialog').open",
            arg=n,
            polling=20,
        )
        return self.state()

    def choose_concept(self, key: int) -> None:
        self.page.locator(f"#left a[href='#concept/{key}']").click()
        self.page.wait_for_function("key => location.hash === `#concept/${key}`", arg=key)

    def tile(self, at: int):
        return self.page.locator(f".tile[aria-posinset='{at + 1}']:not([aria-hidden])")

    def close(self) -> None:
        self.page.unroute_all(behavior="ignoreErrors")
        self.context.close()


def opened(browser, address: str) -> Iterator[Window]:
    """A window on the model as it was learned."""
    window = Window(browser, address).open()
    # What is found out meanwhile changes the order of scans.
    window.page.wait_for_function(
        "() => ![...document.querySelectorAll('#left .count')].some((count) => count.textContent === '…')"
    )
    while window.state()["canUndo"]:
        window.edit(kind="undo")
    window.made(0)
    yield window
    window.close()
