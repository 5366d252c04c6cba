"""What the explorer's page shows, in a real browser before a real server."""

import json

import pytest

from explorer_reader import Window, explored
from report_models import HOSTILE


def test_concepts_come_first_with_pictures(window):
    page = window.page
    concepts = window.state()["concepts"]
    assert page.locator("#left .concepts li").count() == len(concepts)
    assert page.locator(".gallery-header").count() >= 2
    page.wait_for_function(
        "() => document.querySelector('.tile canvas').toDataURL().length > 2000", polling=500
    )
    window.tile(0).click()
    page.wait_for_selector("#right .motifs li")
    assert page.locator("#right .wide-scans button").count() >= 4
    assert "surfaces" in page.locator("#right dl").inner_text()
    # The scan is turned, a motif is shown in it, and a scan that is like it is gone to.
    pixels = "() => document.querySelector('#right canvas.scan').toDataURL()"
    plain = page.evaluate(pixels)
    page.locator("#right canvas.scan").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function(f"plain => ({pixels})() !== plain", arg=plain)
    page.locator("#right .motifs li").first.focus()
    near = page.locator("#right .wide-scans button").first
    name = near.get_attribute("title").split(",")[0]
    near.click()
    assert page.locator("#right .scan-title bdi").get_attribute("title") == name
    assert window.complaints == []
    assert all(url.startswith(window.address) or url.startswith("data:") for url in window.requests)


def test_pictures_that_take_their_time_are_said_to(window):
    page, held, is_over = window.page, [], []
    assert page.locator("#drawing").is_hidden()
    page.route("**/api/previews*", lambda route: route.continue_() if is_over else held.append(route))
    page.goto(window.address)
    page.wait_for_selector("#drawing", state="visible")
    is_over.append(True)
    for route in held:
        route.continue_()
    page.wait_for_selector("#drawing", state="hidden")
    assert window.complaints == []


def known_names(window: Window) -> list[str]:
    return window.page.evaluate(
        "fetch('api/model').then(answer => answer.json()).then(model => model.scans.names)"
    )


def test_the_figures_lead_to_scans_and_back(window):
    page = window.page
    window.tile(0).click()
    page.wait_for_selector("#right .motifs li")
    name = page.locator("#right .scan-title").inner_text()
    page.get_by_role("button", name="Show in the figures").click()
    page.wait_for_selector("#in-figures")
    assert page.locator("#in-figures bdi").inner_text() == name
    page.locator("#to-scans").click()
    assert page.locator("#right .scan-title").inner_text() == name
    window.press("f")
    page.locator("#in-figures button").last.click()
    # A bar of the barcode, pressed and let go of.
    canvas = page.locator("canvas.timeline")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    page.mouse.click(box["x"] + 60, box["y"] + box["height"] - 60)
    bar = page.locator("#in-figures bdi").inner_text()
    assert bar in known_names(window)
    page.get_by_role("button", name="like it").click()
    page.wait_for_function("() => location.hash.startsWith('#concept')")
    window.press("f")
    page.locator("#in-figures button").last.click()
    bar = page.locator(".granularity g[role=button]").last
    bar.focus()
    window.press("Enter")
    page.locator("#to-scans").click()
    page.wait_for_function("() => /^#(branch|concept)/.test(location.hash)")
    assert page.locator(".tile:not([aria-hidden])").count() > 0
    assert window.complaints == []


def test_hostile_names_are_text(window):
    page, key = window.page, window.state()["concepts"][0]["key"]

    def with_hostile_names(route) -> None:
        answer = route.fetch()
        document = answer.json()
        n = len(document["scans"]["names"])
        document["scans"]["names"] = [HOSTILE[i % len(HOSTILE)].replace("\udcff", "?") for i in range(n)]
        document["labelNames"] = [HOSTILE[0]] * len(document["labelNames"])
        document["title"] = HOSTILE[3]
        route.fulfill(response=answer, body=json.dumps(document))

    page.route("**/api/model", with_hostile_names)
    window.open()
    for name in HOSTILE[:6]:
        window.choose_concept(key)
        window.press("n")
        page.locator("#dialog input").fill(name)
        window.press("Enter")
        page.wait_for_function("() => !document.getElementById('dialog').open")
    window.press("Home", "v", "Escape", "j")
    page.wait_for_selector("#journal li")
    window.press("j", "f")
    page.wait_for_selector("#figures canvas.timeline")
    window.press("f", "/")
    page.keyboard.type("<img")
    assert page.evaluate("window.attacked") is None
    assert page.locator("img").count() == 0
    assert window.complaints == []


def many(document: dict, n: int) -> dict:
    """A model of so many scans."""
    names = document["scans"]["names"]
    document["scans"]["names"] = [f"many/{i:05d}/{names[i % len(names)]}" for i in range(n)]
    document["scans"]["labels"] = [document["scans"]["labels"][i % len(names)] for i in range(n)]
    document["treeGroupOfScan"] = [document["treeGroupOfScan"][i % len(names)] for i in range(n)]
    return document


