"""What the explorer's page shows once another model is in its file."""

from pathlib import Path

import shapeconcepts as sc
from explorer_reader import Window, window_on
from shapeconcepts.explorer.session import Session
from shapeconcepts.io.write_pcd import write_pcd

CHOSEN = ".tile.is-chosen:not([aria-hidden])"
PICTURE = "() => document.querySelector(\".tile[aria-posinset='1'] canvas\").toDataURL()"


def learned(folder: Path, scans: list[sc.Scan]) -> sc.ShapeConceptModel:
    """A model of scans that are in the folder."""
    for scan in scans:
        write_pcd(folder / f"{scan.name}.pcd", scan)
    paths = [folder / f"{scan.name}.pcd" for scan in scans]
    model = sc.ShapeConceptModel(filtration=sc.Filtration(granularity=0.1)).fit(sc.read_scans(paths))
    model.save(folder / "m.safetensors")
    return model


def picture(window: Window) -> str:
    """Of the first scan, once it is drawn."""
    window.page.wait_for_function(f"() => ({PICTURE})().length > 2000", polling=50)
    return window.page.evaluate(PICTURE)


def test_pictures_and_tree_are_those_of_the_model_that_is_there_now(browser, tmp_path: Path) -> None:
    scans = sc.datasets.simulate(6, categories=("ball", "box", "can"))
    learned(tmp_path, scans)
    session = Session(tmp_path / "m.safetensors", [tmp_path], {})
    session.open()
    with window_on(browser, session) as window:
        page = window.page
        page.evaluate("window.location.hash = '#all'")
        first = picture(window)
        page.locator(".tile[aria-posinset='1']").click(modifiers=["Control"])
        assert page.locator(CHOSEN).count() == 1
        other = learned(tmp_path, scans[:5:-1])
        session.keep_up()
        n = len(other.scan_names_)
        page.wait_for_function(
            "n => document.querySelector(\".tile[aria-posinset='1']\").ariaSetSize === String(n)", arg=n
        )
        assert page.locator(CHOSEN).count() == 0
        page.wait_for_function(f"first => ({PICTURE})() !== first && ({PICTURE})().length > 2000", arg=first)
        stops = len(set(other.concept_tree_.granularities))
        assert page.locator("#slider input").get_attribute("max") == str(stops)
        # What it asked for of a scan that is no longer there is refused.
        assert [one for one in window.complaints if "400 (Bad Request)" not in one] == []