def many_states(document: dict, n: int) -> dict:
    for name in ("conceptOfScan", "doubts", "pValues"):
        values = document[name]
        document[name] = values and [values[i % len(values)] for i in range(n)]
    return document


def test_of_twenty_thousand_scans_only_those_in_sight_exist(window):
    page, n = window.page, 20_000
    n_scans = len(window.state()["conceptOfScan"])
    page.route("**/api/model", lambda route: route.fulfill(body=json.dumps(many(route.fetch().json(), n))))
    page.route(
        "**/api/state", lambda route: route.fulfill(body=json.dumps(many_states(route.fetch().json(), n)))
    )
    asked: list[int] = []

    def previews(route) -> None:
        rows = [int(row) for row in route.request.url.split("=")[1].split(",")]
        asked.extend(rows)
        address = f"{window.address}api/previews?rows={','.join(str(row % n_scans) for row in rows)}"
        route.fulfill(body=route.fetch(url=address).body())

    page.route("**/api/previews*", previews)
    page.route(
        "**/api/scan?*",
        lambda route: route.fulfill(body=route.fetch(url=f"{window.address}api/scan?row=0").body()),
    )
    window.open()
    page.locator("#left a[href='#all']").click()
    page.wait_for_function("() => document.querySelector('.place-note').textContent.includes('20,000')")
    most = page.evaluate(
        """async () => {
          const scroller = document.querySelector(".gallery-scroller");
          let most = 0;
          for (let i = 0; i < 40; i++) {
            scroller.scrollTop = i / 40 * scroller.scrollHeight;
            await new Promise(requestAnimationFrame);
            await new Promise(requestAnimationFrame);
            most = Math.max(most, document.querySelectorAll(".tile").length);
          }
          return most;
        }"""
    )
    assert 10 < most < 150
    # Of the 40 stops, most were left before it was worth asking for pictures.
    assert len(set(asked)) < 40 * 40
    assert window.tile(n - 1).count() == 0
    page.locator(".gallery-list").focus()
    window.press("End")
    window.tile(n - 1).wait_for()
    times = page.evaluate(
        """() => ["b", "ba", "bal", "ball", "ball_0"].map(text => {
          const search = document.getElementById("search"), start = performance.now();
          search.value = text;
          search.dispatchEvent(new Event("input"));
          return performance.now() - start;
        })"""
    )
    # 30 ms where nothing else runs.
    assert sorted(times)[2] < 150
    assert window.complaints == []


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (1440, "dark"), (360, "light")])
def test_axe_finds_nothing_serious(browser, window, width, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    reader = Window(browser, window.address, width, 740, scheme).open()
    page = reader.page

    def check(where: str) -> None:
        page.wait_for_timeout(150)
        found = axe.run(page).response["violations"]
        serious = [
            (where, one["id"], one["nodes"][0]["html"][:160])
            for one in found
            if one["impact"] in ("serious", "critical")
        ]
        assert serious == []

    check("overview")
    page.evaluate("location.hash = '#concept/0'")
    reader.tile(1).wait_for()
    page.locator(".gallery-list").focus()
    reader.press("Home", "Shift+ArrowRight")
    if width < 500:
        reader.tile(0).click()
    page.wait_for_selector("#right .motifs li")
    check("concept and scan")
    reader.press("Escape", "Home", "v")
    check("dialog")
    reader.press("Escape", "q")
    check("question")
    page.evaluate("document.activeElement.blur()")
    reader.press("f")
    page.wait_for_selector("#figures canvas.timeline")
    check("figures")
    window.edit(kind="rename", key=0, name="for the journal")
    reader.press("j")
    page.wait_for_selector(".edits li")
    check("journal")
    if width < 500:
        assert page.evaluate("document.documentElement.scrollWidth") == width
        reader.press("j")
        page.locator(".open-lists").click()
        check("lists")
    reader.close()


def test_an_edit_that_no_longer_fits_stands_out(window):
    page = window.page

    def with_a_misfit(route) -> None:
        answer = route.fetch()
        document = answer.json()
        misfit = {"number": 7, "kind": "move", "text": "moved <b>x</b> to cup", "undone": False}
        document["journal"].append({**misfit, "unfit": "x is gone"})
        route.fulfill(response=answer, body=json.dumps(document))

    page.route("**/api/state", with_a_misfit)
    window.open()
    assert "⚠ 1" in page.locator("#view-journal").inner_text()
    window.press("j")
    assert page.locator(".misfits h2").inner_text() == "⚠ 1 edit no longer fits the model"
    assert "no longer fits: x is gone" in page.locator(".misfits li").inner_text()
    assert "<b>x</b>" in page.locator(".misfits li").inner_text()


def test_a_server_that_is_gone_is_told(browser, explored_folder, tmp_path):
    model = tmp_path / "m.safetensors"
    model.write_bytes((explored_folder / "m.safetensors").read_bytes())
    with explored(model) as address:
        window = Window(browser, address).open()
        # Without the scans there are no pictures, and all else works.
        window.page.wait_for_selector(".tile-none:not([hidden])")
        window.choose_concept(0)
    window.page.wait_for_function(
        "() => document.getElementById('trouble').textContent.includes('does not answer')"
    )
    window.close()
